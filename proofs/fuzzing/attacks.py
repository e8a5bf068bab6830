"""What once went wrong, one case each: they are tried first, whatever the seed.

Those that say so need a process of their own, for what they do to it.
"""

from proofs.fuzzing.case import ANSWERS, Case
from proofs.fuzzing.mapfiles import endless, unsealed
from proofs.fuzzing.seeds import SPY, recipes, swept

__all__ = ["alone", "attacks"]

INPUT = frozenset((2,))
BAD = frozenset((1, 2))
R = "r.toml"


def _recipe(label: str, text: str, *words: str, must: frozenset[int] = INPUT) -> Case:
    return Case(label, {R: text.encode(), "spy.py": SPY}, words or ("check", R, "--json"), must)


def attacks() -> list[Case]:
    """Return the cases, each a door that was open."""
    good = recipes()["tripod"]
    name = '[robot]\nname = "tripod"'
    deep = 5000
    return [
        _recipe("an integer of 5,000 digits", good.replace("mass = 5.0", "mass = " + "9" * 5000)),
        _recipe("lists 100,000 deep", "a=" + "[" * 100_000),
        _recipe("tables 5,000 deep", ".".join("a" * deep) + " = 1\n"),
        _recipe("2^63 samples", good.replace("reach = 4", f"reach = {2**63}")),
        _recipe("1e9 samples", good.replace("reach = 4", f"reach = {10**9}")),
        _recipe("2e8 nodes", good.replace("reach = 4", "reach = 200_000_000")),
        _recipe("a com of 1e300", good.replace("0.02, 0.03, 0.1", "1e300, 0, 0"), "limits", R),
        _recipe("no number", good.replace("mass = 5.0", "mass = nan")),
        _recipe("code without leave", good.replace(name, f'{name}\npython = "spy.py:contacts"')),
        _recipe("a name of markup", good.replace('"tripod"', '"<script>"'), must=ANSWERS),
        _recipe("1e9 points", good, "path", R, "--points", "1000000000", "--no-control"),
        _recipe("1e9 headings", good, "metrics", R, "--headings", "1000000000"),
        _recipe("1e8 headings", good, "limits", R, "--best", "--headings", "100000000"),
        _recipe("1e6 levels", good, "optimum", R, "--levels", "1000000"),
        _recipe("a recipe as its own map", good, "sweep", R, "-o", R, must=BAD),
        _recipe(
            "a recipe as its own figure", good, "plot", R, "--kind", "robot", "-o", R, must=BAD
        ),
        Case("a device that never ends", {}, ("check", "/dev/zero"), INPUT),
        Case(
            "another's part file",
            {R: good.encode(), "m.h5.part": b"mine"},
            ("sweep", R, "-o", "m.h5"),
            BAD,
        ),
        Case(
            "texts without end",
            {"m.h5": endless(unsealed(swept()))},
            ("info", "m.h5", "--unsealed"),
            INPUT,
        ),
        Case("half a map", {"m.h5": swept()[:9000]}, ("info", "m.h5", "--json"), INPUT),
    ]


def alone() -> list[Case]:
    """Return the cases that are about their process: its environment, its output."""
    files = {R: recipes()["tripod"].encode()}
    zero = {"NUMBA_NUM_THREADS": "0"}
    return [
        Case("no threads", files, ("eval", R, "--json"), BAD, environment=zero),
        Case("words for threads", files, ("eval", R), BAD, environment={"NUMBA_NUM_THREADS": "x"}),
        Case(
            "odd encoding", files, ("check", R), ANSWERS, environment={"PYTHONIOENCODING": "ascii"}
        ),
    ]

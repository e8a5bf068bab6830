"""The table of a campaign, and the page that keeps it."""

import platform
from collections.abc import Iterator, Mapping
from pathlib import Path

from proofs.fuzzing.campaign import ATTACKS, Tally
from proofs.fuzzing.judge import FAULTS
from proofs.fuzzing.kinds import KINDS

__all__ = ["PAGE", "page", "table", "with_rows"]

PAGE = Path(__file__).resolve().parent.parent.parent / "docs" / "measured" / "fuzzing.md"
HEAD = ("input", "cases", "exit 0 / 1 / 2 / 3", "slowest (s)", "most memory (GiB)", *FAULTS)
TEXT = """# Hostile input

Made by `make hostile` (seed {seed}; Python {python}; {stand}). Each case is a run
of the command line on files that were changed in one to three places, or on words made up for it;
one in 200 is run in a process of its own, too, and has to end alike. What once went wrong is
tried first.

{table}

What counts as a fault:
- *traceback*; *signal*; *slow*, over 20 s; *memory*, over 2 GiB;
- *exit code*: one that the input does not deserve, such as 0 for an unknown key, for a number
  that is none, or for a damaged map that has its seal;
- *output* that is no JSON, has a NaN in it, or is a file that lutgen itself refuses;
- a *message* without a reason, with control characters, or longer than anybody reads;
- *files* that were not to be written, such as the mark of code that ran unasked.
"""


def table(found: Mapping[str, Tally]) -> Iterator[str]:
    """Return the lines of the table."""
    titles = {ATTACKS: "once went wrong", **{kind: KINDS[kind].title for kind in KINDS}}
    yield f"| {' | '.join(HEAD)} |"
    yield f"|{'---|' * len(HEAD)}"
    for kind, tally in found.items():
        codes = " / ".join(f"{tally.codes[code]:,}" for code in range(4))
        faults = [sum(one.what.startswith(name) for one in tally.found) for name in FAULTS]
        cells = (titles[kind], f"{tally.cases:,}", codes, f"{tally.slowest:.1f}")
        memory = f"{tally.peak / 2**30:.2f}"
        yield f"| {' | '.join((*cells, memory, *map(str, faults)))} |"


def page(found: Mapping[str, Tally], seed: int) -> str:
    """Return the page."""
    full = all(found[kind].cases == KINDS[kind].count for kind in KINDS)
    return TEXT.format(
        seed=seed,
        python=platform.python_version(),
        stand="full length" if full else "stopped before its full length",
        table="\n".join(table(found)),
    )


def with_rows(text: str, found: Mapping[str, Tally]) -> str:
    """Return a page in which the rows of some kinds are those of another campaign."""
    _, _, *rows = table(found)
    new = {row.split("|")[1]: row for row in rows}
    return "\n".join(new.get(f"{line}||".split("|")[1], line) for line in text.split("\n"))

"""The tables of the report: each is written as CSV, and shown on the page."""

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from lutgen.paper.model import CONTROLLED, UNCONTROLLED
from lutgen.paper.simulations import HEADINGS, Results
from lutgen.search import Drive

# The paper's T_g first; P and F are common names of the two readings.
LETTERS = {"plane": "P", "body": "F"}
METHODS = {
    "map": "stability map",
    "nelder-mead": "Nelder-Mead (fminsearch)",
    "search": "searching algorithm",
    "multistart": "many starts",
}
SD, OC = "|<i>SD</i><sub>g</sub>|", "|<i>OC</i>|"


@dataclass(frozen=True)
class Column:
    """A column: its key in CSV, its head on the page (HTML), and how its numbers are written.

    `spec` is a format specification, or "" for words.
    """

    key: str
    words: Markup
    spec: str = ""

    @property
    def kind(self) -> str:
        """The class of its cells."""
        return "number" if self.spec else "words"


@dataclass(frozen=True)
class Table:
    """Rows of numbers, words (HTML) and None."""

    columns: Sequence[Column]
    rows: Sequence[Sequence[Any]]


def _columns(*columns: Sequence[str]) -> list[Column]:
    return [Column(key, Markup(words), *spec) for key, words, *spec in columns]


ALPHA = ("alpha_deg", "<i>&alpha;</i> (°)", ".4f")
GAMMA = ("gamma_deg", "<i>&gamma;</i> (°)", ".4f")


def tables(results: Results) -> dict[str, Table]:
    """Return all tables by name."""
    build = (fig08_curve, methods, search_steps, table1, runs, variants, forces)
    found = {each.__name__: each(results) for each in build}
    return found | {"fig16_17_path": fig16_17_path(results)} | errata()


def fig08_curve(results: Results) -> Table:
    """Return |SD_g| and |OC| over alpha."""
    first = results.first
    head = [("alpha_deg", "<i>&alpha;</i> (°)", ".1f")]
    for name, letter in LETTERS.items():
        head += [(f"sdg_{name}", f"{SD}, {letter}", ".5f")]
        head += [(f"height_{name}", f"{OC}, {letter}", ".5f")]
    values = [v for name in LETTERS for v in (first.sdg[name], first.height[name])]
    return Table(_columns(*head), np.column_stack([first.alpha, *values]).tolist())


def methods(results: Results) -> Table:
    """Return what each method of simulation 2 finds."""
    rows = []
    for name, letter in LETTERS.items():
        for method, words in METHODS.items():
            found = results.second[name, method]
            alpha, gamma, *ranges = np.degrees([*found.params, *found.delta]).tolist()
            rows.append([words, letter, found.evaluations, alpha, gamma, found.value, *ranges])
    head = _columns(
        ("method", "method"),
        ("convention", "convention"),
        ("evaluations", "evaluations", "d"),
        ("alpha_deg", "<i>&alpha;</i> (°)", ".6f"),
        ("gamma_deg", "<i>&gamma;</i> (°)", ".6f"),
        ("sdg", SD, ".2e"),
        ("alpha_range_deg", "&plusmn;<i>&delta;</i> of <i>&alpha;</i> (°)", ".2f"),
        ("gamma_range_deg", "&plusmn;<i>&delta;</i> of <i>&gamma;</i> (°)", ".2f"),
    )
    return Table(head, rows)


def search_steps(results: Results) -> Table:
    """Return the steps of the searching algorithm."""
    traces = [results.second[name, "search"].trace for name in LETTERS]
    rows = [
        [i + 1, at.evaluations, *np.degrees(at.params).tolist(), *(t[i].value for t in traces)]
        for i, at in enumerate(traces[0])
    ]
    factors = [(f"sdg_{name}", f"{SD}, {letter}", ".8f") for name, letter in LETTERS.items()]
    counts = ("step", "step", "d"), ("evaluations", "evaluations", "d")
    return Table(_columns(*counts, ALPHA, GAMMA, *factors), rows)


def table1(results: Results) -> Table:
    """Return Table 1 beside our values at the same angles, and at the fitted scale."""
    head = [("method", "method"), ("evaluations", "evaluations", "d"), ALPHA, GAMMA]
    head += [("printed", f"printed {SD}", "s"), ("read_as", "read as", "s")]
    for name, letter in LETTERS.items():
        head += [(f"sdg_{name}", f"ours, {letter}", ".8f")]
        head += [(f"sdg_fitted_{name}", f"fitted, {letter}", ".8f")]
        head += [(f"residual_{name}", f"off (%), {letter}", "+.1f")]
    rows = []
    for row in results.table:
        said = row.published
        # With the decimals that the paper prints, and never as a power of ten.
        printed = map(np.format_float_positional, (said.sdg, said.read_as))
        cells = [said.method, said.evaluations, said.alpha, said.gamma, *printed]
        for name in LETTERS:
            cells += [row.exact[name], row.fitted[name], 100.0 * row.residual[name]]
        rows.append(cells)
    return Table(_columns(*head), rows)


def runs(results: Results) -> Table:
    """Return where the robot tips in each run of simulation 3."""
    third = results.third
    listed = (
        ("without control", third["fixed"], UNCONTROLLED),
        ("with control, one step late", third["lagged"], CONTROLLED),
        ("with control, without the lag", third["prompt"], None),
        (f"turning only, {HEADINGS} headings", third["turning"], None),
        (f"control and {HEADINGS} headings, one step late", third["both"], None),
    )
    head = _columns(
        ("run", "run"),
        ("tips", "points that tip", "d"),
        ("paper", "the paper", "d"),
        ("which", "which, from 0"),
    )
    return Table(
        head, [[words, int(run.tips.sum()), said, _ranges(run.tips)] for words, run, said in listed]
    )


def _ranges(tips: NDArray[np.bool_]) -> str:
    """Return the indices at which a robot tips, as ranges."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], tips.astype(int), [0]])))
    parts = [
        f"{begin}" if end == begin + 1 else f"{begin}\N{EN DASH}{end - 1}"
        for begin, end in edges.reshape(-1, 2)
    ]
    return ", ".join(parts) or "none"


def variants(results: Results) -> Table:
    """Return the shares of other readings of simulation 3."""
    head = _columns(
        ("reading", "reading"),
        ("points", "points", "d"),
        ("without_percent", "tips without control (%)", ".1f"),
        ("control_percent", "with control (%)", ".1f"),
    )
    rows = [[v.name, v.points, 100.0 * v.without, 100.0 * v.control] for v in results.variants]
    return Table(head, rows)


def forces(results: Results) -> Table:
    """Return exact forces beside those of Eq 12."""
    head = [("pitch_deg", "pitch (°)", ".1f"), ("heading_deg", "heading (°)", ".0f")]
    for how, words in (("exact", "exact"), ("eq12", "Eq 12")):
        head += [(f"{how}_{i}", f"{words}, wheel {i}", ".4f") for i in (1, 2, 3)]
    rows = [
        [r.pitch_deg, r.heading_deg, *r.exact, *r.heuristic, np.abs(r.exact - r.heuristic).max()]
        for r in results.forces
    ]
    return Table(_columns(*head, ("largest_error", "largest error", ".3f")), rows)


def fig16_17_path(results: Results) -> Table:
    """Return the path with shape, heading, tip-over angle and verdict of three runs."""
    named = {"without": "fixed", "control": "lagged", "turning_and_control": "both"}
    kinds = ("alpha_deg", "gamma_deg", "heading_deg", "tip_angle_deg", "tips")
    keys = ["point", "x", "y", "z", *(f"{name}_{kind}" for name in named for kind in kinds)]
    driven = [results.third[name] for name in named.values()]
    rows = [
        [i, *place, *(cell for run in driven for cell in _at(run, i))]
        for i, place in enumerate(driven[0].path.position.tolist())
    ]
    return Table(_columns(*((key, key) for key in keys)), rows)


def _at(run: Drive, i: int) -> list[object]:
    """Return shape, heading, tip-over angle (deg) and True if the robot tips at point i."""
    angles = np.degrees([*run.params[i], run.heading[i], run.channels["tip_angle"][i]])
    return [*angles.tolist(), bool(run.tips[i])]


def errata() -> dict[str, Table]:
    """Return what is wrong in the paper, and what is right as printed."""
    text = files(__package__).joinpath("errata.toml").read_text(encoding="utf-8")
    keys = ("place", "printed", "correct", "why")
    found: dict[str, list[list[Any]]] = {"wrong": [], "right": []}
    for number, row in enumerate(tomllib.loads(text)["erratum"], 1):
        rows = found["right" if row.get("confirmed") else "wrong"]
        rows.append([number, *(Markup(row[key]) for key in keys)])
    head = _columns(("number", "no", "d"), *((key, key) for key in keys))
    return {name: Table(head, rows) for name, rows in found.items()}

"""The tables of the report: each is written as CSV, and shown on the page."""

import math
import tomllib
from collections.abc import Sequence
from importlib.resources import files
from typing import Any, NamedTuple

import numpy as np
from markupsafe import Markup

from lutgen.analysis import heuristic_forces, normal_forces
from lutgen.arrays import Bools
from lutgen.paper.model import CONTROLLED, HEIGHT, NOMINAL, TABLE, UNCONTROLLED, paper_recipe
from lutgen.paper.simulations import HEADINGS, Results, level_values, third_simulation
from lutgen.recipe import postures
from lutgen.search import Path, along, paper_path, turned

# The paper's T_g first; P and F are common names of the two readings.
LETTERS = {"plane": "P", "body": "F"}
METHODS = {
    "map": "stability map",
    "nelder-mead": "Nelder-Mead (fminsearch)",
    "search": "searching algorithm",
    "multistart": "differential evolution",
}
# The paper's path on ground that is level across it: a hundred times as fine, its slopes are exact.
FINE = along(paper_path(9901).position, np.zeros(9901))
LEVEL_ACROSS = Path(FINE.position[::100], FINE.heading[::100], FINE.gravity[::100])
# Other readings of simulation 3, each of which departs from it in one thing.
READINGS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("the reading above", {}),
    *(("other number of points", {"path": paper_path(points)}) for points in (50, 200, 500)),
    ("nodes of the search at the right ends of its cells", {"ends": "right"}),
    ("no lag: the geometry found for the point itself", {"lag": 0}),
    ("ground level across the path, heading kept", {"path": LEVEL_ACROSS}),
    ("gravity fixed in the body while the legs move (F)", {"convention": "body"}),
    ("P1 ahead", {"turn": 0.0}),
    ("P1 and P2 ahead, P3 behind", {"turn": -60.0}),
    ("tip-over angle as the objective instead of |SD_g|", {"objective": "tip_angle"}),
)
# Options that a run without control has, too.
GROUND = ("path", "turn", "convention")
# Pitch and heading (deg).  The slope rises towards the heading, seen from the com; wheel 1 is at
# heading 0.  39.7 and 58 deg are close to tipping, atan(10/12) = 39.81 and atan(20/12) = 59.04.
SLOPES = ((0, 0), (10, 0), (20, 0), (30, 0), (39.7, 0), (30, 180), (58, 180), (30, 90))


class Column(NamedTuple):
    """A column: its key in CSV, its head on the page (HTML), and how its numbers are written.

    `spec` is a format specification, or "" for words.
    """

    key: str
    words: str
    spec: str = ""


class Table(NamedTuple):
    """Rows of numbers, words (HTML) and None."""

    columns: Sequence[Column]
    rows: Sequence[Sequence[Any]]


SD, OC = "|<i>SD</i><sub>g</sub>|", "|<i>OC</i>|"
ALPHA = Column("alpha_deg", "<i>&alpha;</i> (°)", ".4f")
GAMMA = Column("gamma_deg", "<i>&gamma;</i> (°)", ".4f")
EVALUATIONS = Column("evaluations", "evaluations", "d")


def tables(results: Results) -> dict[str, Table]:
    """Return all tables by name."""
    build = (methods, search_steps, table1, runs, fig16_17_path)
    found = {each.__name__: each(results) for each in build}
    return found | {each.__name__: each() for each in (fig08_curve, variants, forces)} | errata()


def fig08_curve() -> Table:
    """Return |SD_g| and |OC| over alpha (Fig 8): simulation 1, on level ground."""
    alpha = np.linspace(0.0, 50.0, 501)
    head, columns = [ALPHA._replace(spec=".1f")], [alpha]
    for name, letter in LETTERS.items():
        found = level_values(paper_recipe("paper_one"), np.radians(alpha)[:, None], name)
        columns += [found["sdg"], found["height"]]
        head += [Column(f"sdg_{name}", f"{SD}, {letter}", ".5f")]
        head += [Column(f"height_{name}", f"{OC}, {letter}", ".5f")]
    return Table(head, np.column_stack(columns).tolist())


def methods(results: Results) -> Table:
    """Return what each method of simulation 2 finds."""
    head = [
        Column("method", "method"),
        Column("convention", "convention"),
        EVALUATIONS,
        ALPHA._replace(spec=".6f"),
        GAMMA._replace(spec=".6f"),
        Column("sdg", SD, ".2e"),
        Column("alpha_range_deg", "&plusmn;<i>&delta;</i> of <i>&alpha;</i> (°)", ".2f"),
        Column("gamma_range_deg", "&plusmn;<i>&delta;</i> of <i>&gamma;</i> (°)", ".2f"),
    ]
    rows = []
    for name, letter in LETTERS.items():
        for method, words in METHODS.items():
            found = results.second[name, method]
            alpha, gamma, *ranges = np.degrees([*found.params, *found.delta]).tolist()
            rows.append([words, letter, found.evaluations, alpha, gamma, found.value, *ranges])
    return Table(head, rows)


def search_steps(results: Results) -> Table:
    """Return the steps of the searching algorithm."""
    traces = [results.second[name, "search"].trace for name in LETTERS]
    rows = [
        [i + 1, at.evaluations, *np.degrees(at.params).tolist(), *(t[i].value for t in traces)]
        for i, at in enumerate(traces[0])
    ]
    factors = [Column(f"sdg_{name}", f"{SD}, {letter}", ".8f") for name, letter in LETTERS.items()]
    return Table([Column("step", "step", "d"), EVALUATIONS, ALPHA, GAMMA, *factors], rows)


def table1(results: Results) -> Table:
    """Return Table 1 beside our values at the same angles, and at the fitted scale."""
    head = [Column("method", "method"), EVALUATIONS, ALPHA, GAMMA]
    head += [Column("printed", f"printed {SD}", "s"), Column("read_as", "read as", "s")]
    # With the decimals that the paper prints, and never as a power of ten.
    rows: list[list[Any]] = []
    for said in TABLE:
        printed = map(np.format_float_positional, (said.sdg, said.read_as))
        rows.append([said.method, said.evaluations, said.alpha, said.gamma, *printed])
    for name, letter in LETTERS.items():
        head += [Column(f"sdg_{name}", f"ours, {letter}", ".8f")]
        head += [Column(f"sdg_fitted_{name}", f"fitted, {letter}", ".8f")]
        head += [Column(f"residual_{name}", f"off (%), {letter}", "+.1f")]
        values, scale = results.table[name]
        for row, said, value in zip(rows, TABLE, values.tolist(), strict=True):
            fitted = value * scale
            row += [value, fitted, 100.0 * (fitted / said.read_as - 1.0)]
    return Table(head, rows)


def runs(results: Results) -> Table:
    """Return where the robot tips in each run of simulation 3."""
    listed = {
        "fixed": ("without control", UNCONTROLLED),
        "lagged": ("with control, one step late", CONTROLLED),
        "prompt": ("with control, without the lag", None),
        "turning": (f"turning only, {HEADINGS} headings", None),
        "both": (f"control and {HEADINGS} headings, one step late", None),
    }
    head = [
        Column("run", "run"),
        Column("tips", "points that tip", "d"),
        Column("paper", "the paper", "d"),
        Column("which", "which, from 0"),
    ]
    tips = {name: run.tips for name, run in results.third.items()}
    rows = [
        [words, int(tips[n].sum()), said, _ranges(tips[n])] for n, (words, said) in listed.items()
    ]
    return Table(head, rows)


def _ranges(tips: Bools) -> str:
    """Return the indices at which a robot tips, as ranges."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], tips.astype(int), [0]])))
    parts = [
        f"{begin}" if end == begin + 1 else f"{begin}\N{EN DASH}{end - 1}"
        for begin, end in edges.reshape(-1, 2)
    ]
    return ", ".join(parts) or "none"


def variants() -> Table:
    """Return the shares that tip over for other readings of simulation 3."""
    head = [
        Column("reading", "reading"),
        Column("points", "points", "d"),
        Column("without_percent", "tips without control (%)", ".1f"),
        Column("control_percent", "with control (%)", ".1f"),
    ]
    rows = []
    for name, options in READINGS:
        kept = {key: options[key] for key in GROUND if key in options}
        both = third_simulation(control=False, **kept), third_simulation(**options)
        shares = [100.0 * run.share for run in both]
        rows.append([name, len(both[0].tips), *shares])
    return Table(head, rows)


def forces() -> Table:
    """Return exact forces on the nominal robot's wheels beside those of Eq 12, as shares."""
    head = [Column("pitch_deg", "pitch (°)", ".1f"), Column("heading_deg", "heading (°)", ".0f")]
    for how, words in (("exact", "exact"), ("eq12", "Eq 12")):
        head += [Column(f"{how}_{i}", f"{words}, wheel {i}", ".4f") for i in (1, 2, 3)]
    wheels, rows = postures(paper_recipe(), [[NOMINAL, NOMINAL]])[0][0], []
    for pitch, heading in SLOPES:
        # Gravity leaves the com away from the rise.
        out, around = -HEIGHT * math.tan(math.radians(pitch)), math.radians(heading)
        pierced = np.array([out * math.cos(around), out * math.sin(around), -HEIGHT])
        exact, rough = normal_forces(wheels, pierced), heuristic_forces(wheels, pierced)
        rows.append([pitch, heading, *exact, *rough, np.abs(exact - rough).max()])
    return Table([*head, Column("largest_error", "largest error", ".3f")], rows)


def fig16_17_path(results: Results) -> Table:
    """Return the path with shape, heading, tip-over angle and verdict of three runs."""
    named = {"without": "fixed", "control": "lagged", "turning_and_control": "both"}
    kinds = ("alpha_deg", "gamma_deg", "heading_deg", "tip_angle_deg", "tips")
    keys = ["point", "x", "y", "z", *(f"{name}_{kind}" for name in named for kind in kinds)]
    path, cells = paper_path(), []
    for run in (results.third[name] for name in named.values()):
        # Its heading counts from where it looks first.
        angles = (*run.params.T, turned(path, run.turn).heading, run.channels["tip_angle"])
        shown = np.degrees(np.column_stack(angles)).tolist()
        cells.append([[*row, tips] for row, tips in zip(shown, run.tips.tolist(), strict=True)])
    rows = [
        [i, *place, *(cell for run in cells for cell in run[i])]
        for i, place in enumerate(path.position.tolist())
    ]
    return Table([Column(key, key) for key in keys], rows)


def errata() -> dict[str, Table]:
    """Return what is wrong in the paper, and what is right as printed."""
    text = files(__package__).joinpath("errata.toml").read_text(encoding="utf-8")
    keys = ("place", "printed", "correct", "why")
    found: dict[str, list[list[Any]]] = {"wrong": [], "right": []}
    for number, row in enumerate(tomllib.loads(text)["erratum"], 1):
        rows = found["right" if row.get("confirmed") else "wrong"]
        rows.append([number, *(Markup(row[key]) for key in keys)])
    head = [Column("number", "no", "d"), *(Column(key, key) for key in keys)]
    return {name: Table(head, rows) for name, rows in found.items()}

"""The tables of the page, by the names that its template gives them."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from lutgen.paper.erratum import Erratum
from lutgen.paper.page import Table, shown_together
from lutgen.paper.published import CONTROLLED, UNCONTROLLED
from lutgen.paper.results import Results
from lutgen.paper.rough import HEADINGS
from lutgen.paper.tables import CONVENTION_ORDER as ORDER
from lutgen.paper.tables import curve_rows

# P and F are how the two readings are often told apart.
LETTERS = {"plane": "P", "body": "F"}
METHODS = {
    "map": "stability map",
    "nelder-mead": "Nelder-Mead (fminsearch)",
    "search": "searching algorithm",
    "multistart": "many starts",
}
# Every how many points of the curve stand on the page.
CURVE_EVERY = 50
ALPHA, GAMMA = ("$alpha$ (°)", ".4f"), ("$gamma$ (°)", ".4f")


def page_tables(results: Results) -> dict[str, Table]:
    """Return all tables of the page by name."""
    build = (curve, methods, steps, table_one, fitted, runs, variants, forces, loads)
    found = {each.__name__: each(results) for each in build}
    for name, confirmed in (("wrong", False), ("right", True)):
        group = [(i, e) for i, e in enumerate(results.errata, 1) if e.confirmed is confirmed]
        found[name], found[f"{name}_checks"] = errata_words(group), errata_checks(group)
    return found


def curve(results: Results) -> Table:
    """Return |SD_g| and |OC| over alpha."""
    head = [(f"${q}$, {LETTERS[n]}", ".5f") for n in ORDER for q in ("|SD_g|", "|OC|")]
    return Table([("$alpha$ (°)", ".0f"), *head], curve_rows(results.first)[::CURVE_EVERY])


def methods(results: Results) -> Table:
    """Return what each method of simulation 2 finds."""
    rows = []
    for name in ORDER:
        for method, words in METHODS.items():
            found = results.second[name, method]
            alpha, gamma, *ranges = np.degrees([*found.params, *found.delta]).tolist()
            rows.append(
                [words, LETTERS[name], found.evaluations, alpha, gamma, found.value, *ranges]
            )
    head = [("method", ""), ("convention", ""), ("evaluations", "d"), ("$alpha$ (°)", ".6f")]
    head += [("$gamma$ (°)", ".6f"), ("$|SD_g|$", ".2e")]
    head += [("±$delta$ of $alpha$ (°)", ".2f"), ("±$delta$ of $gamma$ (°)", ".2f")]
    return Table(head, rows)


def steps(results: Results) -> Table:
    """Return the steps of the searching algorithm."""
    traces = [results.second[name, "search"].trace for name in ORDER]
    rows = [
        [i + 1, at.evaluations, *np.degrees(at.params).tolist(), *(t[i].value for t in traces)]
        for i, at in enumerate(traces[0])
    ]
    factors = [(f"$|SD_g|$, {LETTERS[name]}", ".8f") for name in ORDER]
    return Table([("step", "d"), ("evaluations", "d"), ALPHA, GAMMA, *factors], rows)


def table_one(results: Results) -> Table:
    """Return Table 1 beside our values at the same angles."""
    rows = []
    for row in results.table:
        said = row.published
        ours = [cell for n in ORDER for cell in (row.exact[n], row.exact[n] / said.sdg)]
        rows.append(
            [said.method, said.evaluations, said.alpha, said.gamma, _digits(said.sdg), *ours]
        )
    head = [("method", ""), ("evaluations", "d"), ALPHA, GAMMA, ("printed $|SD_g|$", "s")]
    for name in ORDER:
        head += [(f"ours, {LETTERS[name]}", ".8f"), ("times the printed", ".2f")]
    return Table(head, rows)


def fitted(results: Results) -> Table:
    """Return Table 1 beside our values at the fitted scale."""
    rows = []
    for row in results.table:
        said = row.published
        ours = [cell for n in ORDER for cell in (row.fitted[n], 100.0 * row.residual[n])]
        rows.append([said.method, _digits(said.sdg), _digits(said.read_as), *ours])
    head = [("method", ""), ("printed $|SD_g|$", "s"), ("read as", "s")]
    for name in ORDER:
        head += [(f"ours, {LETTERS[name]}", ".8f"), ("off by (%)", "+.2f")]
    return Table(head, rows)


def _digits(value: float) -> str:
    """Return a number with the decimals that the paper prints, and never as a power of ten."""
    return np.format_float_positional(value)


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
    head = [("run", ""), ("points that tip", "d"), ("the paper", "d"), ("which, from 0", "")]
    rows = [[words, int(run.tips.sum()), said, _ranges(run.tips)] for words, run, said in listed]
    return Table(head, rows)


def _ranges(tips: NDArray[np.bool_]) -> str:
    """Return the indices at which a robot tips, as ranges."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], tips.astype(int), [0]])))
    parts = [
        f"{begin}" if end == begin + 1 else f"{begin}\u2013{end - 1}"
        for begin, end in edges.reshape(-1, 2)
    ]
    return ", ".join(parts) or "none"


def variants(results: Results) -> Table:
    """Return the shares of other readings of simulation 3."""
    head = [("reading", ""), ("points", "d")]
    head += [("tips without control (%)", ".1f"), ("with control (%)", ".1f")]
    rows = [[v.name, v.points, 100.0 * v.without, 100.0 * v.control] for v in results.variants]
    return Table(head, rows)


def forces(results: Results) -> Table:
    """Return exact forces beside those of Eq 12."""
    head = [("pitch (°)", ".1f"), ("heading (°)", ".0f")]
    head += [(f"{how}, wheel {i}", ".4f") for how in ("exact", "Eq 12") for i in (1, 2, 3)]
    rows = [
        [row.pitch_deg, row.heading_deg, *row.exact, *row.heuristic, row.largest_error]
        for row in results.forces
    ]
    return Table([*head, ("largest error", ".3f")], rows)


def loads(results: Results) -> Table:
    """Return the errors of Eq 12 over random loads."""
    head = [("triangles", ""), ("loads", ",d"), ("mean error", ".3f")]
    head += [("95th percentile", ".3f"), ("worst", ".3f"), ("a wheel pulls (% of loads)", ".1f")]
    rows = [
        [each.triangles, each.loads, each.mean, each.p95, each.worst, 100.0 * each.negative]
        for each in results.loads
    ]
    return Table(head, rows)


def errata_words(group: Iterable[tuple[int, Erratum]]) -> Table:
    """Return the words of numbered errata."""
    head = [("no", "d"), ("place", ""), ("printed", ""), ("correct", ""), ("why", "")]
    return Table(head, [[i, e.place, e.printed, e.correct, e.why] for i, e in group])


def errata_checks(group: Iterable[tuple[int, Erratum]]) -> Table:
    """Return the checks of numbered errata."""
    head = [("no", "d"), ("what was computed", ""), ("as printed", "s"), ("ours", "s")]
    rows = [
        [i, c.claim, *shown_together([c.printed, c.ours, c.reference])]
        for i, e in group
        for c in e.checks
    ]
    return Table([*head, ("reference", "s")], rows)

"""The numbers of the page's prose, by the names that its template gives them.

Owns no words and no digits: how a number is written stands in the template, which also picks its
own out of what is given whole.
"""

import math
from typing import Any

from lutgen._version import __version__
from lutgen.paper.checks_text import zeros_of_lines
from lutgen.paper.closed_form import NODES, RANGE_DEG, path_slope, second_optimum_deg
from lutgen.paper.nominal import CIRCUMRADIUS, HEIGHT, NOMINAL_DEG, RADIUS, nominal_wheels
from lutgen.paper.pictures import UNEVEN
from lutgen.paper.published import CONTROLLED, POINTS, PRINTED, TIPS_AT, UNCONTROLLED, entry
from lutgen.paper.reference import edge_distance
from lutgen.paper.results import MAP, Results
from lutgen.paper.rough import HEADINGS
from lutgen.paper.simulations import LIMIT
from lutgen.paper.triples import CONTACTS

HOUR = 3600.0


def page_numbers(results: Results, seconds: float) -> dict[str, Any]:
    """Return what the template's placeholders stand for; `seconds` is how long all of it took."""
    wheels = nominal_wheels()
    confirmed = [each.confirmed for each in results.errata]
    line, last, _ = zeros_of_lines()
    return {
        "printed": PRINTED,
        "tips_at": TIPS_AT,
        "radius": RADIUS,
        "nominal_deg": NOMINAL_DEG,
        "circumradius": CIRCUMRADIUS,
        "height": HEIGHT,
        "nearest_edge": edge_distance(wheels, wheels.mean(axis=0)),
        "uneven": UNEVEN,
        "first_best": {n: math.degrees(at.params[0]) for n, at in results.first.best.items()},
        "curve_step": float(results.first.alpha[1] - results.first.alpha[0]),
        "swept": results.swept,
        "kernel_ms": 1e3 * results.swept.kernel,
        "file_ms": 1e3 * results.swept.file,
        "faster": _one_digit(HOUR / results.swept.file),
        "limit": LIMIT,
        "second_optimum": second_optimum_deg(),
        "last_step": len(results.second["plane", "search"].trace),
        "range": RANGE_DEG,
        "cells": NODES,
        "nodes_a_step": NODES**2,
        "shrinks": 2.0 / NODES,
        **_scale(results),
        "zero_of_line": line,
        "zero_of_last": last,
        "points": POINTS,
        "uncontrolled": UNCONTROLLED,
        "controlled": CONTROLLED,
        "steepest_deg": math.degrees(math.atan(path_slope(0.0))),
        "headings": HEADINGS,
        "both_tips": int(results.third["both"].tips.sum()),
        "turning_tips": int(results.third["turning"].tips.sum()),
        "right": sum(confirmed),
        "wrong": len(confirmed) - sum(confirmed),
        "checks": sum(len(each.checks) for each in results.errata),
        "near_tip": min(results.forces, key=lambda row: row.exact[0]),
        "fewest_contacts": min(CONTACTS),
        "most_contacts": max(CONTACTS),
        "triples": results.triples,
        "version": __version__,
        "seconds": seconds,
        "map_file": MAP,
    }


def _one_digit(value: float) -> int:
    """Return a number rounded down to its first digit: more would be claimed than is known."""
    power = 10 ** math.floor(math.log10(value))
    return int(value // power * power)


def _scale(results: Results) -> dict[str, Any]:
    """Return how our values of Table 1 compare with the printed ones."""
    searching = [row for row in results.table if row.published.searching]
    meant = [row.exact["plane"] / row.published.read_as for row in searching]
    return {
        "ratio": [row.exact["plane"] / row.published.sdg for row in results.table],
        "fitted": results.fitted_radius,
        "ratio_low": min(meant),
        "ratio_high": max(meant),
        "worst_percent": 100.0 * max(abs(r) for row in searching for r in row.residual.values()),
        "step": {i: entry(f"step {i}") for i in (1, 2, 3, 6)},
    }

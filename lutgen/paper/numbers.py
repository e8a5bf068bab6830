"""The numbers of the page's prose, by the names that its template gives them.

Owns no words and no digits: how a number is written stands in the template.
"""

import math
from typing import Any

from lutgen._version import __version__
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
    return {
        **_paper_and_robot(),
        **_simulations(results),
        **_scale(results),
        **_path(results),
        **_errata_and_forces(results),
        "version": __version__,
        "seconds": seconds,
        "map_file": MAP,
    }


def _paper_and_robot() -> dict[str, Any]:
    wheels = nominal_wheels()
    return {
        "title": PRINTED["title"],
        "youngest_date": PRINTED["youngest_date"],
        "robots": PRINTED["robots"],
        "printed_nominal": PRINTED["nominal_deg"],
        "printed_first_optimum": PRINTED["first_optimum_deg"],
        "tips_at": TIPS_AT,
        "radius": RADIUS,
        "nominal_deg": NOMINAL_DEG,
        "circumradius": CIRCUMRADIUS,
        "height": HEIGHT,
        "nearest_edge": edge_distance(wheels, wheels.mean(axis=0)),
        "uneven_alpha": UNEVEN["alpha"],
        "uneven_gamma": UNEVEN["gamma"],
    }


def _simulations(results: Results) -> dict[str, Any]:
    first, swept = results.first, results.swept
    return {
        **{f"first_best_{n}": math.degrees(found.params[0]) for n, found in first.best.items()},
        "curve_step": float(first.alpha[1] - first.alpha[0]),
        "map_nodes": swept.nodes,
        "map_alpha": swept.alpha,
        "map_gamma": swept.gamma,
        "kernel_ms": 1e3 * swept.kernel,
        "file_ms": 1e3 * swept.file,
        "faster": _one_digit(HOUR / swept.file),
        "limit": LIMIT,
        "second_optimum": second_optimum_deg(),
        "last_step": len(results.second.found["plane", "search"].trace),
        "range_low": RANGE_DEG[0],
        "range_high": RANGE_DEG[1],
        "cells": NODES,
        "nodes_a_step": NODES**2,
        "shrinks": 2.0 / NODES,
    }


def _one_digit(value: float) -> int:
    """Return a number rounded down to its first digit: more would be claimed than is known."""
    power = 10 ** math.floor(math.log10(value))
    return int(value // power * power)


def _scale(results: Results) -> dict[str, Any]:
    """Return how our values of Table 1 compare with the printed ones."""
    names = ("map", "fminsearch", *(f"step_{i}" for i in (1, 2, 3, 6)))
    ratios = {
        f"ratio_{name}": row.exact["plane"] / row.published.sdg
        for name, row in zip(names, results.table, strict=True)
    }
    searching = [row for row in results.table if row.published.searching]
    meant = [row.exact["plane"] / row.published.read_as for row in searching]
    first, second, third, last = (entry(f"step {i}") for i in (1, 2, 3, 6))
    slope = (second.sdg - third.sdg) / (second.alpha - third.alpha)
    return {
        **ratios,
        **{f"fitted_{name}": radius for name, radius in results.fitted_radius.items()},
        "ratio_low": min(meant),
        "ratio_high": max(meant),
        "read_as": first.read_as,
        "misprint": first.sdg,
        "worst_percent": 100.0 * max(abs(r) for row in searching for r in row.residual.values()),
        **{f"step_{i}_deg": entry(f"step {i}").alpha for i in (1, 2, 3, 6)},
        "zero_of_line": third.alpha - third.sdg / slope,
        "zero_of_last": last.alpha + last.sdg / slope,
    }


def _path(results: Results) -> dict[str, Any]:
    third = results.third
    return {
        "points": POINTS,
        "uncontrolled": UNCONTROLLED,
        "controlled": CONTROLLED,
        "steepest_deg": math.degrees(math.atan(path_slope(0.0))),
        "headings": HEADINGS,
        "both_tips": int(third.both.tips.sum()),
        "turning_tips": int(third.turning.tips.sum()),
    }


def _errata_and_forces(results: Results) -> dict[str, Any]:
    confirmed = [each.confirmed for each in results.errata]
    near_tip = min(results.forces, key=lambda row: row.exact[0])
    found = results.triples
    return {
        "right": sum(confirmed),
        "wrong": len(confirmed) - sum(confirmed),
        "checks": sum(len(each.checks) for each in results.errata),
        "near_tip_pitch": near_tip.pitch_deg,
        "near_tip_exact": near_tip.exact[0],
        "near_tip_rough": near_tip.heuristic[0],
        "fewest_contacts": min(CONTACTS),
        "most_contacts": max(CONTACTS),
        "triple_sets": found.sets,
        "triples_agree": found.agree,
        "triples_tipping": found.tipping,
        "most_passing": found.most_passing,
    }

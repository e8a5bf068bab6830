"""The paper's numbers as CSV tables.

Owns which columns each file has.
"""

import math
from collections.abc import Sequence

import numpy as np

from lutgen.paper.markup import plain
from lutgen.paper.results import Results
from lutgen.paper.simulations import First
from lutgen.search import Drive

Csv = tuple[Sequence[str], list[list[object]]]

# The paper's T_g first.
CONVENTION_ORDER = ("plane", "body")


def tables(results: Results) -> dict[str, Csv]:
    """Return the numbers as CSV tables: file name to (header, rows)."""
    return {
        "fig08_curve.csv": (
            ["alpha_deg", *(f"{q}_{name}" for name in CONVENTION_ORDER for q in ("sdg", "height"))],
            curve_rows(results.first),
        ),
        "table1.csv": _table_one(results),
        "search_steps.csv": (
            ["convention", "step", "evaluations", "alpha_deg", "gamma_deg", "sdg"],
            [
                [name, i + 1, step.evaluations, *np.degrees(step.params).tolist(), step.value]
                for name in CONVENTION_ORDER
                for i, step in enumerate(results.second[name, "search"].trace)
            ],
        ),
        "fig16_17_path.csv": _path(results),
        "variants.csv": (
            ["reading", "points", "share_without", "share_with_control"],
            [[plain(v.name), v.points, v.without, v.control] for v in results.variants],
        ),
        "errata.csv": (
            ["place", "claim", "printed", "ours", "reference", "confirmed"],
            [
                [plain(each.place), plain(c.claim), c.printed, c.ours, c.reference, each.confirmed]
                for each in results.errata
                for c in each.checks
            ],
        ),
    }


def curve_rows(first: First) -> list[list[object]]:
    """Return alpha (deg), and |SD_g| and |OC| by each convention."""
    values = [v for name in CONVENTION_ORDER for v in (first.sdg[name], first.height[name])]
    rows: list[list[object]] = np.column_stack([first.alpha, *values]).tolist()
    return rows


def _table_one(results: Results) -> Csv:
    kinds = ("sdg", "sdg_fitted", "residual")
    ours = [f"{kind}_{name}" for name in CONVENTION_ORDER for kind in kinds]
    rows: list[list[object]] = []
    for row in results.table:
        said = row.published
        cells = [said.method, said.evaluations, said.alpha, said.gamma, said.sdg, said.read_as]
        for name in CONVENTION_ORDER:
            cells += [row.exact[name], row.fitted[name], row.residual[name]]
        rows.append(cells)
    return ["method", "evaluations", "alpha_deg", "gamma_deg", "printed", "read_as", *ours], rows


def _path(results: Results) -> Csv:
    named = {"without": "fixed", "control": "lagged", "turning_and_control": "both"}
    kinds = ("alpha_deg", "gamma_deg", "heading_deg", "tip_angle_deg", "tips")
    head = ["point", "x", "y", "z", *(f"{name}_{kind}" for name in named for kind in kinds)]
    runs = [results.third[name] for name in named.values()]
    return head, [
        [i, *place, *(cell for run in runs for cell in _at(run, i))]
        for i, place in enumerate(runs[0].path.position.tolist())
    ]


def _at(run: Drive, i: int) -> list[object]:
    """Return shape, heading, tip-over angle and whether the robot tips at point i."""
    angles = [run.heading[i], run.channels["tip_angle"][i]]
    return [*np.degrees(run.params[i]).tolist(), *map(math.degrees, angles), bool(run.tips[i])]

"""The paper's numbers as CSV tables.

Owns which columns each file has.
"""

import math
from collections.abc import Sequence

import numpy as np

from lutgen.paper.results import Results

__all__ = ["CONVENTION_ORDER", "tables"]

# The paper's T_g first.
CONVENTION_ORDER = ("plane", "body")


def tables(results: Results) -> dict[str, tuple[Sequence[str], list[list[object]]]]:
    """Return the numbers as CSV tables: file name to (header, rows)."""
    first, third = results.first, results.third
    values = [v for name in CONVENTION_ORDER for v in (first.sdg[name], first.height[name])]
    curve = np.column_stack([first.alpha, *values]).tolist()
    head = [f"{quantity}_{name}" for name in CONVENTION_ORDER for quantity in ("sdg", "height")]
    steps = [
        [name, i + 1, step.evaluations, *np.degrees(step.params).tolist(), step.value]
        for name in CONVENTION_ORDER
        for i, step in enumerate(results.second.found[name, "search"].trace)
    ]
    path = third.fixed.path
    runs = {"without": third.fixed, "control": third.lagged, "turning_and_control": third.both}
    along = [
        [
            i,
            *path.position[i].tolist(),
            *(
                cell
                for run in runs.values()
                for cell in (
                    *np.degrees(run.params[i]).tolist(),
                    math.degrees(run.heading[i]),
                    math.degrees(run.channels["tip_angle"][i]),
                    bool(run.tips[i]),
                )
            ),
        ]
        for i in range(len(path.position))
    ]
    columns = [
        f"{name}_{what}"
        for name in runs
        for what in ("alpha_deg", "gamma_deg", "heading_deg", "tip_angle_deg", "tips")
    ]
    return {
        "fig08_curve.csv": (["alpha_deg", *head], curve),
        "table1.csv": (table_head(), table_rows(results)),
        "search_steps.csv": (
            ["convention", "step", "evaluations", "alpha_deg", "gamma_deg", "sdg"],
            steps,
        ),
        "fig16_17_path.csv": (["point", "x", "y", "z", *columns], along),
        "variants.csv": (
            ["reading", "points", "share_without", "share_with_control"],
            [[v.name, v.points, v.without, v.control] for v in results.variants],
        ),
        "errata.csv": (
            ["place", "claim", "printed", "ours", "reference", "confirmed"],
            [
                [each.place, c.claim, c.printed, c.ours, c.reference, each.confirmed]
                for each in results.errata
                for c in each.checks
            ],
        ),
    }


def table_head() -> list[str]:
    """Return the header of Table 1's CSV."""
    ours = [
        f"{what}_{name}" for name in CONVENTION_ORDER for what in ("sdg", "sdg_fitted", "residual")
    ]
    return ["method", "evaluations", "alpha_deg", "gamma_deg", "printed", "read_as", *ours]


def table_rows(results: Results) -> list[list[object]]:
    """Return Table 1 beside ours."""
    rows: list[list[object]] = []
    for row in results.table:
        said = row.published
        ours = [
            cell
            for name in CONVENTION_ORDER
            for cell in (row.exact[name], row.fitted[name], row.residual[name])
        ]
        rows.append(
            [said.method, said.evaluations, said.alpha, said.gamma, said.sdg, said.read_as, *ours]
        )
    return rows

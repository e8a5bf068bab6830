"""`lutgen metrics`: five metrics of stability side by side."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from lutgen import bounds
from lutgen.cli.options import (
    Named,
    RecipeOptions,
    WholeRange,
    asks,
    option,
    parameters,
    posture_source,
    posture_values,
    tilt,
)
from lutgen.cli.sources import open_recipe
from lutgen.cli.table import (
    aligned,
    cell,
    channel_entries,
    even,
    number,
    posture_entries,
    posture_text,
    show,
    unit_text,
)
from lutgen.errors import InputError
from lutgen.quantities import QUANTITIES

if TYPE_CHECKING:
    from lutgen.analysis import Metrics, Posture

MOST = bounds.HEADINGS.most


@dataclass(frozen=True)
class Asked(RecipeOptions):
    """What the command line says."""

    assignments: tuple[tuple[str, float], ...] = parameters()
    tilt: float = tilt()
    headings: int = option(
        type=WholeRange(1, MOST),
        default=24,
        help="How many headings, evenly spaced, the first nose down.",
    )


@click.command(short_help="Compare five metrics over all headings.")
@click.argument("recipe", type=Named())
@asks(Asked)
def metrics(recipe: str, asked: Asked) -> None:
    """Print |SD_g|, tip-over angle, static and energy margin, and force-angle of one posture.

    Parameters without -p are at the recipe's `home`, then in the middle of their range.  The
    force-angle measure is that of a weight of 1.  Only the tip-over angle's sign is a verdict.

    \b
    $ lutgen metrics maps/paper_two.toml -p alpha=31 -p gamma=31 --tilt 20
    """
    from lutgen.analysis import Posture

    if not 0.0 <= asked.tilt <= 180.0:
        raise InputError(
            f"--tilt must lie between 0 and 180 deg (got {asked.tilt:g}); 20 is the default"
        )
    robot = open_recipe(recipe, asked.allow_python)
    posture = Posture(robot, posture_values(robot, asked.assignments))
    report = metrics_report(posture, asked.tilt, asked.headings)
    report |= posture_entries(posture, posture_source(robot, asked.assignments))
    show(report, metrics_lines(report), asked.as_json)


def metrics_report(posture: "Posture", tilt: float, headings: int) -> dict[str, Any]:
    """Return what `--json` prints; null where there is no value."""
    import numpy as np

    from lutgen.analysis import compare_metrics, holds, may_hold, tilted

    around = np.arange(headings) * (360.0 / headings)
    down = tilted(math.radians(tilt), np.radians(around))
    found = compare_metrics(posture, down)
    held: list[dict[str, bool]] = [{} for _ in around]
    if any(contact.rolling for contact in posture.recipe.contacts):
        every, some = holds(posture, down), may_hold(posture, down)
        held = [
            {"holds": bool(one), "may_hold": bool(other)}
            for one, other in zip(every, some, strict=True)
        ]
    return {
        "robot": posture.recipe.name,
        "length_unit": posture.recipe.length_unit,
        "tilt_deg": tilt,
        "level": {
            "status": QUANTITIES["status"].word(found.level_status),
            **channel_entries(found.level),
        },
        "headings": [
            {**_at(found, i, float(heading)), **held[i]} for i, heading in enumerate(around)
        ],
    }


def _at(found: "Metrics", index: int, heading: float) -> dict[str, Any]:
    """Return the entry of one heading."""
    return {
        "heading_deg": heading,
        "standing": bool(found.standing[index]),
        "status": QUANTITIES["status"].word(float(found.status[index])),
        **channel_entries({name: float(values[index]) for name, values in found.values.items()}),
        "normalised": {
            name: number(float(values[index])) for name, values in found.normalised.items()
        },
    }


def metrics_lines(report: dict[str, Any]) -> Iterator[str]:
    """Return the report as text: one row per heading, and one for level ground."""
    length = unit_text(report["length_unit"])
    columns = {
        "sdg": f"sdg{length}",
        "tip_angle_deg": "tip_angle deg",
        "margin": f"margin{length}",
        "energy_margin": f"energy{length}",
        "force_angle_rad": f"force_angle rad{length}",
    }
    rolling = "holds" in report["headings"][0]
    rows = [["heading deg", "verdict", *columns.values(), *(["holds"] if rolling else [])]]
    for entry in ({"heading_deg": None, **report["level"]}, *report["headings"]):
        heading = entry["heading_deg"]
        name = "level" if heading is None else f"{heading:g}"
        verdict = {"tips": "tips over"}.get(entry["status"], entry["status"])
        rows.append(
            [
                name,
                verdict,
                cell(even(entry["sdg"])),
                *(cell(entry[key]) for key in columns if key != "sdg"),
            ]
        )
        if rolling:
            held = "yes" if entry.get("holds", True) else "may" if entry["may_hold"] else "no"
            rows[-1].append(held)
    yield f"{report['robot']}: tilted {report['tilt_deg']:g} deg"
    if "posture_from" in report:
        yield f"{posture_text(report['posture'])} ({report['posture_from']})"
    widths = [">11", "<9", *(f">{max(len(title), 10)}" for title in columns.values())]
    yield from aligned(rows, [*widths, *([">5"] if rolling else [])])

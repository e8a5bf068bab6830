"""`lutgen limits`: how far a robot can be tilted, in one posture or in all."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from lutgen import bounds
from lutgen.cli import options
from lutgen.cli.options import Named, RecipeOptions, asks, option
from lutgen.cli.sources import open_recipe
from lutgen.cli.table import TIPS, aligned, by_unit, cell, degrees, posture_text, show

if TYPE_CHECKING:
    from lutgen.analysis import PostureLimits, SweepLimits
    from lutgen.recipe import Recipe

# The curves of the figure have this many headings or more.
FIGURE = 72
WORST_GROUND = "worst on the ground"
FIRST = {None: "-", True: "slides first", False: "tips first"}


@dataclass(frozen=True)
class Asked(RecipeOptions):
    """What the command line says."""

    assignments: tuple[tuple[str, float], ...] = options.parameters()
    over_all: bool = option("--all", is_flag=True, help="Also over all postures of the sweep.")
    best: bool = option(is_flag=True, help="Also the best posture of the sweep in each heading.")
    headings: int = option(default=24, help="How many the table of --best has; a multiple of 4.")
    convention: str = options.convention(
        "plane",
        "body",
        "Whether body tilt counts from level ground under it, or from a level body.",
    )
    output: str | None = options.output(help="Figure (PNG, SVG or PDF).")
    size: str | None = options.size()
    style: str = options.style()
    force: bool = options.force()


@click.command(short_help="Largest tilt nose down, nose up, left, right and in the worst heading.")
@click.argument("recipe", type=Named())
@asks(Asked)
def limits(recipe: str, asked: Asked) -> None:
    """Print how far RECIPE can be tilted before it tips over.

    With its shape kept: nose down, left side down, nose up, right side down and in its worst
    heading.  Body tilt is the robot's own, as an accelerometer in it sees it; ground tilt is the
    slope of the ground, on which it may rock from rest to rest.  What is guaranteed holds in every
    heading, also between those listed (of the ground: where it has not been steeper before), and
    all limits are rounded down.  -p gives the posture; where it is left out, the recipe's `home`,
    then the middle of the range.  Exit code 3 where it tips over on level ground.

    \b
    $ lutgen limits maps/absolem.toml -p front=90 -p rear=90
    guaranteed ground tilt in every heading: 38.65 deg (sliding included; ...)
    """
    from lutgen.analysis import Posture, even_headings, posture_limits, sweep_limits

    robot = open_recipe(recipe, asked.allow_python)
    options.check_outputs(asked.force, asked.output)
    # Refused before the work, which takes as many as the figure needs.
    around = even_headings(asked.headings)
    found = posture_limits(
        Posture(robot, options.posture_values(robot, asked.assignments)), asked.convention
    )
    swept = None
    if asked.over_all or asked.best:
        grid = robot.grid
        around = even_headings(asked.headings * -(-FIGURE // asked.headings))
        # Before a row of parameters is made for each.
        way_out = "sweep fewer samples, or ask fewer headings"
        bounds.check(grid.size * len(around), bounds.LIMITS, robot.source, way_out)
        swept = sweep_limits(robot, grid.params(range(grid.size)), around, asked.convention)
    if asked.output is not None:
        from lutgen.plot import draw_limits, on_sheet, save

        with on_sheet(asked.size, asked.style):
            save(
                draw_limits(robot, found, swept, worst=asked.over_all),
                asked.output,
                force=asked.force,
            )
    report = limits_report(robot, found)
    report["posture_from"] = options.posture_source(robot, asked.assignments) or "given"
    if swept is not None and asked.over_all:
        report["all_postures"] = _all(robot, swept)
    if swept is not None and asked.best:
        report["best_postures"] = _best(robot, swept, asked.headings)
    show(report, limits_lines(report), asked.as_json, found.stands, TIPS)


def limits_report(recipe: "Recipe", found: "PostureLimits") -> dict[str, Any]:
    """Return what `--json` prints of one posture; null where there is no value.

    Without "ground" in their names tilts are those of the body, and count tipping over alone.
    """
    import numpy as np

    mu, ground = recipe.friction, found.ground
    # Without a worst heading of body tilt that of ground tilt is beside it.
    around = [ground.worst if math.isnan(row.heading) else row.heading for row in found.headings]
    slopes = ground.limits(np.nan_to_num(around))
    return {
        "robot": recipe.name,
        "length_unit": recipe.length_unit,
        "convention": found.convention,
        "posture": by_unit(recipe, found.params),
        "friction": mu,
        "friction_angle_deg": None if mu is None else _down(math.atan(mu)),
        "limits": [
            {
                "name": row.name,
                "heading_deg": degrees(row.heading),
                "tilt_deg": _down(row.tilt),
                "contacts": list(row.contacts),
                "slides_first": row.slides,
                "ground_tilt_deg": _down(slope),
                "ground_contacts": list(ground.contacts(heading)),
            }
            for row, heading, slope in zip(found.headings, around, slopes.tolist(), strict=True)
        ],
        "guaranteed_tilt_deg": _down(found.guaranteed),
        "guaranteed_body_tilt_deg": _down(found.guaranteed),
        "guaranteed_ground_tilt_deg": _down(found.guaranteed_ground),
        "guaranteed_ground_tip_deg": _down(ground.guaranteed),
        "ground_sliding_included": found.slide is not None,
        "worst_ground_heading_deg": degrees(ground.worst),
        "worst_ground_tilt_deg": _down(ground.least),
        "worst_ground_contacts": list(ground.contacts(ground.worst)),
        "ground_rolling_included": False if found.rolls else None,
        "forces_act": recipe.has_wrench,
        "stands_on_level_ground": found.stands,
    }


def _down(angle: float) -> float:
    """Return an angle in deg, from rad, rounded down at its tenth decimal."""
    from lutgen.analysis import rounded_down

    return rounded_down(math.degrees(angle), 10)


def _best(recipe: "Recipe", swept: "SweepLimits", count: int) -> list[dict[str, Any]]:
    """Return the best posture in each of `count` headings, of which `swept` has a multiple."""
    return [
        {
            "heading_deg": math.degrees(swept.headings[i]),
            "tilt_deg": _down(swept.most[i]),
            "posture": by_unit(recipe, swept.params[swept.most_at[i]]),
        }
        for i in range(0, len(swept.headings), len(swept.headings) // count)
    ]


def _all(recipe: "Recipe", swept: "SweepLimits") -> dict[str, Any]:
    """Return the limits over all postures: in the four headings, and in the worst of each."""
    from lutgen.analysis import FOUR, WORST

    rows = []
    for i, name in enumerate(FOUR):
        # The headings go round evenly from the nose to the left.
        at = i * len(swept.headings) // len(FOUR)
        least, most = int(swept.least_at[at]), int(swept.most_at[at])
        rows.append((name, swept.least[at], least, swept.most[at], most))
    weakest, strongest = swept.weakest, swept.strongest
    guaranteed = swept.guaranteed
    rows.append((WORST, guaranteed[weakest], weakest, guaranteed[strongest], strongest))
    slopes = swept.guaranteed_ground
    low, high = int(slopes.argmin()), int(slopes.argmax())
    return {
        "postures": len(swept.params),
        "tip_on_level_ground": int((swept.level < 0.0).sum()),
        "limits": [
            {
                "name": name,
                "least_tilt_deg": _down(least),
                "least_at": by_unit(recipe, swept.params[least_at]),
                "largest_tilt_deg": _down(most),
                "largest_at": by_unit(recipe, swept.params[most_at]),
            }
            for name, least, least_at, most, most_at in rows
        ],
        "ground": {
            "least_guaranteed_tip_deg": _down(slopes[low]),
            "least_at": by_unit(recipe, swept.params[low]),
            "largest_guaranteed_tip_deg": _down(slopes[high]),
            "largest_at": by_unit(recipe, swept.params[high]),
        },
    }


def _angle(angle: float) -> str:
    """Return a limit as text: rounded down, so that what is printed holds, too."""
    from lutgen.analysis import rounded_down

    # The tenth decimal is rounded down already.
    return "never" if angle >= 180.0 - 1e-9 else f"{rounded_down(angle):.2f} deg"


def limits_lines(report: dict[str, Any]) -> Iterator[str]:
    """Return the report as text."""
    start = {"plane": "it stands on level ground", "body": "its body is level"}
    yield f"{report['robot']}: largest tilt before it tips over"
    if report["posture"]:
        source = report.get("posture_from", "given")
        yield posture_text(report["posture"]) + ("" if source == "given" else f" ({source})")
    yield f"body tilt: of the robot, as it senses it, from where {start[report['convention']]}"
    yield "ground tilt: slope of the ground, the robot seated on it anew at each tilt"
    rubs = report["friction"] is not None
    rows = [["heading", "", "body tilt", "turns over", "ground tilt", "turns over", "friction"]]
    for row in report["limits"]:
        heading, first = cell(row["heading_deg"], ".1f", " deg"), FIRST[row["slides_first"]]
        rows.append([row["name"], heading, *_of_both(row), first])
    worst = report["worst_ground_heading_deg"]
    if worst is not None:
        tilt, axis = _angle(report["worst_ground_tilt_deg"]), report["worst_ground_contacts"]
        rows.append([WORST_GROUND, f"{worst:.1f} deg", "", "", tilt, " - ".join(axis) or "-", ""])
    yield from aligned([row if rubs else row[:-1] for row in rows])
    yield from _guaranteed_lines(report)
    if rubs:
        yield (
            f"slides on slopes above {_angle(report['friction_angle_deg'])} "
            f"(friction {report['friction']:g}, all contacts braked)"
        )
    if "all_postures" in report:
        yield from _all_lines(report["all_postures"])
    if "best_postures" in report:
        rows = [["heading", "body tilt", "best posture"]]
        for row in report["best_postures"]:
            heading = f"{row['heading_deg']:.1f} deg"
            rows.append([heading, _angle(row["tilt_deg"]), posture_text(row["posture"])])
        yield ""
        yield from aligned(rows)


def _of_both(row: dict[str, Any]) -> list[str]:
    """Return the cells of a heading: body tilt, what it turns over, and the same of the ground."""
    cells = []
    for before in ("", "ground_"):
        names = " - ".join(row[f"{before}contacts"]) or "-"
        cells += [_angle(row[f"{before}tilt_deg"]), names]
    return cells


def _guaranteed_lines(report: dict[str, Any]) -> Iterator[str]:
    """Return what holds in every heading, and what of."""
    tips = report["guaranteed_ground_tip_deg"]
    if not report["stands_on_level_ground"]:
        yield "it tips over on level ground"
        return
    body, ground = (_angle(report[f"guaranteed_{of}_tilt_deg"]) for of in ("body", "ground"))
    yield f"guaranteed body tilt in every heading: {body} (tipping over; sliding not included)"
    if report["ground_sliding_included"]:
        more = "" if ground == _angle(tips) else f"; tipping over alone {_angle(tips)}"
        rolling = "" if report["ground_rolling_included"] is None else ", rolling not"
        words = f"sliding included{rolling}{more}"
    else:
        why = "forces act" if report["forces_act"] else "friction is not known"
        words = f"tipping over; sliding not included, {why}"
    yield f"guaranteed ground tilt in every heading: {ground} ({words})"


def _all_lines(found: dict[str, Any]) -> Iterator[str]:
    """Return the limits over all postures as text."""
    tipping = found["tip_on_level_ground"]
    more = f", of which {tipping} tip over on level ground" if tipping else ""
    rows = [["body tilt", "least", "at", "largest", "at"]]
    for row in found["limits"]:
        ends = ((row[f"{end}_tilt_deg"], row[f"{end}_at"]) for end in ("least", "largest"))
        rows.append(
            [row["name"], *(text for a, at in ends for text in (_angle(a), posture_text(at)))]
        )
    ground = found["ground"]
    ends = ((ground[f"{e}_guaranteed_tip_deg"], ground[f"{e}_at"]) for e in ("least", "largest"))
    name = "ground tilt, guaranteed"
    rows.append([name, *(text for a, at in ends for text in (_angle(a), posture_text(at)))])
    yield ""
    yield f"over {found['postures']} postures of the sweep{more}"
    yield from aligned(rows)
    where = found["limits"][-1]["largest_at"]
    if where:
        yield f"best posture: {posture_text(where)}"

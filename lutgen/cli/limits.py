"""`lutgen limits`: how far a robot can be tilted, in one posture or in all."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from lutgen import bounds
from lutgen.cli import options as given
from lutgen.cli import output
from lutgen.cli.lazy import analysis, np, robots
from lutgen.cli.options import FigureOptions, RecipeOptions, command, option

# The curves of the figure have this many headings or more.
FIGURE = 72
FIRST = {None: "-", True: "slides first", False: "tips first"}


@dataclass(frozen=True)
class Options(RecipeOptions, FigureOptions):
    assignments: tuple[tuple[str, float], ...] = given.parameters()
    over_all: bool = option("Also over all postures of the sweep.", "--all")
    best: bool = option("Also the best posture of the sweep in each heading.")
    headings: int = option("How many the table of --best has; a multiple of 4.", default=24)
    convention: str = given.convention(
        "plane", "body", "Count body tilt from level ground under it, or from a level body."
    )
    least_share: tuple[tuple[str, float], ...] = option(
        "Also up to which body tilt a group or contact carries this share of the weight.",
        type=given.Numbers("NAME=SHARE", "share", "for example front=0.2"),
    )
    output: str | None = given.output("Figure (PNG, SVG or PDF).")


@command("recipe", Options)
def limits(robot: "robots.Recipe", options: Options) -> None:
    """Print how far RECIPE can be tilted before it tips over.

    With its shape kept: nose down, left side down, nose up, right side down and in its worst
    heading.  Body tilt is the robot's own, as an accelerometer in it reads it; ground tilt is the
    slope of the ground, on which it may rock from rest to rest.  A guarantee holds in every
    heading, also between those listed (of the ground: where it has not been steeper before), and
    all limits are rounded down.  Exit code 3 where it tips over on level ground.

    \b
    $ lutgen limits maps/absolem.toml -p front=90 -p rear=90
    guaranteed ground tilt in every heading: 38.65 deg (sliding included; ...)
    """
    output.check_outputs(options.force, options.output)
    # Refused before the work, which takes as many as the figure needs.
    around = analysis.even_headings(options.headings)
    posture = analysis.Posture(robot, given.posture_values(robot, options.assignments))
    found, swept = analysis.posture_limits(posture, options.convention), None
    if options.over_all or options.best:
        grid = robot.grid
        around = analysis.even_headings(options.headings * -(-FIGURE // options.headings))
        # Before a row of parameters is made for each.
        way_out = "sweep fewer samples, or fewer headings"
        bounds.check(grid.size * len(around), bounds.LIMITS, robot.source, way_out)
        rows = grid.params(range(grid.size))
        swept = analysis.sweep_limits(robot, rows, around, options.convention)
    output.save_figure(
        lambda plot: plot.draw_limits(robot, found, swept, worst=options.over_all),
        options.output,
        options,
    )
    report = limits_report(robot, found)
    report["posture_from"] = given.posture_source(robot, options.assignments) or "given"
    if options.least_share:
        wanted, convention = options.least_share, options.convention
        report["share_limits"] = [share_entry(posture, *one, convention) for one in wanted]
    if swept is not None and options.over_all:
        report["all_postures"] = all_postures(robot, swept)
    if swept is not None and options.best:
        # The swept headings are a multiple of those that are listed.
        report["best_postures"] = [
            {
                "heading_deg": math.degrees(swept.headings[i]),
                "tilt_deg": down(swept.most[i]),
                "posture": output.by_unit(robot, swept.params[swept.most_at[i]]),
            }
            for i in range(0, len(around), len(around) // options.headings)
        ]
    output.show(report, limits_lines, 0 if found.stands else output.TIPS)


def limits_report(recipe: "robots.Recipe", found: "analysis.PostureLimits") -> dict[str, Any]:
    """Return what `--json` prints of one posture; null where there is no value.

    Without "ground" in their names tilts are those of the body, and count tipping over alone.
    """
    mu, ground = recipe.friction, found.ground
    # Without a worst heading of body tilt that of ground tilt is beside it.
    around = [ground.worst if math.isnan(row.heading) else row.heading for row in found.headings]
    slopes = ground.limits(np.nan_to_num(around))
    return {
        **output.entries(recipe, "robot=name length_unit"),
        "convention": found.convention,
        "posture": output.by_unit(recipe, found.params),
        "friction": mu,
        "friction_angle_deg": None if mu is None else down(math.atan(mu)),
        "limits": [
            {
                "name": row.name,
                "heading_deg": output.degrees(row.heading),
                "tilt_deg": down(row.tilt),
                **output.entries(row, "contacts slides_first=slides"),
                "ground_tilt_deg": down(slope),
                "ground_contacts": ground.contacts(heading),
            }
            for row, heading, slope in zip(found.headings, around, slopes.tolist(), strict=True)
        ],
        "guaranteed_tilt_deg": down(found.guaranteed),
        "guaranteed_body_tilt_deg": down(found.guaranteed),
        "guaranteed_ground_tilt_deg": down(found.guaranteed_ground),
        "guaranteed_ground_tip_deg": down(ground.guaranteed),
        "ground_sliding_included": found.slide is not None,
        "worst_ground_heading_deg": output.degrees(ground.worst),
        "worst_ground_tilt_deg": down(ground.least),
        "worst_ground_contacts": ground.contacts(ground.worst),
        # On contacts that roll it may give way before it slides.
        "ground_rolling_included": False if any(c.rolling for c in recipe.contacts) else None,
        "forces_act": recipe.has_wrench,
        "stands_on_level_ground": found.stands,
    }


def share_entry(
    posture: "analysis.Posture", name: str, share: float, convention: str
) -> dict[str, Any]:
    """Return up to which tilts a group or contact carries its share, and the least all round."""
    around = analysis.share_limits(posture, name, share, analysis.even_headings(FIGURE), convention)
    four = around[np.arange(len(analysis.FOUR)) * (FIGURE // len(analysis.FOUR))]
    tilts = {key: down(tilt) for key, tilt in zip(analysis.FOUR, four.tolist(), strict=True)}
    return {"name": name, "least_share": share, "tilt_deg": tilts, "worst_deg": down(around.min())}


def down(angle: float) -> float:
    """Return an angle in deg, from rad, rounded down at its tenth decimal."""
    return analysis.rounded_down(math.degrees(angle), 10)


def all_postures(recipe: "robots.Recipe", swept: "analysis.SweepLimits") -> dict[str, Any]:
    """Return the limits over all postures: in the four headings, and in the worst of each."""

    def ends(rows: Sequence[int], tilts: Any, name: str = "tilt") -> dict[str, Any]:
        at = [output.by_unit(recipe, swept.params[row]) for row in rows]
        return {
            f"least_{name}_deg": down(tilts[0]),
            "least_at": at[0],
            f"largest_{name}_deg": down(tilts[1]),
            "largest_at": at[1],
        }

    rows = []
    for i, name in enumerate(analysis.FOUR):
        # The headings go round evenly from the nose to the left.
        at = i * len(swept.headings) // len(analysis.FOUR)
        postures = [int(swept.least_at[at]), int(swept.most_at[at])]
        rows.append({"name": name, **ends(postures, (swept.least[at], swept.most[at]))})
    tilts, slopes = swept.guaranteed, swept.guaranteed_ground
    body, ground = ([int(of.argmin()), int(of.argmax())] for of in (tilts, slopes))
    return {
        "postures": len(swept.params),
        "tip_on_level_ground": int((swept.level < 0.0).sum()),
        "limits": [*rows, {"name": analysis.WORST, **ends(body, tilts[body])}],
        "ground": ends(ground, slopes[ground], "guaranteed_tip"),
    }


def angle_text(angle: float) -> str:
    """Return a limit as text: rounded down, so that what is printed holds, too."""
    # The tenth decimal is rounded down already.
    return "never" if angle >= 180.0 - 1e-9 else f"{analysis.rounded_down(angle):.2f} deg"


def limits_lines(report: dict[str, Any]) -> Iterator[Sequence[str]]:
    """Return the report as text."""
    start = {"plane": "it stands on level ground", "body": "its body is level"}
    yield f"{report['robot']}: largest tilt before it tips over"
    if report["posture"]:
        source = report["posture_from"]
        yield output.posture_text(report["posture"]) + ("" if source == "given" else f" ({source})")
    yield f"body tilt: of the robot, as it senses it, from where {start[report['convention']]}"
    yield "ground tilt: slope of the ground, the robot seated on it anew at each tilt"
    rubs = report["friction"] is not None
    for row in heading_rows(report):
        yield row if rubs else row[:-1]
    yield from guaranteed_lines(report)
    if rubs:
        yield (
            f"slides on slopes above {angle_text(report['friction_angle_deg'])} "
            f"(friction {report['friction']:g}, all contacts braked)"
        )
    for found in report.get("share_limits", ()):
        percent, least = f"{100.0 * found['least_share']:g} %", angle_text(found["worst_deg"])
        tilts = ", ".join(f"{key} {angle_text(tilt)}" for key, tilt in found["tilt_deg"].items())
        yield f"{found['name']} carries {percent} of the weight up to a body tilt of"
        yield f"  {tilts}; in the worst of {FIGURE} headings {least}"
    if "all_postures" in report:
        yield from all_lines(report["all_postures"])
    if "best_postures" in report:
        yield ""
        yield ["heading", "body tilt", "best posture"]
        for best in report["best_postures"]:
            posture = output.posture_text(best["posture"])
            yield [f"{best['heading_deg']:.1f} deg", angle_text(best["tilt_deg"]), posture]


def heading_rows(report: dict[str, Any]) -> Iterator[list[str]]:
    """Return the rows of the headings; that of the worst on the ground where it is another one."""
    yield ["heading", "body tilt", "ground tilt", "turns over", "friction"]
    for row in report["limits"]:
        body, ground = (" - ".join(row[key]) or "-" for key in ("contacts", "ground_contacts"))
        same = ground == "-" or {*row["contacts"]} == {*row["ground_contacts"]}
        over = body if same else f"{body} (ground {ground})"
        name, heading = row["name"], row["heading_deg"]
        if row is report["limits"][-1] and heading is not None:
            name += f", {heading:.1f} deg"
        tilts = [angle_text(row[key]) for key in ("tilt_deg", "ground_tilt_deg")]
        yield [name, *tilts, over, FIRST[row["slides_first"]]]
    worst = report["worst_ground_heading_deg"]
    if worst is not None and f"{worst:.1f}" != (heading is not None and f"{heading:.1f}"):
        over = " - ".join(report["worst_ground_contacts"]) or "-"
        tilt = angle_text(report["worst_ground_tilt_deg"])
        yield [f"worst on the ground, {worst:.1f} deg", "", tilt, over, ""]


def guaranteed_lines(report: dict[str, Any]) -> Iterator[str]:
    """Return what holds in every heading, and what of."""
    tips = report["guaranteed_ground_tip_deg"]
    if not report["stands_on_level_ground"]:
        yield "it tips over on level ground"
        return
    body, ground = (angle_text(report[f"guaranteed_{of}_tilt_deg"]) for of in ("body", "ground"))
    yield f"guaranteed body tilt in every heading: {body} (tipping over; sliding not included)"
    if report["ground_sliding_included"]:
        more = "" if ground == angle_text(tips) else f"; tipping over alone {angle_text(tips)}"
        rolling = "" if report["ground_rolling_included"] is None else ", rolling not"
        words = f"sliding included{rolling}{more}"
    else:
        why = "forces act" if report["forces_act"] else "friction is not known"
        words = f"tipping over; sliding not included, {why}"
    yield f"guaranteed ground tilt in every heading: {ground} ({words})"


def all_lines(found: dict[str, Any]) -> Iterator[Sequence[str]]:
    """Return the limits over all postures as text."""
    tipping = found["tip_on_level_ground"]
    more = f", of which {tipping} tip over on level ground" if tipping else ""
    yield ""
    yield f"over {found['postures']} postures of the sweep{more}"
    yield ["body tilt", "least", "at", "largest", "at"]
    ground = {"name": "ground tilt, guaranteed", **found["ground"]}
    for row, of in [*((row, "tilt") for row in found["limits"]), (ground, "guaranteed_tip")]:
        ends = ((row[f"{end}_{of}_deg"], row[f"{end}_at"]) for end in ("least", "largest"))
        cells = [text for tilt, at in ends for text in (angle_text(tilt), output.posture_text(at))]
        yield [row["name"], *cells]
    where = found["limits"][-1]["largest_at"]
    if where:
        yield f"best posture: {output.posture_text(where)}"

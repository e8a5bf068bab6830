"""`lutgen metrics`: five metrics of stability side by side."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from lutgen import bounds
from lutgen.cli import options as given
from lutgen.cli import output
from lutgen.cli.lazy import analysis, np
from lutgen.cli.options import RecipeOptions, command, open_recipe, option
from lutgen.quantities import QUANTITIES


@dataclass(frozen=True)
class Options(RecipeOptions):
    assignments: tuple[tuple[str, float], ...] = given.parameters()
    tilt: float = option(
        type=given.Number(float, 0.0, 180.0),
        default=20.0,
        help="Of the ground in deg, for the metrics over all headings.",
    )
    headings: int = option(
        type=given.Number(int, 1, bounds.HEADINGS.most),
        default=24,
        help="How many headings, evenly spaced, the first nose down.",
    )


@command("recipe", Options)
def metrics(recipe: str, options: Options) -> None:
    """Compare five metrics of stability over all headings.

    They are |SD_g|, tip-over angle, static and energy margin, and force-angle, that of a weight of
    1.  Only the tip-over angle's sign is a verdict.

    \b
    $ lutgen metrics maps/paper_two.toml -p alpha=31 -p gamma=31 --tilt 20
    """
    robot = open_recipe(recipe, options.allow_python)
    posture = analysis.Posture(robot, given.posture_values(robot, options.assignments))
    around = np.arange(options.headings) * (360.0 / options.headings)
    down = analysis.tilted(math.radians(options.tilt), np.radians(around))
    found = analysis.compare_metrics(posture, down)
    held: list[dict[str, bool]] = [{} for _ in around]
    if any(contact.rolling for contact in robot.contacts):
        holds, may = analysis.holds(posture, down), analysis.may_hold(posture, down)
        held = [{"holds": holds[i], "may_hold": may[i]} for i in range(len(around))]
    report = {
        **output.entries(robot, "robot=name length_unit"),
        "tilt_deg": options.tilt,
        "level": {
            "status": QUANTITIES["status"].word(found.level_status),
            **output.channel_entries(found.level),
        },
        "headings": [
            {
                "heading_deg": heading,
                "standing": found.standing[i],
                "status": QUANTITIES["status"].word(found.status[i]),
                "least_share": found.least_share[i],
                **output.channel_entries({name: row[i] for name, row in found.values.items()}),
                "normalised": {name: row[i] for name, row in found.normalised.items()},
                **held[i],
            }
            for i, heading in enumerate(around.tolist())
        ],
        **output.posture_entries(robot, posture.params, options.assignments),
    }
    output.show(report, metrics_lines, options.as_json)


def metrics_lines(report: dict[str, Any]) -> Iterator[str]:
    """Return the report as text: one row per heading, and one for level ground."""
    length = output.unit_text(report["length_unit"])
    columns = {
        "sdg": f"sdg{length}",
        "tip_angle_deg": "tip_angle deg",
        "margin": f"margin{length}",
        "energy_margin": f"energy{length}",
        "force_angle_rad": f"force_angle rad{length}",
        "least_share": "least share",
    }
    rolling = "holds" in report["headings"][0]
    rows = [["heading deg", "verdict", *columns.values(), *(["holds"] if rolling else [])]]
    for entry in (report["level"], *report["headings"]):
        heading = f"{entry['heading_deg']:g}" if "heading_deg" in entry else "level"
        cells = [output.cell(entry.get(key)) for key in columns]
        rows.append([heading, output.VERDICTS[entry["status"]], *cells])
        if rolling:
            held = "yes" if entry.get("holds", True) else "may" if entry["may_hold"] else "no"
            rows[-1].append(held)
    yield f"{report['robot']}: tilted {report['tilt_deg']:g} deg"
    yield from output.posture_lines(report)
    yield from output.aligned(rows, numbers=(0, *range(2, 9)))

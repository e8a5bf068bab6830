"""The paper's third simulation: the rough-terrain path, without and with control.

Owns the runs and their variants.  The paper leaves open which way its wheels point, how the robot
leans on its path and where the nodes of its search lie; this is one reading that is consistent
with the two percentages that it prints, and the variants show how much hangs on the choice.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from lutgen.paper.checks_path import equal_spacing
from lutgen.paper.closed_form import tipping_points
from lutgen.paper.nominal import AHEAD, NOMINAL, TO_THE_LEFT
from lutgen.paper.published import POINTS
from lutgen.paper.robot import paper_recipe
from lutgen.recipe import Recipe
from lutgen.search import Drive, drive, paper_path

# Headings among which the robot may turn.
HEADINGS = 24
# Points of the path besides the paper's number.
OTHER_POINTS = (50, 200, 500, 1000)
BEHIND = (60.0, -60.0, 180.0)
# What the runs are asked: without control, with the geometry found for the point before or for the
# point itself, with the heading alone free to turn, and with heading and shape.
RUNS: dict[str, dict[str, Any]] = {
    "fixed": {"control": False},
    "lagged": {},
    "prompt": {"lag": 0},
    "turning": {"control": False, "headings": HEADINGS},
    "both": {"headings": HEADINGS},
}


def third_simulation() -> dict[str, Drive]:
    """Compute simulation 3 (Figs 16 and 17) and the runs in which the robot may turn."""
    recipe = paper_recipe(azimuths=TO_THE_LEFT)
    return {name: _run(recipe, **options) for name, options in RUNS.items()}


def _run(recipe: Recipe, attitude: str = "pitch", **options: Any) -> Drive:
    """Drive from the nominal shape along the paper's path."""
    return drive(recipe, paper_path(POINTS, attitude), params0=np.full(2, NOMINAL), **options)


@dataclass(frozen=True)
class Variant:
    """One other reading of simulation 3, and the shares that tip without and with control."""

    name: str
    points: int
    without: float
    control: float


def variants(third: dict[str, Drive]) -> tuple[Variant, ...]:
    """Return the shares for readings of the paper that depart from the `third` in one thing."""
    fixed, recipe = third["fixed"].share, paper_recipe(azimuths=TO_THE_LEFT)

    def shares(name: str, robot: Recipe, attitude: str = "pitch", **options: Any) -> Variant:
        where = {key: options[key] for key in ("convention",) if key in options}
        without = _run(robot, attitude, control=False, **where)
        return Variant(name, POINTS, without.share, _run(robot, attitude, **options).share)

    return (
        Variant("the reading above", POINTS, fixed, third["lagged"].share),
        *map(_more_points, OTHER_POINTS),
        shares("nodes of the search at the right ends of its cells", recipe, ends="right"),
        Variant(
            "no lag: the geometry found for the point itself", POINTS, fixed, third["prompt"].share
        ),
        shares("ground level across the path, heading kept", recipe, "surface"),
        shares("gravity fixed in the body while the legs move (F)", recipe, convention="body"),
        shares("P1 ahead", paper_recipe(azimuths=AHEAD)),
        shares("P1 and P2 ahead, P3 behind", paper_recipe(azimuths=BEHIND)),
        shares(
            "tip-over angle as the objective instead of $|SD_g|$", recipe, objective="tip_angle"
        ),
    )


def _more_points(points: int) -> Variant:
    """Return the shares for another number of points, in closed form: it takes no time."""
    places = equal_spacing(points)
    tips = [tipping_points(places, control) / points for control in (False, True)]
    return Variant("other number of points", points, *tips)

"""The paper's third simulation: the rough-terrain path, without and with control.

Owns the runs and their variants.  The paper leaves open which way its wheels point, how the robot
leans on its path and where the nodes of its search lie; this is one reading that is consistent
with the two percentages that it prints, and the variants show how much hangs on the choice.
"""

from dataclasses import dataclass

import numpy as np

from lutgen.paper.robot import NOMINAL, paper_recipe
from lutgen.recipe import Recipe
from lutgen.search import Drive, drive, paper_path

__all__ = ["HEADINGS", "Third", "Variant", "third_simulation", "variants"]

# P1 ahead to the left, P2 back to the left, the fixed P3 to the right; travel is along x.
AZIMUTHS = (30.0, 150.0, 270.0)
POINTS = 100
# Headings among which the robot may turn.
HEADINGS = 24


@dataclass(frozen=True)
class Third:
    """The runs of simulation 3, of 100 points each.

    `fixed` without control, `lagged` with the geometry found for the point before, `prompt`
    with that for the point itself; `turning` may turn its heading only, `both` heading and shape.
    """

    recipe: Recipe
    fixed: Drive
    lagged: Drive
    prompt: Drive
    turning: Drive
    both: Drive


def third_simulation() -> Third:
    """Compute simulation 3 (Figs 16 and 17) and the run in which the robot may turn."""
    recipe = paper_recipe(azimuths=AZIMUTHS)
    path = paper_path(POINTS)
    nominal = np.full(2, NOMINAL)

    def run(**options: object) -> Drive:
        return drive(recipe, path, params0=nominal, **options)  # type: ignore[arg-type]

    return Third(
        recipe,
        run(control=False),
        run(),
        run(lag=0),
        run(control=False, headings=HEADINGS),
        run(headings=HEADINGS),
    )


@dataclass(frozen=True)
class Variant:
    """One other reading of simulation 3, and the shares that tip without and with control."""

    name: str
    points: int
    without: float
    control: float


def variants() -> tuple[Variant, ...]:
    """Return the shares for other numbers of points and other readings of the paper."""
    nominal = np.full(2, NOMINAL)
    recipe = paper_recipe(azimuths=AZIMUTHS)

    def shares(
        name: str,
        points: int = POINTS,
        robot: Recipe = recipe,
        attitude: str = "pitch",
        **options: object,
    ) -> Variant:
        path = paper_path(points, attitude)
        where = {key: options[key] for key in ("convention",) if key in options}
        without = drive(robot, path, control=False, params0=nominal, **where)  # type: ignore[arg-type]
        control = drive(robot, path, params0=nominal, **options)  # type: ignore[arg-type]
        return Variant(name, points, without.share, control.share)

    ahead, behind = (
        paper_recipe(azimuths=(0.0, 120.0, 240.0)),
        paper_recipe(azimuths=(60.0, -60.0, 180.0)),
    )
    return (
        shares("the reading above"),
        *(shares("other number of points", points=count) for count in (50, 200, 500, 1000)),
        shares("nodes of the search at the right ends of its cells", ends="right"),
        shares("no lag: the geometry found for the point itself", lag=0),
        shares("ground level across the path, heading kept", attitude="surface"),
        shares("gravity fixed in the body while the legs move (F)", convention="body"),
        shares("P1 ahead", robot=ahead),
        shares("P1 and P2 ahead, P3 behind", robot=behind),
        shares("tip-over angle as the objective instead of |SD_g|", objective="tip_angle"),
    )

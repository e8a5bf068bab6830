"""The kinds of figures: how each is drawn, and what may be asked of it."""

from collections.abc import Callable
from dataclasses import dataclass

from matplotlib.figure import Figure

from lutgen.plot.curve import draw_curve
from lutgen.plot.metrics import draw_metrics
from lutgen.plot.plane import draw_contour, draw_surface
from lutgen.plot.robot import draw_robot
from lutgen.plot.sphere import draw_sphere
from lutgen.plot.tilt import draw_polar
from lutgen.plot.view import View

__all__ = ["KINDS", "Kind"]


@dataclass(frozen=True)
class Kind:
    """A kind of figure.

    `paint` draws it in a size (inches, or None); `varies` is the number of parameters along its
    axes; `of_robot` tells whether it needs the robot itself, and not a map of code that is not run;
    `turns` whether it turns gravity in the body itself.
    """

    paint: Callable[[View, tuple[float, float] | None], Figure]
    varies: int = 0
    of_robot: bool = False
    turns: bool = False


KINDS = {
    "curve": Kind(draw_curve, varies=1),
    "contour": Kind(draw_contour, varies=2),
    "surface": Kind(draw_surface, varies=2),
    "sphere": Kind(draw_sphere, turns=True),
    "polar": Kind(draw_polar, of_robot=True, turns=True),
    "metrics": Kind(draw_metrics, of_robot=True, turns=True),
    "robot": Kind(draw_robot, of_robot=True),
}

"""The kinds of figures, and one entry for all."""

from typing import Unpack

from matplotlib.figure import Figure

from lutgen.mapping import StabilityMap
from lutgen.plot.choices import Choices, Kind, choose, nearest, refuse
from lutgen.plot.curve import draw_curve
from lutgen.plot.metrics import draw_metrics
from lutgen.plot.plane import draw_contour, draw_surface
from lutgen.plot.robot import draw_robot
from lutgen.plot.sphere import draw_sphere
from lutgen.plot.style import in_house_style
from lutgen.plot.tilt import draw_polar
from lutgen.recipe import Recipe

KINDS = {
    kind.name: kind
    for kind in (
        Kind("curve", draw_curve, varies=1),
        Kind("contour", draw_contour, varies=2),
        Kind("surface", draw_surface, varies=2),
        Kind("sphere", draw_sphere, turns=True),
        Kind("polar", draw_polar, of_robot=True, turns=True),
        Kind("metrics", draw_metrics, of_robot=True, turns=True),
        Kind("robot", draw_robot, of_robot=True),
    )
}


@in_house_style
def draw(kind: str, source: StabilityMap | Recipe, **asked: Unpack[Choices]) -> Figure:
    """Draw a figure.

    Parameters
    ----------
    kind : {"curve", "contour", "surface", "sphere", "polar", "metrics", "robot"}
        `curve`: `channel` and the height over one parameter; `contour`, `surface`: `channel`
        over two parameters; `sphere`: `channel` over all gravity directions of the chart;
        `polar`: largest tilt before tip-over in each heading; `metrics`: five metrics over all
        headings at one tilt; `robot`: the body in 3-D.
    source : StabilityMap or Recipe
        For a map, `contour` and `surface` draw its nodes and `curve` marks them.  All else, such
        as tip-over boundaries, is evaluated exactly, as everything is for a recipe.
    params : mapping of str to float, optional
        Parameters in their display unit (deg for angles); the others are in the middle of their
        range.
    gravity : (3,) array_like
        Direction in the body frame, pointing down; not used by `sphere`, `polar` and
        `metrics`.
    channel : str
        One of `quantities.RANKED`; not used by `polar`, `metrics` and `robot`.
    axes : sequence of str, optional
        The parameters that `curve` (one), `contour` and `surface` (two) vary; by default the
        first ones that `params` does not fix.
    convention : {"body", "plane"}
        Whether gravity is fixed in the body frame, or relative to the contact plane, so that it
        turns in the body while the shape changes (T_g, see `lutgen.channels.settle`).  The
        latter for recipes only, and not for `sphere`, `polar` and `metrics`.
    tilt : float
        Degrees; used by `metrics` only.

    Returns
    -------
    matplotlib.figure.Figure
        Independent of pyplot; see `save`.

    Raises
    ------
    InputError
        For an unknown kind, parameter or channel, a value outside its range, and a direction
        that the map does not cover.
    """
    if kind not in KINDS:
        refuse("unknown kind of figure", kind, nearest(kind, KINDS))
    return KINDS[kind].paint(choose(KINDS[kind], source, asked))

"""The kinds of figures, their options, and one entry for all.

Every wrong option is refused in one sentence that names the way out.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, NoReturn

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from lutgen.channels import CONVENTIONS
from lutgen.chart import unit_directions
from lutgen.errors import InputError, reject, suggestion
from lutgen.mapping import StabilityMap
from lutgen.plot.contour import draw_contour
from lutgen.plot.curve import draw_curve
from lutgen.plot.scene import draw_robot
from lutgen.plot.sphere import draw_sphere
from lutgen.plot.style import in_house_style
from lutgen.plot.surface import draw_surface
from lutgen.plot.tilt import draw_polar
from lutgen.plot.view import View, is_sealed, limits
from lutgen.quantities import RANKED
from lutgen.recipe import Recipe, within_limits
from lutgen.vector import Floats

DOWN = (0.0, 0.0, -1.0)


class Kind(NamedTuple):
    """A kind of figure: how it is drawn, and its options.

    `varies` is the number of parameters along its axes; `of_robot` is True if it needs
    the robot itself, and not a map of code that is not run; `turns` if it turns gravity itself.
    """

    paint: Callable[[View], Figure]
    varies: int = 0
    of_robot: bool = False
    turns: bool = False


KINDS = {
    "curve": Kind(draw_curve, varies=1),
    "contour": Kind(draw_contour, varies=2),
    "surface": Kind(draw_surface, varies=2),
    "sphere": Kind(draw_sphere, turns=True),
    "polar": Kind(draw_polar, of_robot=True, turns=True),
    "robot": Kind(draw_robot, of_robot=True),
}
CHOOSE = "choose from"


@dataclass(frozen=True)
class Options:
    """What a figure shows.

    Parameters
    ----------
    params : mapping of str to float, optional
        Parameters in their display unit (deg for angles); the others are at the recipe's `home`,
        or in the middle of their range.
    gravity : (3,) array_like
        Direction in the body frame, pointing down; not used by `sphere` and `polar`.
    channel : str
        One of `quantities.RANKED`; not used by `polar` and `robot`.
    axes : sequence of str, optional
        The parameters that `curve` (one), `contour` and `surface` (two) vary; by default the
        first ones that `params` does not fix.
    convention : {"body", "plane"}
        Gravity is fixed in the body frame, or relative to the contact plane (T_g, see
        `lutgen.channels.resting`): for recipes only, and not for `sphere` and `polar`.
    scale : (2,) of float, optional
        Least span of the colours, in the unit that is shown: figures of one scale can be
        compared.  Tip-over angles always span 0 to 60 deg.
    ax : matplotlib.axes.Axes, optional
        Draws into these axes, without what stands beside them, and leaves their figure as it is.
    """

    params: Mapping[str, float] | None = None
    gravity: ArrayLike = DOWN
    channel: str = "tip_angle"
    axes: Sequence[str] | None = None
    convention: str = "body"
    scale: tuple[float, float] | None = None
    ax: Axes | None = None


@in_house_style
def draw(kind: str, source: StabilityMap | Recipe, **options: Any) -> Figure:
    """Draw a figure whose title is its answer; `options` are those of `Options`.

    Kinds are `curve`: `channel` over one parameter; `contour`, `surface`: over two, with the best
    posture; `sphere`: `channel` under every gravity at one posture; `polar`: largest tilt before it
    tips over in each heading; `robot`: what it stands on, and over which edge it goes first.  A
    figure of a map covers the map's ranges, and `curve` marks its nodes.  Values are evaluated
    exactly; only of a robot of code that is not run are they the map's.  `save` writes the figure.
    """
    chosen = Options(**options)
    if kind not in KINDS:
        _refuse("unknown kind of figure", kind, suggestion(kind, KINDS, CHOOSE))
    one, channel, scale = KINDS[kind], chosen.channel, chosen.scale
    stability_map = None if isinstance(source, Recipe) else source
    recipe = source if isinstance(source, Recipe) else source.recipe
    if channel not in RANKED:
        _refuse("channel cannot be drawn", channel, suggestion(channel, RANKED, CHOOSE))
    if stability_map is not None and one.varies and channel not in stability_map.channels:
        stored = [name for name in stability_map.channels if name in RANKED]
        way_out = f"{suggestion(channel, stored, CHOOSE)} or a recipe"
        _refuse("channel is not in the map", channel, way_out)
    if scale is not None and not (all(map(math.isfinite, scale)) and scale[0] < scale[1]):
        what = "a scale goes from a number to a larger one"
        _refuse(what, ", ".join(f"{x:g}" for x in scale), "give two such as 0, 60")
    if one.of_robot and is_sealed(recipe):
        way_out = "draw it from the recipe, with its code allowed"
        _refuse(f"a {kind} figure needs the robot itself", f"a map of `{recipe.python}`", way_out)
    down = unit_directions(np.asarray(chosen.gravity, dtype=np.float64))
    if down.shape != (3,):
        _refuse("gravity must be one direction", np.shape(chosen.gravity), "give x, y, z")
    convention = chosen.convention
    if convention not in CONVENTIONS:
        _refuse("unknown convention", convention, suggestion(convention, CONVENTIONS, CHOOSE))
    if convention == "plane" and stability_map is not None:
        _refuse("gravity of a map is fixed in the body", convention, "draw from the recipe")
    if convention == "plane" and one.turns:
        _refuse(f"a {kind} figure turns gravity in the body itself", convention, "leave it out")
    given = chosen.params or {}
    posture = _posture(recipe, stability_map, given)
    columns = _columns(kind, recipe, given, chosen.axes)
    on_chart = stability_map is None or bool(stability_map.chart.locate(down[None, :])[3][0])
    if one.varies == 2 and not on_chart:
        way_out = "choose a direction that the map covers, or draw from the recipe"
        _refuse("gravity is outside the map's chart", ", ".join(f"{x:g}" for x in down), way_out)
    where = (recipe, stability_map, posture, down, channel, columns)
    return one.paint(View(*where, convention, scale, chosen.ax))


def _posture(
    recipe: Recipe, stability_map: StabilityMap | None, given: Mapping[str, float]
) -> Floats:
    """Return the posture (k,), rad or length: what is given, inside its range, `home` or middle."""
    ends = [limits(recipe, stability_map, i) for i in range(len(recipe.parameters))]
    low, high = np.array(ends).reshape(-1, 2).T
    home = np.array([recipe.home.get(p.name, math.nan) for p in recipe.parameters])
    # A map may cover less than the recipe's range.
    posture = np.where((low <= home) & (home <= high), home, (low + high) / 2.0)
    for name, value in given.items():
        column = _column(recipe, name)
        posture[column] = recipe.parameters[column].stored(value)
    within_limits(recipe, [posture], ends)
    # Degrees come back from rad a rounding beyond the range.
    return np.clip(posture, low, high)


def _columns(
    kind: str, recipe: Recipe, given: Mapping[str, float], axes: Sequence[str] | None
) -> tuple[int, ...]:
    """Return the columns of the parameters that the figure varies."""
    names, count = [parameter.name for parameter in recipe.parameters], KINDS[kind].varies
    if axes is None:
        free = [name for name in names if name not in given]
        if len(free) < count:
            what = f"a {kind} varies {count} parameter(s) of {recipe.name}"
            every = ", ".join(names) or "none, it has no parameters"
            _refuse(what, f"{len(free)} that are free", f"leave more of these unset: {every}")
        return tuple(names.index(name) for name in free[:count])
    if len(axes) != count or len(set(axes)) != count:
        _refuse(f"a {kind} needs {count} different axes", ", ".join(axes) or "none", "correct axes")
    if both := [name for name in axes if name in given]:
        _refuse("parameter is both fixed and an axis", both[0], "leave it out of one of them")
    return tuple(_column(recipe, name) for name in axes)


def _column(recipe: Recipe, name: str) -> int:
    """Return the place of a parameter."""
    names = [parameter.name for parameter in recipe.parameters]
    if name not in names:
        _refuse(f"unknown parameter of {recipe.name}", name, suggestion(name, names, CHOOSE))
    return names.index(name)


def _refuse(what: str, got: object, way_out: str) -> NoReturn:
    """Say what is wrong with an option, what it was, and the way out."""
    reject("plot", what, got, way_out, InputError)

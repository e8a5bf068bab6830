"""The kinds of figures, what may be asked of them, and one entry for all.

Every wrong option is refused in one sentence that names the way out.
"""

import difflib
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NoReturn, TypedDict, Unpack

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from lutgen.channels import CONVENTIONS, body_gravity
from lutgen.chart import unit_directions
from lutgen.errors import InputError
from lutgen.mapping import StabilityMap
from lutgen.plot.curve import draw_curve
from lutgen.plot.metrics import draw_metrics
from lutgen.plot.plane import draw_contour, draw_surface
from lutgen.plot.robot import draw_robot
from lutgen.plot.sphere import draw_sphere
from lutgen.plot.style import in_house_style
from lutgen.plot.tilt import draw_polar
from lutgen.plot.view import SLACK, View, is_sealed, limits
from lutgen.quantities import RANKED
from lutgen.recipe import Recipe

DOWN = (0.0, 0.0, -1.0)


@dataclass(frozen=True)
class Kind:
    """A kind of figure: how it is drawn, and what may be asked of it.

    `paint` draws it; `varies` is the number of parameters along its axes; `of_robot` tells whether
    it needs the robot itself, and not a map of code that is not run; `turns` whether it turns
    gravity in the body itself.
    """

    name: str
    paint: Callable[[View], Figure]
    varies: int = 0
    of_robot: bool = False
    turns: bool = False


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


class Choices(TypedDict, total=False):
    """What may be asked of a figure, see `draw`."""

    params: Mapping[str, float] | None
    gravity: ArrayLike
    channel: str
    axes: Sequence[str] | None
    convention: str
    tilt: float
    scale: tuple[float, float] | None


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
        Parameters in their display unit (deg for angles); the others are at the recipe's `home`,
        or in the middle of their range.
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
        turns in the body while the shape changes (T_g, see `lutgen.channels.resting`).  The
        latter for recipes only, and not for `sphere`, `polar` and `metrics`.
    tilt : float
        Degrees; used by `metrics` only.
    scale : (2,) of float, optional
        What the colours of `contour`, `surface` and `sphere` have to span at least, in the unit
        that is shown: figures of one scale can be compared.

    Returns
    -------
    matplotlib.figure.Figure
        Independent of pyplot; see `save`.

    Raises
    ------
    InputError
        For an unknown kind, keyword, parameter or channel, a value outside its range, and a
        direction that the map does not cover.
    """
    if kind not in KINDS:
        _refuse("unknown kind of figure", kind, _nearest(kind, KINDS))
    for name in asked:
        if name not in Choices.__annotations__:
            _refuse("unknown keyword of a figure", name, _nearest(name, Choices.__annotations__))
    return KINDS[kind].paint(_choose(KINDS[kind], source, asked))


def _choose(kind: Kind, source: StabilityMap | Recipe, asked: Choices) -> View:
    """Check the options of `draw` and fill in what was left out."""
    channel, convention = asked.get("channel", "sdg"), asked.get("convention", "body")
    tilt = asked.get("tilt", 20.0)
    stability_map = None if isinstance(source, Recipe) else source
    recipe = source if isinstance(source, Recipe) else source.recipe
    if channel not in RANKED:
        _refuse("channel cannot be drawn", channel, _nearest(channel, RANKED))
    if stability_map is not None and kind.varies:
        held = [name for name in stability_map.channels if name in RANKED]
        if channel not in held:
            _refuse("channel is not in the map", channel, f"{_nearest(channel, held)} or a recipe")
    if not 0.0 <= tilt <= 180.0:
        _refuse("tilt must lie between 0 and 180 deg", f"{tilt:g}", "20 is the default")
    scale = asked.get("scale")
    if scale is not None and not (all(map(math.isfinite, scale)) and scale[0] < scale[1]):
        what = "a scale goes from a number to a larger one"
        _refuse(what, ", ".join(f"{x:g}" for x in scale), "give two such as 0, 60")
    if kind.of_robot and is_sealed(recipe):
        _refuse(
            f"a {kind.name} figure needs the robot itself",
            f"a map of `{recipe.python}`",
            "draw it from the recipe, with its code allowed",
        )
    direction = unit_directions(np.asarray(asked.get("gravity", DOWN), dtype=np.float64))
    if direction.shape != (3,):
        _refuse("gravity must be one direction", np.shape(asked["gravity"]), "give x, y, z")
    params = asked.get("params") or {}
    given = {name: _value(recipe, stability_map, name, v) for name, v in params.items()}
    columns = _columns(kind, recipe, given, asked.get("axes"))
    posture = []
    for i, p in enumerate(recipe.parameters):
        low, high = limits(recipe, stability_map, i)
        home = recipe.home.get(p.name, math.nan)
        # A map may cover less than the recipe's range.
        posture.append(given.get(p.name, home if low <= home <= high else (low + high) / 2.0))
    if convention not in CONVENTIONS:
        _refuse("unknown convention", convention, _nearest(convention, CONVENTIONS))
    if convention == "plane":
        if stability_map is not None:
            _refuse("gravity of a map is fixed in the body", convention, "draw from the recipe")
        if kind.turns:
            what = f"a {kind.name} figure turns gravity in the body itself"
            _refuse(what, convention, "leave it out")
        if kind.name == "robot":
            # One posture: where gravity points in its body is all there is to know.
            direction = body_gravity(recipe, np.array([posture]), direction, convention)[0]
    view = View(
        *(kind.name, recipe, stability_map, np.array(posture), direction, channel, columns),
        *(convention, math.radians(tilt), scale),
    )
    if kind.varies == 2 and stability_map is not None and not view.on_chart():
        _refuse(
            "gravity is outside the map's chart",
            ", ".join(f"{x:g}" for x in direction),
            "choose a direction that the map covers, or draw from the recipe",
        )
    return view


def _columns(
    kind: Kind, recipe: Recipe, given: Mapping[str, float], axes: Sequence[str] | None
) -> tuple[int, ...]:
    """Return the columns of the parameters that the figure varies."""
    names = [parameter.name for parameter in recipe.parameters]
    count = kind.varies
    if axes is None:
        free = [name for name in names if name not in given]
        if len(free) < count:
            _refuse(
                f"a {kind.name} varies {count} parameter(s) of {recipe.name}",
                f"{len(free)} that are free",
                f"leave more of these unset: {', '.join(names) or 'none, it has no parameters'}",
            )
        return tuple(names.index(name) for name in free[:count])
    if len(axes) != count or len(set(axes)) != count:
        what = f"a {kind.name} needs {count} different axes"
        _refuse(what, ", ".join(axes) or "none", "correct axes")
    columns = []
    for name in axes:
        columns.append(_column(recipe, name))
        if name in given:
            _refuse("parameter is both fixed and an axis", name, "leave it out of one of them")
    return tuple(columns)


def _column(recipe: Recipe, name: str) -> int:
    """Return the place of a parameter."""
    names = [parameter.name for parameter in recipe.parameters]
    if name not in names:
        _refuse(f"unknown parameter of {recipe.name}", name, _nearest(name, names))
    return names.index(name)


def _value(recipe: Recipe, stability_map: StabilityMap | None, name: str, value: float) -> float:
    """Return a given parameter value in rad or length, inside its range."""
    column = _column(recipe, name)
    parameter = recipe.parameters[column]
    low, high = limits(recipe, stability_map, column)
    inside = float(parameter.stored(value))
    slack = SLACK * (high - low)
    if not low - slack <= inside <= high + slack:
        shown = parameter.shown(np.array([low, high]))
        unit = "" if parameter.display_unit == "1" else f" {parameter.display_unit}"
        _refuse(
            f"parameter `{name}` is outside its range",
            f"{value:g}",
            f"choose from {shown[0]:g} to {shown[1]:g}{unit}",
        )
    return min(max(inside, low), high)


def _nearest(name: str, known: Iterable[str]) -> str:
    """Return the way out of a misspelt name."""
    names = list(known)
    close = difflib.get_close_matches(name, names, 1)
    if close:
        return f"did you mean '{close[0]}'"
    return f"choose from {', '.join(names) or 'none'}"


def _refuse(what: str, got: object, way_out: str) -> NoReturn:
    """Say what is wrong with an option, what it was, and the way out."""
    raise InputError(f"plot: {what} (got {got}); {way_out}.")

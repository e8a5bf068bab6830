"""What a figure shows: the robot, its posture, the gravity direction, the channel and the axes.

Checks every option once and answers where the numbers come from: a map where there is one, the
exact evaluation otherwise.  It knows nothing of colours and paper.
"""

import difflib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.errors import InputError
from lutgen.evaluation import evaluate
from lutgen.recipe import Recipe
from lutgen.recipe_robot import Parameter
from lutgen.sphere import unit_directions
from lutgen.store import StabilityMap

__all__ = [
    "KINDS",
    "QUANTITIES",
    "View",
    "choose",
    "in_display_unit",
    "optimum",
    "to_display",
    "to_internal",
]

Floats = NDArray[np.float64]

# How many parameters each kind of figure varies.
KINDS = {"curve": 1, "contour": 2, "surface": 2, "sphere": 0, "polar": 0, "robot": 0}
# The channels that are quantities, and which end of each is the good one; the sixth channel,
# `facet`, is an index and has no optimum.
QUANTITIES = {
    "sdg": "minimum",
    "height": "minimum",
    "tip_angle": "maximum",
    "margin": "maximum",
    "energy_margin": "maximum",
}
# A limit given in degrees comes back from radians within a few 1e-16 of itself.
RANGE_SLACK = 1e-9


@dataclass(frozen=True)
class View:
    """The checked options of a figure.

    `params` (k,) float64 is the posture, rad or length, with the middle of the range where the
    caller gave none; `axes` are the columns that the figure varies; `gravity_dir` (3,) is a unit
    vector in the body frame.
    """

    kind: str
    recipe: Recipe
    stability_map: StabilityMap | None
    params: Floats
    gravity_dir: Floats
    channel: str
    axes: tuple[int, ...]

    def parameter(self, place: int) -> Parameter:
        """Return the parameter on one of the figure's axes."""
        return self.recipe.parameters[self.axes[place]]

    def shown(self, place: int, values: ArrayLike) -> Floats:
        """Turn values of the parameter on a figure's axis into its display unit."""
        return to_display(self.parameter(place), values)

    def ends(self, place: int) -> tuple[float, float]:
        """Return the range of a figure's axis, rad or length."""
        return _limits(self.recipe, self.stability_map, self.axes[place])

    def knots(self, place: int, count: int) -> Floats:
        """Return the map's knots of a figure's axis, or `count` even values for a recipe."""
        if self.stability_map is not None:
            return np.asarray(self.stability_map.axes[self.axes[place]].knots)
        return np.linspace(*self.ends(place), count)

    def postures(self, *values: ArrayLike) -> Floats:
        """Return (m, k) postures that vary the figure's axes, one (m,) array per axis."""
        columns = [np.asarray(column, dtype=np.float64).ravel() for column in values]
        result = np.tile(self.params, (len(columns[0]), 1))
        for axis, column in zip(self.axes, columns, strict=True):
            result[:, axis] = column
        return result

    def exact(
        self, postures: ArrayLike, directions: ArrayLike, *channels: str
    ) -> dict[str, Floats]:
        """Return channels, each (m,), of m postures at one direction or of one at m directions.

        They are evaluated, unless the robot is code that a map does not run: then the map is read.
        """
        rows, down = np.atleast_2d(postures), np.atleast_2d(directions)
        if self.stability_map is not None and is_sealed(self.recipe):
            return self._read(rows, down, channels)
        values = evaluate(self.recipe, rows, down, channels)
        return {name: value.ravel() for name, value in values.items()}

    def drawn(self, postures: ArrayLike, directions: ArrayLike) -> Floats:
        """Return the figure's channel, (m,): what the map says, or exact without one.

        Next to a tip-over axis a map has no value where it is not sure of standing; the exact
        value stands in there, so that a figure has no gap between its colours and the axis.
        """
        rows, down = np.atleast_2d(postures), np.atleast_2d(directions)
        if self.stability_map is None:
            return self.exact(rows, down, self.channel)[self.channel]
        values = self._read(rows, down, (self.channel,))[self.channel]
        unknown = np.isnan(values)
        if unknown.any():
            exact = self.exact(
                rows[unknown] if len(rows) > 1 else rows,
                down[unknown] if len(down) > 1 else down,
                self.channel,
            )
            values[unknown] = exact[self.channel]
        return values

    def _read(self, rows: Floats, down: Floats, channels: tuple[str, ...]) -> dict[str, Floats]:
        """Interpolate the map."""
        if self.stability_map is None:
            return {}
        count = max(len(rows), len(down))
        return self.stability_map.read(
            np.broadcast_to(rows, (count, rows.shape[1])),
            np.broadcast_to(down, (count, 3)),
            channels,
        )

    def at_node(self) -> bool:
        """Tell whether the fixed parameters and gravity are all at nodes of the map."""
        if self.stability_map is None or not self.on_chart():
            return False
        chart = self.stability_map.chart
        _, u, v, _ = chart.locate(self.gravity_dir[None, :])
        apart = [np.abs(chart.coords - place).min() for place in (u[0], v[0])]
        apart += [
            np.abs(axis.knots - self.params[i]).min() / max(np.ptp(axis.knots), 1e-300)
            for i, axis in enumerate(self.stability_map.axes)
            if i not in self.axes
        ]
        return bool(max(apart) < RANGE_SLACK)

    def on_chart(self) -> bool:
        """Tell whether there is a map and it covers the figure's gravity direction."""
        if self.stability_map is None:
            return False
        return bool(self.stability_map.chart.locate(self.gravity_dir[None, :])[3][0])


def is_sealed(recipe: Recipe) -> bool:
    """Tell whether the robot is given by code that was not loaded, as in a map file."""
    return recipe.python is not None and recipe.function is None


def to_display(parameter: Parameter, value: ArrayLike) -> Floats:
    """Turn internal values of a parameter into its display unit."""
    values = np.asarray(value, dtype=np.float64)
    return np.degrees(values) if parameter.display_unit == "deg" else values


def to_internal(parameter: Parameter, value: ArrayLike) -> Floats:
    """Turn values in a parameter's display unit into rad or length."""
    values = np.asarray(value, dtype=np.float64)
    return np.radians(values) if parameter.display_unit == "deg" else values


def in_display_unit(channel: str, values: ArrayLike) -> Floats:
    """Turn values of a channel into what is printed: angles into deg, lengths as they are."""
    result = np.asarray(values, dtype=np.float64)
    return np.degrees(result) if channel == "tip_angle" else result


def optimum(channel: str, values: Floats) -> int | None:
    """Return the flat index of the best finite value of a channel; None if there is none."""
    flat = np.asarray(values).ravel()
    known = np.isfinite(flat)
    if not known.any():
        return None
    if QUANTITIES[channel] == "minimum":
        return int(np.argmin(np.where(known, flat, np.inf)))
    return int(np.argmax(np.where(known, flat, -np.inf)))


def choose(
    kind: str,
    source: StabilityMap | Recipe,
    params: Mapping[str, float] | None,
    gravity: ArrayLike,
    channel: str,
    axes: Sequence[str] | None,
) -> View:
    """Check the options of `lutgen.plot.draw` and fill in what was left out."""
    if kind not in KINDS:
        _refuse("unknown kind of figure", kind, _nearest(kind, KINDS))
    stability_map = None if isinstance(source, Recipe) else source
    recipe = source if isinstance(source, Recipe) else source.recipe
    if channel not in QUANTITIES:
        _refuse("channel cannot be drawn", channel, _nearest(channel, QUANTITIES))
    if stability_map is not None and KINDS[kind]:
        held = [name for name in stability_map.channels if name in QUANTITIES]
        if channel not in held:
            _refuse("channel is not in the map", channel, f"{_nearest(channel, held)} or a recipe")
    if kind in ("polar", "robot") and is_sealed(recipe):
        _refuse(
            f"a {kind} figure needs the robot itself",
            f"a map of `{recipe.python}`",
            "draw it from the recipe, with its code allowed",
        )
    direction = unit_directions(np.asarray(gravity, dtype=np.float64))
    if direction.shape != (3,):
        _refuse("gravity must be one direction", np.shape(gravity), "give x, y, z")
    given = {name: _value(recipe, stability_map, name, v) for name, v in (params or {}).items()}
    columns = _columns(kind, recipe, given, axes)
    middle = [
        given.get(p.name, sum(_limits(recipe, stability_map, i)) / 2.0)
        for i, p in enumerate(recipe.parameters)
    ]
    view = View(kind, recipe, stability_map, np.array(middle), direction, channel, columns)
    if KINDS[kind] == 2 and stability_map is not None and not view.on_chart():
        _refuse(
            "gravity is outside the map's chart",
            ", ".join(f"{x:g}" for x in direction),
            "choose a direction that the map covers, or draw from the recipe",
        )
    return view


def _columns(
    kind: str, recipe: Recipe, given: Mapping[str, float], axes: Sequence[str] | None
) -> tuple[int, ...]:
    """Return the columns of the parameters that the figure varies."""
    names = [parameter.name for parameter in recipe.parameters]
    count = KINDS[kind]
    if axes is None:
        free = [name for name in names if name not in given]
        if len(free) < count:
            _refuse(
                f"a {kind} varies {count} parameter(s) of {recipe.name}",
                f"{len(free)} that are free",
                f"leave more of these unset: {', '.join(names) or 'none, it has no parameters'}",
            )
        return tuple(names.index(name) for name in free[:count])
    if len(axes) != count or len(set(axes)) != count:
        _refuse(f"a {kind} needs {count} different axes", ", ".join(axes) or "none", "correct axes")
    for name in axes:
        if name not in names:
            _refuse(f"unknown parameter of {recipe.name}", name, _nearest(name, names))
        if name in given:
            _refuse("parameter is both fixed and an axis", name, "leave it out of one of them")
    return tuple(names.index(name) for name in axes)


def _value(recipe: Recipe, stability_map: StabilityMap | None, name: str, value: float) -> float:
    """Return a given parameter value in rad or length, inside its range."""
    names = [parameter.name for parameter in recipe.parameters]
    if name not in names:
        _refuse(f"unknown parameter of {recipe.name}", name, _nearest(name, names))
    column = names.index(name)
    parameter = recipe.parameters[column]
    low, high = _limits(recipe, stability_map, column)
    inside = float(to_internal(parameter, value))
    slack = RANGE_SLACK * (high - low)
    if not low - slack <= inside <= high + slack:
        shown = to_display(parameter, [low, high])
        unit = "" if parameter.display_unit == "1" else f" {parameter.display_unit}"
        _refuse(
            f"parameter `{name}` is outside its range",
            f"{value:g}",
            f"choose from {shown[0]:g} to {shown[1]:g}{unit}",
        )
    return min(max(inside, low), high)


def _limits(recipe: Recipe, stability_map: StabilityMap | None, column: int) -> tuple[float, float]:
    """Return the range of a parameter: that of the map's knots, or of the robot."""
    if stability_map is not None:
        knots = stability_map.axes[column].knots
        return float(knots[0]), float(knots[-1])
    parameter = recipe.parameters[column]
    return parameter.minimum, parameter.maximum


def _nearest(name: str, known: Sequence[str] | Mapping[str, object]) -> str:
    """Return the way out of a misspelt name."""
    names = list(known)
    close = difflib.get_close_matches(name, names, 1)
    if close:
        return f"did you mean '{close[0]}'"
    return f"choose from {', '.join(names) or 'none'}"


def _refuse(what: str, got: object, way_out: str) -> NoReturn:
    raise InputError(f"plot: {what} (got {got}); {way_out}.")

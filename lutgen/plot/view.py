"""View: the checked options of a figure, and the numbers that they ask for.

Answers from the map where a map's own nodes are drawn, and from the exact evaluation otherwise.  It
knows nothing of colours and paper.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.analysis import slopes
from lutgen.channels import body_gravity, evaluate_each
from lutgen.mapping import StabilityMap
from lutgen.parts import Parameter
from lutgen.quantities import QUANTITIES
from lutgen.recipe import Recipe

Floats = NDArray[np.float64]

# In the channel `status`.
ROCKS = QUANTITIES["status"].words.index("rocks")
# A limit given in degrees comes back from radians within a few 1e-16 of itself.
SLACK = 1e-9


@dataclass(frozen=True)
class View:
    """The checked options of a figure.

    `params` (k,) float64 is the posture, rad or length, at `home` or in the middle of the range
    where the caller gave none; `axes` are the columns that the figure varies; `gravity_dir` (3,)
    is a unit vector in the frame that `convention` names, see `lutgen.channels.resting`.
    `tilt` (rad) is that of a figure over all headings, `scale` what colours have to span at least,
    in the unit shown.
    """

    kind: str
    recipe: Recipe
    stability_map: StabilityMap | None
    params: Floats
    gravity_dir: Floats
    channel: str
    axes: tuple[int, ...]
    convention: str = "body"
    tilt: float = 0.0
    scale: tuple[float, float] | None = None

    def parameter(self, place: int) -> Parameter:
        """Return the parameter on one of the figure's axes."""
        return self.recipe.parameters[self.axes[place]]

    def shown(self, place: int, values: ArrayLike) -> Floats:
        """Turn values of the parameter on a figure's axis into its display unit."""
        return np.asarray(self.parameter(place).shown(np.asarray(values, dtype=np.float64)))

    def ends(self, place: int) -> tuple[float, float]:
        """Return the range of a figure's axis, rad or length."""
        return limits(self.recipe, self.stability_map, self.axes[place])

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
            return self.stability_map.read(*_paired(rows, down), channels)
        values = evaluate_each(self.recipe, rows, self._in_bodies(rows, down), channels)
        return {name: value.ravel() for name, value in values.items()}

    def rocks(self, directions: ArrayLike) -> NDArray[np.bool_]:
        """Tell where the figure's posture rocks between rests, (d,), under directions (d, 3).

        False where nobody knows: of a robot that is code, by a map without the channel `status`.
        """
        down = np.atleast_2d(np.asarray(directions, dtype=np.float64))
        if is_sealed(self.recipe) and (
            self.stability_map is None or "status" not in self.stability_map.channels
        ):
            return np.zeros(len(down), np.bool_)
        return np.asarray(self.exact(self.params, down, "status")["status"] == ROCKS)

    def grip(self, postures: ArrayLike, directions: ArrayLike) -> Floats:
        """Return atan mu less the slope of the ground (rad), (m,): negative where the robot slides.

        Postures and directions as for `exact`; NaN without friction, or without the robot itself.
        """
        rows, down = np.atleast_2d(postures), np.atleast_2d(directions)
        if self.recipe.friction is None or is_sealed(self.recipe):
            return np.full(len(rows) * len(down), np.nan)
        slope = slopes(self.recipe, rows, self._in_bodies(rows, down))
        # Without a support facet nothing holds the robot.
        return math.atan(self.recipe.friction) - np.nan_to_num(slope.ravel(), nan=math.pi)

    def drawn(self, postures: Floats) -> Floats:
        """Return the figure's channel of (m, k) postures, (m,): as in the map, exact without one.

        Next to a tip-over axis a map has no value where it is not sure of standing; the exact
        value stands in there, so that a figure has no gap between its colours and the axis.
        """
        if self.stability_map is None:
            return self.exact(postures, self.gravity_dir, self.channel)[self.channel]
        pairs = _paired(postures, self.gravity_dir[None, :])
        values = self.stability_map.read(*pairs, (self.channel,))[self.channel]
        unknown = np.isnan(values)
        if unknown.any():
            exact = self.exact(postures[unknown], self.gravity_dir, self.channel)
            values[unknown] = exact[self.channel]
        return values

    def _in_bodies(self, rows: Floats, down: Floats) -> Floats:
        """Return directions (d, 3) in the body of each of m postures, (m, d, 3)."""
        if self.convention == "plane":
            # Figures of many directions have gravity fixed in the body.
            return body_gravity(self.recipe, rows, down[0], "plane")[:, None]
        return np.broadcast_to(down, (len(rows), *down.shape))

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
        return bool(max(apart) < SLACK)

    def on_chart(self) -> bool:
        """Tell whether there is a map and it covers the figure's gravity direction."""
        if self.stability_map is None:
            return False
        return bool(self.stability_map.chart.locate(self.gravity_dir[None, :])[3][0])


def _paired(rows: Floats, down: Floats) -> tuple[Floats, Floats]:
    """Return as many postures as directions, of which one may stand for all."""
    count = max(len(rows), len(down))
    return np.broadcast_to(rows, (count, rows.shape[1])), np.broadcast_to(down, (count, 3))


def is_sealed(recipe: Recipe) -> bool:
    """Tell whether the robot is given by code that was not loaded, as in a map file."""
    return recipe.python is not None and recipe.function is None


def optimum(channel: str, values: Floats) -> int | None:
    """Return the flat index of the best finite value of a channel; None if there is none."""
    cost = QUANTITIES[channel].sign * np.where(np.isfinite(values), values, np.nan)
    return None if np.isnan(cost).all() else int(np.nanargmin(cost))


def limits(recipe: Recipe, stability_map: StabilityMap | None, column: int) -> tuple[float, float]:
    """Return the range of a parameter: that of the map's knots, or of the robot."""
    if stability_map is not None:
        knots = stability_map.axes[column].knots
        return float(knots[0]), float(knots[-1])
    parameter = recipe.parameters[column]
    return parameter.minimum, parameter.maximum

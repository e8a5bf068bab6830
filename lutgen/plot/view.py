"""View: the checked options of a figure, their numbers, and its page."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from lutgen.channels import body_gravity, evaluate_each
from lutgen.mapping import StabilityMap
from lutgen.parts import Parameter
from lutgen.plot.style import page, place
from lutgen.quantities import QUANTITIES
from lutgen.recipe import Recipe
from lutgen.vector import Floats

# In the channel `status`.
ROCKS = QUANTITIES["status"].words.index("rocks")


@dataclass(frozen=True)
class View:
    """The checked options of a figure.

    `params` (k,) float64 is the posture, rad or length, at `home` or in the middle of the range
    if the caller gave none; `axes` are the columns that the figure varies.  `gravity_dir` (3,) is
    a unit vector in the frame that `convention` names, see `lutgen.channels.resting`.  `scale` is
    what colours span, as shown; `ax` are the caller's axes to draw into.
    """

    recipe: Recipe
    stability_map: StabilityMap | None
    params: Floats
    gravity_dir: Floats
    channel: str
    axes: tuple[int, ...] = ()
    convention: str = "body"
    scale: tuple[float, float] | None = None
    ax: Axes | None = None

    def page(
        self, height: float, box: tuple[float, float, float, float], sentence: str, note: str
    ) -> tuple[Figure, Axes]:
        """Return a page with axes in a box (inches), or the axes that the caller gave."""
        if self.ax is None:
            figure = page(height, sentence, note)
            return figure, place(figure, box)
        self.ax.set_title(sentence, loc="left", weight="bold")
        return self.ax.get_figure(root=True), self.ax  # type: ignore[return-value]

    def parameter(self, place: int) -> Parameter:
        """Return the parameter on one of the figure's axes."""
        return self.recipe.parameters[self.axes[place]]

    def shown(self, place: int, values: ArrayLike) -> Floats:
        """Turn values of the parameter on a figure's axis into its display unit."""
        return np.asarray(self.parameter(place).shown(np.asarray(values, dtype=np.float64)))

    def ends(self, place: int) -> tuple[float, float]:
        """Return the range of a figure's axis, rad or length."""
        return limits(self.recipe, self.stability_map, self.axes[place])

    def window(self, place: int) -> tuple[float, float]:
        """Return the range of a figure's axis, as shown."""
        low, high = self.shown(place, self.ends(place))
        return float(low), float(high)

    def postures(self, *values: ArrayLike) -> Floats:
        """Return (m, k) postures that vary the figure's axes, one (m,) array per axis."""
        result = np.tile(self.params, (np.size(values[0]), 1))
        result[:, self.axes] = np.stack([np.ravel(column) for column in values], axis=1)
        return result

    def exact(self, rows: Floats, directions: ArrayLike, *channels: str) -> dict[str, Floats]:
        """Return channels, each (m,), of m postures at one direction or of one at m directions.

        They are evaluated; only for code that is not run the map is read.
        """
        rows, down = np.atleast_2d(rows), np.atleast_2d(np.asarray(directions, np.float64))
        if self.stability_map is not None and is_sealed(self.recipe):
            (count,) = np.broadcast_shapes(rows.shape[:1], down.shape[:1])
            rows = np.broadcast_to(rows, (count, rows.shape[1]))
            return self.stability_map.read(rows, np.broadcast_to(down, (count, 3)), channels)
        # Figures of many directions have gravity fixed in the body.
        each = np.broadcast_to(down, (len(rows), *down.shape))
        values = evaluate_each(self.recipe, rows, each, channels, self.convention)
        return {name: value.ravel() for name, value in values.items()}

    def down(self, posture: Floats) -> Floats:
        """Return the figure's gravity direction (3,) in the body of a posture (k,)."""
        here = body_gravity(self.recipe, posture[None], self.gravity_dir, self.convention)
        return np.asarray(here[0])

    def rocks(self, directions: Floats) -> NDArray[np.bool_]:
        """Return where the figure's posture rocks between rests, (d,); False if it is not known."""
        stored = () if self.stability_map is None else self.stability_map.channels
        if is_sealed(self.recipe) and "status" not in stored:
            return np.zeros(len(directions), np.bool_)
        return np.asarray(self.exact(self.params, directions, "status")["status"] == ROCKS)


def is_sealed(recipe: Recipe) -> bool:
    """Return True if the robot is given by code that was not loaded, as in a map file."""
    return recipe.python is not None and recipe.function is None


def optimum(channel: str, values: Floats) -> int | None:
    """Return the flat index of the best finite value of a channel; or None."""
    cost = QUANTITIES[channel].sign * np.where(np.isfinite(values), values, np.nan)
    return None if np.isnan(cost).all() else int(np.nanargmin(cost))


def limits(recipe: Recipe, stability_map: StabilityMap | None, column: int) -> tuple[float, float]:
    """Return the range of a parameter: that of the map's knots, or of the robot."""
    if stability_map is not None:
        knots = stability_map.axes[column].knots
        return float(knots[0]), float(knots[-1])
    parameter = recipe.parameters[column]
    return parameter.minimum, parameter.maximum

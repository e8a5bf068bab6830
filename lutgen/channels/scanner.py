"""A recipe's robot under the directions of one chart, ready for `scan`.

Owns the arguments of the kernel that stay the same from block to block.  Loaded robots are measured
node by node.
"""

from collections.abc import Sequence

import numpy as np

from lutgen.channels.load import measure_recipe
from lutgen.channels.plain import CHANNELS, wanted_channels
from lutgen.channels.raster import VECTOR
from lutgen.channels.scan import scan
from lutgen.chart import Chart
from lutgen.recipe import Postures, Recipe, forward, radii_and_kinds
from lutgen.support import limits, pack
from lutgen.vector import Floats, Singles

# Readings of a loaded robot that are held in float64 at once, 72 bytes each.
AT_ONCE = 1 << 17


class Scanner:
    """Fills channels of any postures of a recipe over rows of a chart.

    `rows` is the number of rows of a posture: faces * nodes.
    """

    def __init__(self, recipe: Recipe, chart: Chart, channels: Sequence[str]) -> None:
        self._recipe = recipe
        self.rows = chart.faces * chart.nodes
        self._inverse = chart.inverse_length().ravel()
        self._coords = np.concatenate([chart.coords, np.full(VECTOR, np.inf)])
        self._basis = chart.basis()
        self._limit = limits(recipe.upright, recipe.rock_angle)
        self._wanted = wanted_channels(channels)
        self._radius, self._kind = radii_and_kinds(recipe)
        # Of loaded robots alone: of the others the kernel makes the directions itself.
        self._directions = chart.directions().reshape(self.rows, -1, 3) if recipe.loaded else None

    def fill(self, params: Floats, first: int, last: int, parts: int, out: Singles) -> int:
        """Fill `out` for postures (m, k) over rows [first, last) of each; see `scan`."""
        postures = forward(self._recipe, params)
        if self._directions is not None:
            directions = self._directions[first:last].reshape(1, -1, 3)
            return self._fill_loaded(postures, directions, out)
        return scan(
            pack(postures.centres, postures.axes, self._radius, self._kind),
            self._limit,
            self._basis,
            self._coords,
            self._inverse,
            first,
            last,
            self._wanted,
            parts,
            out,
        )

    def _fill_loaded(self, postures: Postures, directions: Floats, out: Singles) -> int:
        """Fill `out` for a loaded robot, some postures and directions at a time."""
        count = directions.shape[1]
        few = max(1, AT_ONCE // count)
        overflow = 0
        for begin in range(0, len(postures.com), few):
            some = Postures(*(part[begin : begin + few] for part in postures))
            for at in range(0, count, AT_ONCE):
                values, over = measure_recipe(
                    self._recipe, some, directions[:, at : at + AT_ONCE], self._wanted
                )
                overflow += int(over.sum())
                held = values.shape[2]
                for channel in range(len(CHANNELS)):
                    if self._wanted[channel]:
                        for i, value in enumerate(values[:, channel]):
                            place = (begin + i) * count + at
                            out[channel, place : place + held] = value
        return overflow

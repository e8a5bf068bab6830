"""A recipe's robot under the directions of one chart, ready for `scan`.

Owns the arguments of the kernel that stay the same from block to block.
"""

from collections.abc import Sequence

import numpy as np

from lutgen.channels import wanted_channels
from lutgen.primitive import pack
from lutgen.raster import VECTOR
from lutgen.recipe import Recipe
from lutgen.region import limits
from lutgen.robot import forward, shapes
from lutgen.scan import scan
from lutgen.sphere import Chart
from lutgen.vector import Floats, Singles


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
        self._radius, self._kind = shapes(recipe)

    def fill(self, params: Floats, first: int, last: int, parts: int, out: Singles) -> int:
        """Fill `out` for postures (m, k) over rows [first, last) of each; see `scan`."""
        postures = forward(self._recipe, params)
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

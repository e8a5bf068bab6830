"""Axis (one geometry parameter and its knots) and Grid (the ordered axes)."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, eq=False)
class Axis:
    """One axis of a map: a geometry parameter and the values at which it is sampled.

    `unit` is ``"rad"`` or the recipe's length unit; `knots` (k,) are strictly increasing values in
    it, kept as read-only float64.
    """

    name: str
    unit: str
    knots: NDArray[np.float64]

    def __post_init__(self) -> None:
        knots = np.array(self.knots, dtype=np.float64)
        knots.setflags(write=False)
        object.__setattr__(self, "knots", knots)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Axis):
            return NotImplemented
        same = self.name == other.name and self.unit == other.unit
        return same and np.array_equal(self.knots, other.knots)

    @property
    def size(self) -> int:
        """Number of knots."""
        return int(self.knots.size)


@dataclass(frozen=True)
class Grid:
    """The ordered axes of a map; nodes are numbered in C order, last axis fastest.

    Without any axis it has one node.
    """

    axes: tuple[Axis, ...]

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of knots of each axis."""
        return tuple(axis.size for axis in self.axes)

    @property
    def size(self) -> int:
        """Number of nodes."""
        return math.prod(self.shape)

    def params(self, flat: ArrayLike) -> NDArray[np.float64]:
        """Return the parameters (m, k), in the axes' units, of nodes (m,) by number."""
        nodes = np.asarray(flat, dtype=np.intp)
        places = np.unravel_index(nodes, self.shape) if self.axes else ()
        columns = [axis.knots[place] for axis, place in zip(self.axes, places, strict=True)]
        return np.stack(columns, axis=1) if columns else np.empty((nodes.size, 0))

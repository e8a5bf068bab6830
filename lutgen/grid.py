"""Axis (one geometry parameter and its knots) and Grid (the ordered axes).

This file turns parameter values into cell and fraction, and flat node numbers into
parameter values.  It does not know robots, gravity or files.
"""

import math
import reprlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.errors import InputError

__all__ = ["Axis", "Grid"]


@dataclass(frozen=True, eq=False)
class Axis:
    """One axis of a map: a geometry parameter and the values at which it is sampled.

    Parameters
    ----------
    name : str
        Name of the parameter.
    unit : str
        ``"rad"`` or the recipe's length unit.
    knots : (k,) array_like
        Strictly increasing values in `unit`, k >= 1; kept as read-only float64.

    Examples
    --------
    >>> axis = Axis("alpha", "rad", [0.0, 0.5, 2.0])
    >>> index, frac, clamped = axis.locate([0.25, 2.0, 9.0])
    >>> index.tolist(), frac.tolist(), clamped.tolist()
    ([0, 1, 1], [0.5, 1.0, 1.0], [False, False, True])
    """

    name: str
    unit: str
    knots: NDArray[np.float64]

    def __post_init__(self) -> None:
        knots = np.array(self.knots, dtype=np.float64)
        if knots.ndim != 1 or knots.size == 0:
            raise InputError(
                f"axis `{self.name}`: knots must be a list of at least one number "
                f"(got an array of shape {knots.shape}); give the sampled values."
            )
        if not (np.isfinite(knots).all() and (np.diff(knots) > 0.0).all()):
            raise InputError(
                f"axis `{self.name}`: knots must be finite and strictly increasing "
                f"(got {reprlib.repr(knots.tolist())}); sort them and remove duplicates."
            )
        knots.setflags(write=False)
        object.__setattr__(self, "knots", knots)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Axis):
            return NotImplemented
        same = self.name == other.name and self.unit == other.unit
        return same and np.array_equal(self.knots, other.knots)

    def __hash__(self) -> int:
        return hash((self.name, self.unit, tuple(self.knots.tolist())))

    @property
    def size(self) -> int:
        """Number of knots."""
        return int(self.knots.size)

    def locate(
        self, values: ArrayLike
    ) -> tuple[NDArray[np.intp], NDArray[np.float64], NDArray[np.bool_]]:
        """Find the cell of each value and the place inside it.

        Parameters
        ----------
        values : (m,) array_like
            Values in the axis's unit; infinities are clamped.

        Returns
        -------
        index : (m,) intp
            Lower knot of the cell; the top knot belongs to the last cell.
        frac : (m,) float64
            Place in the cell, 0 at its lower and 1 at its upper knot.  With a
            single knot `index` and `frac` are 0.
        clamped : (m,) bool
            Whether the value lies outside the knots and was moved to the nearest.
        """
        wanted = np.asarray(values, dtype=np.float64)
        if wanted.ndim != 1:
            raise InputError(
                f"axis `{self.name}`: values must have shape (m,) (got shape {wanted.shape}); "
                "pass a one-dimensional array."
            )
        if np.isnan(wanted).any():
            raise InputError(
                f"axis `{self.name}`: value {int(np.isnan(wanted).argmax())} is NaN "
                "(got nan); pass numbers only."
            )
        inside = np.clip(wanted, self.knots[0], self.knots[-1])
        clamped = inside != wanted
        if self.size == 1:
            return np.zeros(wanted.shape, np.intp), np.zeros(wanted.shape), clamped
        index = np.searchsorted(self.knots, inside, side="right") - 1
        index = np.minimum(index, self.size - 2).astype(np.intp)
        low, high = self.knots[index], self.knots[index + 1]
        return index, (inside - low) / (high - low), clamped


@dataclass(frozen=True)
class Grid:
    """The ordered axes of a map; nodes are numbered in C order, last axis fastest.

    Parameters
    ----------
    axes : tuple of Axis
        One per geometry parameter, in recipe order.  No axis at all makes a grid
        of one node.

    Examples
    --------
    >>> grid = Grid((Axis("a", "rad", [0.0, 1.0]), Axis("b", "m", [5.0, 6.0, 7.0])))
    >>> grid.shape, grid.size, grid.params([1, 3]).tolist()
    ((2, 3), 6, [[0.0, 6.0], [1.0, 5.0]])
    """

    axes: tuple[Axis, ...]

    def __post_init__(self) -> None:
        names = [axis.name for axis in self.axes]
        if len(set(names)) != len(names):
            raise InputError(f"the axes must have different names (got {names}); rename one.")

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of knots of each axis."""
        return tuple(axis.size for axis in self.axes)

    @property
    def size(self) -> int:
        """Number of nodes."""
        return math.prod(self.shape)

    def params(self, flat: ArrayLike) -> NDArray[np.float64]:
        """Return the parameter values of nodes.

        Parameters
        ----------
        flat : (m,) array_like of int
            Node numbers, 0 <= flat < size.

        Returns
        -------
        (m, k) float64
            One row per node, one column per axis, in the axes' units.
        """
        nodes = np.asarray(flat)
        if nodes.ndim != 1 or (nodes.size and nodes.dtype.kind not in "iu"):
            raise InputError(
                f"node numbers must be integers of shape (m,) (got {nodes.dtype} of shape "
                f"{nodes.shape}); pass for example numpy.arange(grid.size)."
            )
        remainder = nodes.astype(np.intp)
        if remainder.size and (remainder.min() < 0 or remainder.max() >= self.size):
            raise InputError(
                f"node numbers must lie in 0..{self.size - 1} (got {remainder.min()}.."
                f"{remainder.max()}); stay below grid.size."
            )
        values = np.empty((remainder.size, len(self.axes)))
        for column in range(len(self.axes) - 1, -1, -1):
            remainder, index = np.divmod(remainder, self.axes[column].size)
            values[:, column] = self.axes[column].knots[index]
        return values

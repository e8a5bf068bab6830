"""Plane: a quantity over two parameters, exact, and where it jumps.

A step between two neighbours is a jump if it stays whole as the cell is halved again and again.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.ndimage import binary_dilation, distance_transform_edt, maximum
from scipy.ndimage import label as connected
from scipy.spatial import cKDTree

from lutgen.arrays import Bools, Floats
from lutgen.plot.view import View
from lutgen.quantities import QUANTITIES

CELLS, FINER = 180, 4
# The rest of a step after so many halvings, in degrees: contours end from BREAK on, and a line
# is drawn from FAINT on if it is DRAWN high somewhere and SHORTEST cells long.
HALVINGS, BREAK, FAINT, DRAWN, SHORTEST = 6, 0.3, 1.0, 2.5, 8
# Contours end this many cells from a jump, and where the slope is below FLAT a cell.
CLEAR, FLAT = 1.6, 0.05
# This share of the range counts as one degree, for channels that are no angles.
SHARE = 0.02
# Postures as good as the best one but for this much are alike; the star stands well inside of them.
ALIKE, INSIDE = 2.0, 0.7
# Part of the picture: an even region reaches so far on all sides of its middle.
WIDE = 0.12


class Plane:
    """A channel over two parameters, all as shown.

    `values` are on a mesh `x`, `y`; `big` on one `FINER` times as fine, `fx`, `fy`, exact where it
    jumps or is steep.  Both are NaN where the robot tips over, or below 0 for the tip-over angle;
    `tips` says where that is in `big`.  `degree` is what counts as one degree.
    """

    def __init__(self, view: View, cells: int = CELLS) -> None:
        self.view = view
        self.x, self.y = (np.linspace(*view.window(i), cells + 1) for i in (0, 1))
        self.values = self.read(*np.meshgrid(self.x, self.y))
        known = self.values[np.isfinite(self.values)]
        spread = float(np.ptp(known)) if known.size else 1.0
        self.degree = 1.0 if view.channel == "tip_angle" else max(SHARE * spread, 1e-12)
        self.jumps = [self._find_jumps(axis) for axis in (0, 1)]
        self._enlarge()

    def read(self, x: Floats, y: Floats) -> Floats:
        """Return the channel at places."""
        view = self.view
        stored = (view.parameter(i).stored(np.ravel(part)) for i, part in enumerate((x, y)))
        # Degrees come back from rad a rounding beyond the range.
        inside = [np.clip(part, *view.ends(i)) for i, part in enumerate(stored)]
        found = view.exact(view.postures(*inside), view.gravity_dir, view.channel, "tip_angle")
        shown = QUANTITIES[view.channel].shown(found[view.channel])
        if view.channel != "tip_angle":
            shown = np.where(found["tip_angle"] < 0.0, np.nan, shown)
        return np.asarray(shown).reshape(np.shape(x))

    def _find_jumps(self, axis: int) -> Floats:
        """Return (3, ...) for each pair of neighbours: the place of a jump and its height."""
        with np.errstate(invalid="ignore"):
            step = np.abs(np.diff(self.values, axis=axis))
        at = np.argwhere(step > BREAK * self.degree).T
        rows, columns = np.stack([at, at + np.array([[1 - axis], [axis]])], axis=1)
        ends, values = np.stack([self.x[columns], self.y[rows]], axis=1), self.values[rows, columns]
        for _ in range(HALVINGS):
            ends, values = halved(lambda middle: self.read(*middle), ends, values)
            # A step that is not a jump by now never is.
            left = np.abs(values[1] - values[0]) > BREAK * self.degree
            left &= self._stands(np.fmax(*values))
            at, ends, values = at[:, left], ends[..., left], values[:, left]
        found = np.full((3, *step.shape), np.nan)
        found[:2, *at] = ends.mean(axis=0)
        found[2, *at] = np.abs(values[1] - values[0])
        return found

    def _stands(self, values: Floats) -> Bools:
        return values > 0.0 if self.view.channel == "tip_angle" else np.isfinite(values)

    def lines(self) -> Floats:
        """Return pieces of the jumps' lines, (n, 2, 2)."""
        up, across = self.jumps
        cells = np.stack([across[:, :-1], across[:, 1:], up[:, :, :-1], up[:, :, 1:]])
        height = np.nan_to_num(cells[:, 2]).max(axis=0)
        chains, count = connected(height > FAINT * self.degree, structure=np.ones((3, 3)))
        drawn = np.bincount(chains.ravel(), minlength=count + 1) >= SHORTEST
        drawn &= maximum(height, chains, np.arange(count + 1)) > DRAWN * self.degree
        drawn[0] = False
        pieces: list[list[Floats]] = []
        for i, j in np.argwhere(drawn[chains]):
            here = [c[:2, i, j] for c in cells if c[2, i, j] > 0.8 * FAINT * self.degree]
            middle = np.mean(here, axis=0)
            pieces += [here] if len(here) == 2 else [[one, middle] for one in here]
        return np.array(pieces).reshape(-1, 2, 2)

    def _enlarge(self) -> None:
        """Make the picture: between nodes linear, exact in cells that hold a jump or are steep."""
        up, across = (np.isfinite(jump[0]) for jump in self.jumps)
        cut = across[:-1] | across[1:] | up[:, :-1] | up[:, 1:]
        corners = sliding_window_view(self.values, (2, 2))
        with np.errstate(invalid="ignore"):
            steep = np.ptp(corners, axis=(2, 3)) > DRAWN * self.degree
        stands = self._stands(corners)
        steep |= stands.any(axis=(2, 3)) & ~stands.all(axis=(2, 3))
        jumps = binary_dilation(cut)
        ny, nx = self.values.shape
        self.fx = np.linspace(self.x[0], self.x[-1], (nx - 1) * FINER + 1)
        self.fy = np.linspace(self.y[0], self.y[-1], (ny - 1) * FINER + 1)
        rows = np.array([np.interp(self.fx, self.x, row) for row in self.values])
        self.big = np.array([np.interp(self.fy, self.y, column) for column in rows.T]).T
        full, self.cut = _finer(jumps | steep, self.big.shape), _finer(jumps, self.big.shape)
        gx, gy = np.meshgrid(self.fx, self.fy)
        self.big[full] = self.read(gx[full], gy[full])
        self.tips = ~self._stands(self.big) & (self.big != 0.0)

    def broken(self) -> Floats:
        """Return the picture with NaN at jumps, so that contours end there."""
        result = self.big.copy()
        for big, cut, left in ((self.big, self.cut, result), (self.big.T, self.cut.T, result.T)):
            with np.errstate(invalid="ignore"):
                step = np.abs(np.diff(big, axis=0)) > BREAK * self.degree
            inside = step & cut[:-1] & cut[1:]
            left[:-1][inside] = np.nan
            left[1:][inside] = np.nan
        return result

    def clear(self, piece: Floats) -> list[Floats]:
        """Return parts of a contour that are clear of jumps and of flat areas, and not short."""
        cell = np.array([self.x[1] - self.x[0], self.y[1] - self.y[0]])
        dy, dx = np.gradient(self.values)
        nearest = np.rint((piece - [self.x[0], self.y[0]]) / cell).astype(int)
        slope = np.hypot(dx, dy)[nearest[:, 1], nearest[:, 0]]
        good = ~(slope <= FLAT * self.degree)
        places = np.concatenate([jump[:2].reshape(2, -1).T for jump in self.jumps])
        places = places[np.isfinite(places[:, 0])]
        if len(places):
            good &= cKDTree(places / cell).query(piece / cell)[0] > CLEAR
        groups, count = connected(good)
        parts = [piece[groups == k] for k in range(1, count + 1)]
        long = 0.05 * (len(self.x) - 1)
        return [p for p in parts if np.linalg.norm(np.diff(p, axis=0) / cell, axis=1).sum() > long]

    def flat(self) -> tuple[float, float, float] | None:
        """Return the widest region that stays within about a degree: its middle and value."""
        known = self.values[np.isfinite(self.values) & (self.values > 0.0)]
        if not known.size:
            return None
        counts, ends = np.histogram(known, bins=np.arange(0.0, known.max() + 0.5, 0.25))
        usual = float(ends[int(np.argmax(counts))]) + 0.125
        groups, _ = connected(np.abs(self.values - usual) < 0.6)
        depth = distance_transform_edt(np.pad(groups > 0, 1))[1:-1, 1:-1]
        if depth.max() < WIDE * min(depth.shape):  # of a ramp a narrow strip is as even
            return None
        inner = np.argwhere(depth > 0.95 * depth.max())
        row, column = inner[np.linalg.norm(inner - inner.mean(axis=0), axis=1).argmin()]
        lowest = float(self.values[groups == groups[row, column]].min())
        return float(self.x[column]), float(self.y[row]), lowest

    def best(self) -> tuple[float, float, float] | None:
        """Return where the best posture is and its value: well inside of those that are alike."""
        good = -QUANTITIES[self.view.channel].sign * self.big
        good = np.where(self.tips, np.nan, good)
        if np.isnan(good).all():
            return None
        alike = ALIKE if self.view.channel == "tip_angle" else 1e-9
        among = np.nan_to_num(good, nan=-np.inf) >= np.nanmax(good) - alike
        depth = distance_transform_edt(np.pad(among, 1))[1:-1, 1:-1]
        spans = [float(np.ptp(self.fx)), float(np.ptp(self.fy))]
        far = np.hypot(*np.meshgrid(self.fx / spans[0], self.fy / spans[1]))
        inside = depth >= INSIDE * depth.max()
        nearest = int(np.argmin(np.where(inside, far, np.inf)))
        row, column = np.unravel_index(nearest, self.big.shape)
        return float(self.fx[column]), float(self.fy[row]), float(self.big[row, column])


def halved(read: Callable[[Floats], Any], ends: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Return the halves of steps, from `ends[0]` to `ends[1]`, in which `values` change more."""
    middle = ends.mean(axis=0)
    value = read(middle)
    first = np.abs(value - values[0]) > np.abs(values[1] - value)
    values = np.where(first, [values[0], value], [value, values[1]])
    return np.where(first, [ends[0], middle], [middle, ends[1]]), values


def _finer(cells: Bools, shape: tuple[int, ...]) -> Bools:
    """Return which nodes of the finer mesh lie in or on some cells."""
    mask = np.kron(cells, np.ones((FINER, FINER), np.bool_))
    result = np.zeros(shape, np.bool_)
    result[:-1, :-1] |= mask
    result[1:, 1:] |= mask
    return result

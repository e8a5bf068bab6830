"""Levels: contour lines and colours of a gridded quantity that may jump or be unknown.

Works on arrays in display units; it knows nothing of robots.
"""

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.contour import QuadContourSet
from matplotlib.ticker import MaxNLocator
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from lutgen.plot.palette import MAP, ON_COLOURS

Floats = NDArray[np.float64]

# A step between two samples of this share of the whole range, and this many times as high as the
# steps on both its sides, is a jump and not a slope.
JUMP, STEEPER = 0.02, 4.0
# Contour lines of this many levels between two nodes cannot be told apart.
MERGED = 2.5
# Distance between labels of contour lines, in widths of the axes.
APART = 0.1


def levels(values: Floats, scale: tuple[float, float] | None = None) -> Floats:
    """Return round contour levels that enclose all finite values, and `scale` where it is given."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    if scale is not None:
        low, high = min(low, *scale), max(high, *scale)
    if not high - low > 1e-9 * max(abs(high), abs(low)):
        spread = 0.5 * abs(high) if high != 0.0 else 1.0
        low, high = low - spread, high + spread
    return np.asarray(MaxNLocator(12, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high))


def fill(axes: Any, x: Floats, y: Floats, values: Floats, steps: Floats, **look: Any) -> Any:
    """Colour a quantity between levels, as far as under the hatching of what is unknown."""
    return axes.contourf(x, y, _extend(values, steps), levels=steps, cmap=MAP, **look)


def outline(
    axes: Axes, x: Floats, y: Floats, values: Floats, steps: Floats, **look: Any
) -> QuadContourSet:
    """Draw the lines of levels, white or black as the colour needs; they end at cliffs."""
    clear = _apart(_extend(values, steps), steps[1] - steps[0])
    lines = axes.contour(x, y, clear, levels=steps[1:-1], colors=inks(steps), **look)
    lines.set_gid(ON_COLOURS)
    return lines


def inks(steps: Floats) -> list[str]:
    """Return for each level but the ends in which colour it is read best on the fill around it.

    White or black, whichever contrasts more (WCAG 2.2) with the paler or darker of the two fills
    that meet there; on viridis at least 4.0, where the two are alike.
    """
    fills = colormaps[MAP](np.linspace(0.0, 1.0, len(steps) - 1))[:, :3]
    linear = np.where(fills <= 0.04045, fills / 12.92, ((fills + 0.055) / 1.055) ** 2.4)
    bright = linear @ [0.2126, 0.7152, 0.0722]
    dark, pale = np.minimum(bright[:-1], bright[1:]), np.maximum(bright[:-1], bright[1:])
    return [
        "white" if 1.05 / (p + 0.05) > (d + 0.05) / 0.05 else "black"
        for d, p in zip(dark, pale, strict=True)
    ]


def jumps(values: Floats, axis: int = 0) -> NDArray[np.bool_]:
    """Return whether each step between neighbours along an axis is a jump to another facet.

    The result is one shorter along `axis`; steps beside NaN are none.
    """
    steps = np.abs(np.diff(values, axis=axis))
    steps = np.moveaxis(np.where(np.isnan(steps), 0.0, steps), axis, 0)
    none = np.zeros_like(steps[:1])
    beside = np.maximum(np.concatenate([none, steps[:-1]]), np.concatenate([steps[1:], none]))
    spread = np.nanmax(values) - np.nanmin(values)
    found = (steps > JUMP * spread) & (steps > STEEPER * beside)
    return np.asarray(np.moveaxis(found, 0, axis))


def crossings(x: Floats, y: Floats, below: NDArray[np.bool_]) -> Floats:
    """Return where a line crosses 0, between samples of which one is `below`."""
    at = np.flatnonzero(below[:-1] != below[1:])
    at = at[np.isfinite(y[at]) & np.isfinite(y[at + 1])]
    return np.asarray(x[at] - y[at] * (x[at + 1] - x[at]) / (y[at + 1] - y[at]))


def _apart(values: Floats, step: float) -> Floats:
    """Return values with NaN on both sides of every cliff, at which contour lines then end.

    A cliff is a jump, or a rise over so many levels (`step`) that their lines would merge.
    """
    result = values.copy()
    for axis in (0, 1):
        cliff = jumps(values, axis) | (np.abs(np.diff(values, axis=axis)) > MERGED * step)
        before, after = (np.moveaxis(result, axis, 0)[part] for part in (np.s_[:-1], np.s_[1:]))
        before[np.moveaxis(cliff, axis, 0)] = np.nan
        after[np.moveaxis(cliff, axis, 0)] = np.nan
    return result


def label_lines(axes: Axes, lines: QuadContourSet) -> None:
    """Write its level onto the longest piece of each contour line, apart from the other labels.

    Pieces too short for a label go without, and so do those whose every point is near another
    label or the frame.
    """
    to_paper = axes.transData - axes.transAxes
    places: list[Floats] = []
    taken = np.empty((0, 2))
    for level in lines.allsegs:
        pieces = [piece for piece in level if len(piece) > 2]
        if not pieces:
            continue
        on_paper = [np.asarray(to_paper.transform(piece)) for piece in pieces]
        lengths = [np.linalg.norm(np.diff(piece, axis=0), axis=1).sum() for piece in on_paper]
        longest = int(np.argmax(lengths))
        piece = on_paper[longest]
        inside = np.minimum(piece, 1.0 - piece).min(axis=1)
        apart = np.linalg.norm(piece[:, None] - taken, axis=2).min(axis=1, initial=np.inf)
        # Far from other labels, but beyond APART nothing is gained and the middle is best.
        score = np.minimum(apart, 2.0 * APART) + np.minimum(inside, APART)
        best = int(np.argmax(score - 1e-3 * np.abs(np.arange(len(piece)) / len(piece) - 0.5)))
        if lengths[longest] < 2.0 * APART or apart[best] < APART or inside[best] < APART / 3.0:
            continue
        taken = np.vstack([taken, piece[best]])
        places.append(pieces[longest][best])
    if places:
        for text in lines.axes.clabel(lines, fontsize=6, inline_spacing=2, manual=places, zorder=5):
            text.set_gid(ON_COLOURS)


def _extend(values: Floats, steps: Floats) -> Floats:
    """Fill NaN next to finite values of a 2-D grid with their mean, two cells wide.

    Colours then reach under the hatched region, whose edge is drawn exactly, instead of ending in
    the stairs of the grid.  Between the first and the last level.
    """
    result = values
    for _ in range(2):
        around = sliding_window_view(np.pad(result, 1, constant_values=np.nan), result.shape)
        known = np.isfinite(around).sum(axis=(0, 1))
        mean = np.nansum(around, axis=(0, 1)) / np.maximum(known, 1)
        result = np.where(np.isnan(result) & (known > 0), mean, result)
    return np.clip(result, steps[0], steps[-1])

"""Marks that several kinds of figure share: what tips over or slides, the optimum, notes.

Works on arrays in display units; it knows nothing of robots.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import patheffects
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Annotation, Text
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Bbox
from numpy.typing import NDArray

from lutgen.plot.style import GREY, HATCH, ORANGE, WASH

__all__ = [
    "HALO",
    "PLATE",
    "SLIDE_DASHES",
    "STAR",
    "TIPS",
    "degree_ticks",
    "label_tip_over",
    "mark_optimum",
    "mark_sliding",
    "roomiest",
    "shade_tip_over",
    "tip_patch",
    "write_beside",
]

Floats = NDArray[np.float64]

TIPS = "tips over"
# Places for a note around its point, in points, the best first.
AROUND = ((7, 6), (-7, 6), (7, -6), (-7, -6), (0, 9), (0, -9), (9, 0), (-9, 0))
FAR = tuple((times * x, times * y) for times in (2.5, 5) for x, y in AROUND)
STAR: dict[str, Any] = {
    "marker": "*",
    "markersize": 8.5,
    "markerfacecolor": "white",
    "markeredgecolor": "black",
    "markeredgewidth": 0.7,
}
# Clear space around a note, in dots.
CLEAR = 5.0
# The line where sliding begins.
SLIDE_DASHES = (0, (4, 2))
HALO = [patheffects.withStroke(linewidth=1.8, foreground="white")]
PLATE = {"facecolor": "white", "edgecolor": "none", "pad": 0.8, "alpha": 0.9}


def degree_ticks(axis: Axis, low: float, high: float, prune: str | None = None) -> None:
    """Put ticks at degrees that divide a turn, where an axis spans a good part of one."""
    if high - low > 100.0:
        steps = [1, 1.5, 3, 4.5, 6, 9, 10]
        axis.set_major_locator(MaxNLocator(7, steps=steps, prune=prune))


def tip_patch(label: str = TIPS) -> Patch:
    """Return the legend's sample of the tip-over region."""
    return Patch(facecolor=WASH, edgecolor=GREY, hatch=HATCH, linewidth=0.4, label=label)


def shade_tip_over(axes: Axes, x: Floats, y: Floats, tip_angle: Floats) -> bool:
    """Hatch where `tip_angle` < 0 and draw the line where it is 0; False if nothing tips."""
    if not (tip_angle < 0.0).any():
        return False
    axes.contourf(x, y, tip_angle, levels=[-4.0, 0.0], colors=[WASH], hatches=[HATCH], zorder=3)
    if (tip_angle >= 0.0).any():
        axes.contour(x, y, tip_angle, levels=[0.0], colors=["black"], linewidths=0.9, zorder=4)
    return True


def label_tip_over(axes: Axes, x: Floats, y: Floats, tip_angle: Floats, cells: int) -> bool:
    """Write "tips over" into the hatched region; False if it is nowhere `cells` cells deep."""
    place = roomiest(tip_angle < 0.0)
    if place is None or place[2] < cells:
        return False
    across, up = x[place[:2]], y[place[:2]]
    axes.text(across, up, TIPS, ha="center", va="center", bbox=PLATE, zorder=6)
    return True


def roomiest(mask: NDArray[np.bool_]) -> tuple[int, int, int] | None:
    """Return row, column and depth in cells of the point deepest inside a region of a grid."""
    inside = np.pad(mask, 1)
    deepest = None
    depth = 0
    while inside.any():
        depth += 1
        rows, columns = np.nonzero(inside)
        middle = int(np.argmin((rows - rows.mean()) ** 2 + (columns - columns.mean()) ** 2))
        deepest = int(rows[middle]) - 1, int(columns[middle]) - 1, depth
        shrunk = inside.copy()
        for step in (1, -1):
            shrunk &= np.roll(inside, step, axis=0) & np.roll(inside, step, axis=1)
        inside = shrunk
    return deepest


def mark_optimum(axes: Axes, x: float, y: float, text: str) -> Line2D:
    """Mark a point with a star and return it; its label is `text`, for a legend."""
    (star,) = axes.plot(
        [x],
        [y],
        linestyle="none",
        zorder=8,
        clip_on=False,
        label=text,
        in_layout=False,
        **STAR,
    )
    return star


def mark_sliding(
    axes: Axes, mesh: tuple[Floats, Floats], grip: Floats | None, tip_angle: Floats, label: str
) -> list[Artist]:
    """Dot where the robot slides (`grip` < 0) and dash the line where that begins.

    All (rows, columns) as the `mesh` of places; below the hatching of what tips over.  Returns the
    handle for the legend; none where nothing slides that stands.
    """
    if grip is None or not ((grip < 0.0) & (tip_angle >= 0.0)).any():
        return []
    dots = axes.contourf(
        *mesh, grip, levels=[-2.0 * math.pi, 0.0], colors=["none"], hatches=["..."]
    )
    dots.set(zorder=2.4, hatchcolor=ORANGE)
    if ((grip >= 0.0) & (tip_angle >= 0.0)).any():
        look: dict[str, Any] = {"colors": [ORANGE], "linewidths": 1.0, "linestyles": [SLIDE_DASHES]}
        axes.contour(*mesh, grip, levels=[0.0], zorder=2.5, **look)
    return [Line2D([], [], color=ORANGE, linestyle=SLIDE_DASHES, label=label)]


def write_beside(
    axes: Axes, x: float, y: float, text: str, obstacles: Sequence[Floats] = ()
) -> None:
    """Write a note beside a point, where it stays inside the axes and covers least.

    `obstacles` are (k, 2) arrays of points in display coordinates, such as those of lines.
    """
    note = axes.annotate(
        text,
        (x, y),
        xytext=AROUND[0],
        textcoords="offset points",
        bbox=PLATE,
        arrowprops={"arrowstyle": "-", "linewidth": 0.5, "shrinkA": 0.0, "shrinkB": 4.0},
        zorder=9,
        in_layout=False,
    )
    figure = axes.get_figure(root=True)
    window = axes.get_window_extent()
    if figure is not None:
        figure.draw_without_rendering()
        # Axes in perspective reach beyond the paper.
        window = Bbox.intersection(axes.get_window_extent(), figure.bbox) or window
    best: tuple[float, float] = AROUND[0]
    least = np.inf
    for offset in (*AROUND, *FAR):
        _move(note, offset)
        # Of the text alone: the leader to the point does not count.
        box = Text.get_window_extent(note).padded(CLEAR)
        outside = (
            max(window.x0 - box.x0, 0.0)
            + max(box.x1 - window.x1, 0.0)
            + max(window.y0 - box.y0, 0.0)
            + max(box.y1 - window.y1, 0.0)
        )
        covered = sum(
            int(
                (
                    (points > (box.x0, box.y0)).all(axis=1)
                    & (points < (box.x1, box.y1)).all(axis=1)
                ).sum()
            )
            for points in obstacles
        )
        cost = 1000.0 * outside + covered
        if cost < least:
            best, least = offset, cost
    _move(note, best)


def _move(note: Annotation, offset: tuple[float, float]) -> None:
    """Put a note beside its point, on the side that the offset (points) says."""
    across, up = offset
    note.set_position(offset)
    note.set_horizontalalignment("left" if across > 0 else "right" if across < 0 else "center")
    note.set_verticalalignment("bottom" if up > 0 else "top" if up < 0 else "center")

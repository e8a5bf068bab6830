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
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Annotation, Text
from matplotlib.transforms import Bbox, BboxBase
from numpy.typing import NDArray

from lutgen.plot.palette import GREY, HATCH, ORANGE, WASH

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

TIPS, ROCKS = "tips over", "rocks"
ROCK_HATCH = "\\\\\\\\"
HATCHED: dict[str, Any] = {"facecolor": WASH, "edgecolor": GREY, "hatch": HATCH}
# The same for contours of the tip-over angle (rad).
TIPPED: dict[str, Any] = {"levels": [-4.0, 0.0], "colors": [WASH], "hatches": [HATCH]}
# Places for a note around its point, in points, the best first.
AROUND = ((7, 6), (-7, 6), (7, -6), (-7, -6), (0, 9), (0, -9), (9, 0), (-9, 0))
FAR = tuple((times * x, times * y) for times in (2.5, 5, 8) for x, y in AROUND)
STAR: dict[str, Any] = {
    "linestyle": "none",
    "marker": "*",
    "markersize": 8.5,
    "markerfacecolor": "white",
    "markeredgecolor": "black",
    "markeredgewidth": 0.7,
}
# A part of an axis, within which the star reaches over its end.
NEAR_EDGE = 0.02
# What it costs to hide a point of a text, in points of lines.
WORSE = 1000.0
# Clear space around a note, in dots.
CLEAR = 5.0
# The line where sliding begins.
SLIDE_DASHES = (0, (4, 2))
CENTRED: dict[str, Any] = {"ha": "center", "va": "center"}
HALO = [patheffects.withStroke(linewidth=1.8, foreground="white")]
PLATE = {"facecolor": "white", "edgecolor": "none", "pad": 0.8, "alpha": 0.9}


def tip_patch(label: str = TIPS) -> Patch:
    """Return the legend's sample of the tip-over region."""
    return Patch(linewidth=0.4, label=label, **HATCHED)


def shade_tip_over(axes: Axes, x: Floats, y: Floats, tip_angle: Floats) -> bool:
    """Hatch where `tip_angle` < 0 and draw the line where it is 0; False if nothing tips."""
    if not (tip_angle < 0.0).any():
        return False
    axes.contourf(x, y, tip_angle, zorder=3, **TIPPED)
    if (tip_angle >= 0.0).any():
        axes.contour(x, y, tip_angle, levels=[0.0], colors=["black"], linewidths=0.9, zorder=4)
    return True


def rock_patch(colour: str, behind: str = "none") -> Patch:
    """Return the legend's sample of where the robot rocks: hatched in a colour on what is there."""
    look: dict[str, Any] = {"facecolor": behind, "edgecolor": GREY, "hatch": ROCK_HATCH}
    return Patch(linewidth=0.4, label=ROCKS, hatchcolor=colour, **look)


def shade_rocking(axes: Axes, mesh: tuple[Floats, Floats], rocks: Bools, colour: str) -> bool:
    """Hatch where the robot rocks between rests, all (rows, columns); False if it does nowhere.

    The hatching leans the other way than that of what tips over, and lets the colours through.
    """
    if not rocks.any():
        return False
    drawn = axes.contourf(
        *mesh, rocks.astype(float), levels=[0.5, 1.5], colors=["none"], hatches=[ROCK_HATCH]
    )
    drawn.set(zorder=2.3, hatchcolor=colour)
    return True


def label_tip_over(axes: Axes, x: Floats, y: Floats, tip_angle: Floats, cells: int) -> bool:
    """Write "tips over" deepest in the hatched region; False if that is less than `cells` cells."""
    # Loading it takes a while, and few figures need it.
    from scipy.ndimage import distance_transform_cdt

    depth = distance_transform_cdt(np.pad(tip_angle < 0.0, 1), "taxicab")
    if depth.max() < cells:
        return False
    rows, columns = np.nonzero(depth == depth.max())
    middle = np.argmin((rows - rows.mean()) ** 2 + (columns - columns.mean()) ** 2)
    # Without the padding.
    place = rows[middle] - 1, columns[middle] - 1
    axes.text(x[place], y[place], TIPS, bbox=PLATE, zorder=6, **CENTRED)
    return True


def mark_optimum(axes: Axes, x: float, y: float, text: str) -> Line2D:
    """Mark a point with a star and return it; its label is `text`, for a legend.

    Where the star stands over the left or the lower edge, the numbers there make room for it.
    """
    for at, (low, high), across in (
        (x, axes.get_xlim(), axes.yaxis),
        (y, axes.get_ylim(), axes.xaxis),
    ):
        if abs(at - low) <= NEAR_EDGE * abs(high - low):
            across.set_tick_params(pad=STAR["markersize"] / 2.0 + 1.5)
    (star,) = axes.plot([x], [y], zorder=8, clip_on=False, label=text, in_layout=False, **STAR)
    return star


def mark_sliding(
    axes: Axes, mesh: tuple[Floats, Floats], grip: Floats, tip_angle: Floats, label: str
) -> list[Artist]:
    """Dot where the robot slides (`grip` < 0) and dash the line where that begins.

    All (rows, columns) as the `mesh` of places; below the hatching of what tips over.  Returns the
    handle for the legend; none where nothing slides that stands.
    """
    if not ((grip < 0.0) & (tip_angle >= 0.0)).any():
        return []
    dots = axes.contourf(
        *mesh, grip, levels=[-2.0 * math.pi, 0.0], colors=["none"], hatches=["..."]
    )
    dots.set(zorder=2.4, hatchcolor=ORANGE)
    if ((grip >= 0.0) & (tip_angle >= 0.0)).any():
        look: dict[str, Any] = {"colors": [ORANGE], "linewidths": 1.0, "linestyles": [SLIDE_DASHES]}
        axes.contour(*mesh, grip, levels=[0.0], zorder=2.5, **look)
    look = {"edgecolor": ORANGE, "hatchcolor": ORANGE, "linestyle": SLIDE_DASHES, "hatch": "..."}
    return [Patch(facecolor="none", linewidth=1.0, label=label, **look)]


def write_beside(
    axes: Axes,
    place: tuple[float, float],
    text: str,
    obstacles: Sequence[Floats] = (),
    words: Sequence[Floats] | None = None,
) -> Floats:
    """Write a note beside a point, where it stays inside the axes and covers least.

    `obstacles` are (k, 2) arrays of points in display coordinates, such as those of lines; returns
    the same of the note, for the next one.  With `words`, other texts, it is left out where it
    would cover one of them, or leave the axes: then there is no room for it.
    """
    note = axes.annotate(
        text,
        place,
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
        # Nothing moves in a figure whose layout is fixed.
        if isinstance(figure.get_layout_engine(), ConstrainedLayoutEngine):
            figure.draw_without_rendering()
        else:
            note.update_positions(figure.canvas.get_renderer())  # type: ignore[attr-defined]
        # Axes in perspective reach beyond the paper.
        window = Bbox.intersection(axes.get_window_extent(), figure.bbox) or window
        # Nor is there room upon the legend below them.
        below = [legend.get_window_extent().y1 for legend in figure.legends]
        window = Bbox([[window.x0, max([window.y0, *below])], window.max])

    def cost(offset: tuple[float, float]) -> float:
        _move(note, offset)
        # Of the text alone: the leader to the point does not count.
        box = Text.get_window_extent(note).padded(CLEAR)
        outside = np.maximum(np.array([window.min, box.max]) - [box.min, window.max], 0.0).sum()
        hidden = outside + sum(map(box.count_contains, words or ()))
        return float(WORSE * hidden + sum(map(box.count_contains, obstacles)))

    best = min((*AROUND, *FAR), key=cost)
    if words is not None and cost(best) >= WORSE:
        note.remove()
        return np.empty((0, 2))
    _move(note, best)
    return covered(Text.get_window_extent(note).padded(CLEAR))


def covered(box: BboxBase) -> Floats:
    """Return points (k, 2) all over a box in display coordinates, for `write_beside`."""
    across, up = np.meshgrid(np.linspace(box.x0, box.x1, 25), np.linspace(box.y0, box.y1, 9))
    return np.column_stack([across.ravel(), up.ravel()])


def _move(note: Annotation, offset: tuple[float, float]) -> None:
    """Put a note beside its point, on the side that the offset (points) says."""
    across, up = offset
    note.set_position(offset)
    note.set_horizontalalignment("left" if across > 0 else "right" if across < 0 else "center")
    note.set_verticalalignment("bottom" if up > 0 else "top" if up < 0 else "center")

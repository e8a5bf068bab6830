"""Axes in perspective, and how they fill their figure.

Matplotlib's 3-D axes leave room for every angle of view; a printed figure has one, so the box is
measured and enlarged until it fits the width.
"""

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.transforms import BboxBase
from mpl_toolkits.mplot3d import proj3d
from numpy.typing import ArrayLike, NDArray

from lutgen.plot.legend import add_legend

Floats = NDArray[np.float64]

# Space beside the box and between the parts of a figure, inches.
MARGIN = 0.06
ROUNDS = 3
# Points between the numbers of an axis and its name, at most.
FURTHEST = 45.0
# Larger than the figure, because axes cut off what is drawn outside of them.
WIDE = (-0.5, -0.5, 2.0, 2.0)


def box_axes(figure: Figure, elevation: float, azimuth: float) -> Any:
    """Return 3-D axes, seen from `elevation` and `azimuth` (deg), that draw in zorder."""
    figure.set_layout_engine("none")
    axes: Any = figure.add_axes(WIDE, projection="3d", computed_zorder=False)
    axes.view_init(elev=elevation, azim=azimuth)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.labelpad = 11.0
        axis.set_tick_params(pad=3.5)
    return axes


def set_limits(axes: Any, low: ArrayLike, high: ArrayLike) -> None:
    """Set the limits of the three axes, (3,) each."""
    ends = np.transpose([low, high]).tolist()
    axes.set(**dict(zip(("xlim", "ylim", "zlim"), ends, strict=True)))


def enlarge(figure: Figure, axes: Any, aspect: ArrayLike, room: Floats) -> tuple[Floats, Floats]:
    """Make a box with sides like `aspect` (3,) fill `room` (2,), inches; return its `extent`."""
    zoom = 1.0
    for _ in range(ROUNDS):
        axes.set_box_aspect(aspect, zoom=zoom)
        _draw_bare(figure, axes)
        _clear_labels(figure, axes)
        corner, far = extent(figure, axes)
        zoom *= float((room / (far - corner)).min())
    axes.set_box_aspect(aspect, zoom=zoom)
    _draw_bare(figure, axes)
    return extent(figure, axes)


def _draw_bare(figure: Figure, axes: Any) -> None:
    """Draw the box with its numbers and names alone, which says where they stand.

    What is in the box, and what is beside it, costs ten times as much.
    """
    kept = {axes, axes.xaxis, axes.yaxis, axes.zaxis}
    artists = [*figure.get_children(), *axes.get_children()]
    hidden = [artist for artist in artists if artist not in kept and artist.get_visible()]
    for artist in hidden:
        artist.set_visible(False)
    figure.draw_without_rendering()
    for artist in hidden:
        artist.set_visible(True)


def _clear_labels(figure: Figure, axes: Any) -> None:
    """Move the names of the axes away from the numbers that they cover."""
    canvas: Any = figure.canvas
    renderer = canvas.get_renderer()
    every = (axes.xaxis, axes.yaxis, axes.zaxis)
    for axis in every:
        while axis.labelpad < FURTHEST:
            name = axis.label.get_window_extent(renderer)
            # As they were drawn; asked for in any other way they are where flat axes have them.
            ticks = [tick.label1 for one in every for tick in one.majorTicks]
            others = [other.label for other in every if other is not axis]
            boxes = [
                text.get_window_extent(renderer) for text in (*ticks, *others) if text.get_text()
            ]
            if not any(name.overlaps(box) for box in boxes):
                break
            axis.labelpad += 1.0
            _draw_bare(figure, axes)


def fit_box(
    figure: Figure, axes: Any, aspect: ArrayLike, heading: str, handles: Sequence[Artist]
) -> None:
    """Add title and legend, and make the box as large as fits between them.

    `aspect` (3,) are the relative lengths of the box's sides.  The figure then loses the height
    that the box does not need.
    """
    title = figure.suptitle(heading, x=MARGIN / figure.get_figwidth(), ha="left", va="top")
    legend = add_legend(figure, handles, place="lower center", columnspacing=1.0)
    width, height = figure.get_size_inches()
    over = title.get_window_extent().height / figure.dpi + 2.0 * MARGIN
    under = legend.get_window_extent().height / figure.dpi + MARGIN if handles else MARGIN
    room = np.array([width - 2.0 * MARGIN, height - over - under])
    corner, far = enlarge(figure, axes, aspect, room)
    whole = over + (far - corner)[1] + under
    # In inches: the middle of the box goes to the middle of its room.
    shift = np.array([width, whole + under - over]) / 2.0 - (corner + far) / 2.0
    x, y, across, up = WIDE
    figure.set_size_inches(width, whole)
    axes.set_position(
        (x + shift[0] / width, (y * height + shift[1]) / whole, across, up * height / whole)
    )
    title.set_y(1.0 - MARGIN / whole)
    _draw_bare(figure, axes)


def place(axes: Any, points: Floats) -> tuple[Floats, Floats]:
    """Return where (k, 3) points are on the paper: 2-D data and display coordinates, (k, 2)."""
    x, y, _ = proj3d.proj_transform(*points.T, axes.get_proj())
    flat = np.column_stack([x, y])
    return flat, np.asarray(axes.transData.transform(flat))


def label_boxes(axes: Any) -> list[BboxBase]:
    """Return where the names and the numbers of the three axes stand, display coordinates."""
    renderer = axes.get_figure(root=True).canvas.get_renderer()
    texts = [
        text
        for axis in (axes.xaxis, axes.yaxis, axes.zaxis)
        for text in (axis.label, *(tick.label1 for tick in axis.majorTicks))
    ]
    return [text.get_window_extent(renderer) for text in texts if text.get_text()]


def extent(figure: Figure, axes: Any) -> tuple[Floats, Floats]:
    """Return the lower left and upper right corner of box and labels, inches."""
    canvas: Any = figure.canvas
    renderer = canvas.get_renderer()
    labels = [axis.get_tightbbox(renderer) for axis in (axes.xaxis, axes.yaxis, axes.zaxis)]
    limits = (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())
    corners = place(axes, np.array(list(product(*limits))))[1]
    points = np.concatenate([corners, *(label.get_points() for label in labels)])
    return points.min(axis=0) / figure.dpi, points.max(axis=0) / figure.dpi

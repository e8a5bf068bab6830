"""Surface: a channel over two parameters as a landscape, with its map on the floor below it."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from lutgen.plot.contour import plane_words
from lutgen.plot.key import STAR, Scale
from lutgen.plot.labels import axis_label, channel_label, given
from lutgen.plot.painter import Camera
from lutgen.plot.plane import FINER, Plane
from lutgen.plot.style import BLACK, bare, colours
from lutgen.plot.view import View
from lutgen.vector import Floats

# Cells of the mesh each way, and cells between lines on the surface.
CELLS, STEP = 120, 10
CAMERA = Camera(-125.0, 26.0, np.eye(3))
# Heights over the side of the floor: the surface stands from LOW to HIGH above it.
LOW, HIGH = 0.36, 0.86
# Numbers and names stand so far outside of the floor.
NUMBERS, NAMES = 0.05, 0.17
LINE = (0.07, 0.09, 0.13, 0.5)
CORNERS = ((slice(-1), slice(-1)), (slice(-1), slice(1, None)))
CORNERS += tuple((slice(1, None), across) for _, across in reversed(CORNERS))


def draw_surface(view: View) -> Figure:
    """Return the figure."""
    plane = Plane(view, CELLS)
    best, stands = plane.best(), ~plane.tips[::FINER, ::FINER]
    figure, axes = view.page(5.4, (0.3, 0.1, 7.4, 5.3), *plane_words(view, best))
    bare(axes)
    values = np.where(stands, plane.values, np.nan)
    scale = Scale(view, values)
    u, v = np.meshgrid(*(np.linspace(0.0, 1.0, CELLS + 1),) * 2)
    share = np.where(stands, scale.share(values), np.nan)
    bands = len(scale.bounds) - 1
    floor = np.floor(np.minimum(share, 1.0 - 1e-9) * bands) / (bands - 1)
    _mesh(axes, np.dstack([u, v, 0.0 * u]), scale.cmap(floor), 1.0)
    _mesh(axes, np.dstack([u, v, LOW + (HIGH - LOW) * share]), scale.cmap(share), 5.0)
    _frame(axes, view, scale)
    if best is not None:
        ends = [view.window(i) for i in (0, 1)]
        x, y = ((best[i] - ends[i][0]) / np.ptp(ends[i]) for i in (0, 1))
        top = LOW + (HIGH - LOW) * float(scale.share(best[2]))
        spots = CAMERA.flat(np.array([[x, y, 0.0], [x, y, top]]))
        axes.plot(*spots.T, color="white", linewidth=1.0, linestyle=":", zorder=7)
        axes.plot(*spots[0], "o", color="white", markersize=6, markeredgecolor=BLACK, zorder=7.5)
        axes.plot(*spots[1:].T, label="best", **STAR)
    axes.autoscale_view()
    # Room for names beside and below the floor.
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    axes.set(xlim=(left - 0.12, right + 0.12), ylim=(low - 0.08, high))
    return figure


def _mesh(axes: Axes, points: Floats, paint: Floats, z: float) -> None:
    """Paint the quads of points (n, n, 3) from the back; on a surface with lines between them."""
    shapes = list(np.stack([points[corner] for corner in CORNERS], axis=2).reshape(-1, 4, 3))
    fills = list(np.mean([paint[corner] for corner in CORNERS], axis=0).reshape(-1, 4))
    edges = list(fills)
    if points[..., 2].any():
        for rows in (points[::STEP], points[:, ::STEP].swapaxes(0, 1)):
            pairs = np.stack([rows[:, :-1], rows[:, 1:]], axis=2).reshape(-1, 2, 3)
            # A little towards the eye, so that a line covers the quads beside it.
            shapes += list(pairs + 0.5 / CELLS * CAMERA.look)
            fills += [(0.0, 0.0, 0.0, 0.0)] * len(pairs)
            edges += [LINE] * len(pairs)
    depth = np.array([shape.mean(axis=0) @ CAMERA.look for shape in shapes])
    order = [i for i in np.argsort(depth, kind="stable") if np.isfinite(depth[i])]
    flat = [CAMERA.flat(shapes[i]) for i in order]
    found = PolyCollection(flat, closed=False, linewidths=0.45, rasterized=True, zorder=z)
    found.set(facecolor=np.array(fills)[order], edgecolor=np.array(edges)[order])
    axes.add_collection(found)


def _frame(axes: Axes, view: View, scale: Scale) -> None:
    """Draw the axes of both parameters and of the channel, with numbers and names."""
    unit = np.eye(3)
    rails: list[Any] = [
        (np.zeros(3), unit[0], -unit[1], "left", view.parameter(0).display_unit),
        (np.zeros(3), unit[1], -unit[0], "right", view.parameter(1).display_unit),
        (unit[1] + LOW * unit[2], (HIGH - LOW) * unit[2], unit[1], "right", scale.unit),
    ]
    for i, (start, along, out, side, shown_in) in enumerate(rails):
        ends = view.window(i) if i < 2 else (scale.low, scale.high)
        _line(axes, start, start + along)
        for tick in MaxNLocator(4, steps=[1, 2, 2.5, 3, 4.5, 5, 9, 10]).tick_values(*ends):
            part = (tick - ends[0]) / np.ptp(ends)
            if (0.1 if i < 2 else -1e-9) < part < 1.0 + 1e-9:
                spot = start + part * along
                _line(axes, spot, spot + 0.02 * out)
                x, y = CAMERA.flat(spot + NUMBERS * out)[0]
                axes.text(x, y, given(float(tick), shown_in), size=10, ha=side, va="center")
        if i < 2:
            x, y = CAMERA.flat(0.55 * along + NAMES * out)[0]
            axes.text(x, y, axis_label(view.parameter(i), 15), ha=side, va="top", linespacing=1.2)
    x, y = CAMERA.flat(unit[1] + (HIGH + 0.07) * unit[2])[0]
    axes.text(x, y, channel_label(view.recipe, view.channel), ha="left", va="bottom")


def _line(axes: Axes, start: Floats, stop: Floats) -> None:
    flat = CAMERA.flat(np.array([start, stop]))
    axes.plot(*flat.T, color=colours().soft, linewidth=0.9, zorder=0.5)

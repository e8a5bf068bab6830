"""Contour and surface: a channel over two parameters at one gravity direction."""

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from matplotlib.artist import Artist
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from lutgen.plot.box import box_axes, fit_box
from lutgen.plot.labels import axis_label, channel_label, optimum_text, slide_label, title
from lutgen.plot.levels import apart, extend, jumps, label_lines, levels
from lutgen.plot.marks import (
    STAR,
    degree_ticks,
    label_tip_over,
    mark_optimum,
    mark_sliding,
    shade_tip_over,
    tip_patch,
)
from lutgen.plot.style import HATCH, MAP, WASH, new_figure
from lutgen.plot.view import View, optimum
from lutgen.quantities import QUANTITIES

__all__ = ["CONTOUR_SIZE", "SURFACE_SIZE", "draw_contour", "draw_surface"]

Floats = NDArray[np.float64]

CONTOUR_SIZE = (3.5, 2.9)
SURFACE_SIZE = (3.5, 3.6)
SAMPLES = 101
# The floor of a surface lies this share of the range below it.
FLOOR = 0.6
# Lines of the mesh drawn on a surface, each way.
MESH = 12


@dataclass(frozen=True)
class Plane:
    """What is drawn, in display units.

    `x` (nx,) and `y` (ny,) are the parameters and `values` (ny, nx) the channel, NaN where the
    robot tips over if the channel is; `fine_x`, `fine_y`, `tip_angle` and `grip` (rad, see
    `View.grip`) are the exact verdicts on a finer mesh; `best` is the optimum's
    place (row, column), None without values.
    """

    x: Floats
    y: Floats
    values: Floats
    fine_x: Floats
    fine_y: Floats
    tip_angle: Floats
    grip: Floats | None
    best: tuple[int, int] | None


def draw_contour(view: View, size: tuple[float, float] | None) -> Figure:
    """Return the filled contour chart."""
    plane = _plane(view)
    figure = new_figure(size or CONTOUR_SIZE)
    axes = figure.add_subplot()
    axes.set_title(title(view, gravity=True))
    _name_axes(axes, view, plane)
    handles: list[Artist] = []
    if plane.best is not None:
        steps = levels(plane.values)
        under = np.clip(extend(plane.values), steps[0], steps[-1])
        fill = axes.contourf(plane.x, plane.y, under, levels=steps, cmap=MAP)
        lines = axes.contour(
            plane.x,
            plane.y,
            apart(under, steps[1] - steps[0]),
            levels=steps[1:-1],
            colors=["white"],
            linewidths=0.5,
            linestyles="solid",
        )
        label_lines(axes, lines)
        bar = figure.colorbar(fill, ax=axes, pad=0.02, aspect=28)
        bar.set_label(channel_label(view.recipe, view.channel))
        row, column = plane.best
        at = float(plane.x[column]), float(plane.y[row])
        text = optimum_text(view, float(plane.values[row, column]), plane.values, at)
        handles.append(mark_optimum(axes, *at, text))
    x, y = np.meshgrid(plane.fine_x, plane.fine_y)
    handles += mark_sliding(axes, (x, y), plane.grip, plane.tip_angle, slide_label(view.recipe))
    tips = shade_tip_over(axes, plane.fine_x, plane.fine_y, plane.tip_angle)
    if tips and not label_tip_over(axes, x, y, plane.tip_angle, cells=SAMPLES // 8):
        handles.append(tip_patch())
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=2, columnspacing=1.2)
    return figure


def draw_surface(view: View, size: tuple[float, float] | None) -> Figure:
    """Return the surface in perspective with its contour chart on the floor below it."""
    plane = _plane(view)
    figure = new_figure(size or SURFACE_SIZE)
    axes = box_axes(figure, 26.0, -125.0)
    _name_axes(axes, view, plane)
    axes.set_zlabel(channel_label(view.recipe, view.channel))
    axes.set_zlim(0.0, 1.0)
    axes.set_zticks([])
    handles: list[Artist] = []
    if plane.best is not None:
        steps = levels(plane.values)
        axes.set_zlim(steps[0] - FLOOR * (steps[-1] - steps[0]), steps[-1])
        axes.set_zticks(steps[:: 1 if len(steps) < 9 else 2])
        handles.append(_raise_surface(axes, view, plane, steps))
    if (plane.tip_angle < 0.0).any():
        x, y = np.meshgrid(plane.fine_x, plane.fine_y)
        shade = {"levels": [-4.0, 0.0], "colors": [WASH], "hatches": [HATCH], "zorder": 2}
        axes.contourf(x, y, plane.tip_angle, zdir="z", offset=axes.get_zlim()[0], **shade)
        handles.append(tip_patch())
    fit_box(figure, axes, (1.0, 1.0, 0.85), title(view, gravity=True), handles, size)
    return figure


def _raise_surface(axes: Any, view: View, plane: Plane, steps: Floats) -> Artist:
    """Draw the surface, its contour chart on the floor and the optimum on both."""
    floor = axes.get_zlim()[0]
    x, y = np.meshgrid(plane.x, plane.y)
    under = np.clip(extend(plane.values), steps[0], steps[-1])
    axes.contourf(x, y, under, levels=steps, cmap=MAP, zdir="z", offset=floor, zorder=1)
    axes.plot_surface(
        x,
        y,
        plane.values,
        cmap=MAP,
        norm=Normalize(steps[0], steps[-1]),
        rcount=SAMPLES,
        ccount=SAMPLES,
        linewidth=0.0,
        antialiased=False,
        zorder=5,
    )
    # Lines on a surface with cliffs would show through it.
    if not jumps(plane.values, 0).any() and not jumps(plane.values, 1).any():
        mesh = {"rcount": MESH, "ccount": MESH, "color": (0, 0, 0, 0.45), "linewidth": 0.35}
        axes.plot_wireframe(x, y, plane.values, zorder=6, **mesh)
    row, column = plane.best or (0, 0)
    at = float(plane.x[column]), float(plane.y[row])
    value = float(plane.values[row, column])
    axes.plot(*zip((*at, floor), (*at, value), strict=True), "k:", linewidth=0.8, zorder=7)
    axes.plot([at[0]], [at[1]], [floor], "k.", markersize=3, zorder=7)
    text = optimum_text(view, value, plane.values, at)
    (star,) = axes.plot([at[0]], [at[1]], [value], zorder=8, label=text, linestyle="none", **STAR)
    return cast("Artist", star)


def _name_axes(axes: Any, view: View, plane: Plane) -> None:
    """Label and limit the axes of the two parameters."""
    axes.set_xlabel(axis_label(view.parameter(0)))
    axes.set_ylabel(axis_label(view.parameter(1)))
    axes.set_xlim(plane.x[0], plane.x[-1])
    axes.set_ylim(plane.y[0], plane.y[-1])
    for place, axis in enumerate((axes.xaxis, axes.yaxis)):
        if view.parameter(place).display_unit == "deg":
            low, high = (plane.x, plane.y)[place][[0, -1]]
            # The lowest labels of two axes would meet in the corner of a box.
            degree_ticks(axis, low, high, "lower" if view.kind == "surface" else None)


def _plane(view: View) -> Plane:
    """Compute what is drawn: at the map's nodes, or exactly on an even mesh."""
    x, y = (view.knots(place, SAMPLES) for place in (0, 1))
    fine = [np.linspace(*view.ends(place), SAMPLES) for place in (0, 1)]
    everywhere = view.postures(*np.meshgrid(*fine))
    verdict = view.exact(everywhere, view.gravity_dir, "tip_angle")
    grip = view.grip(everywhere, view.gravity_dir)
    values = view.drawn(view.postures(*np.meshgrid(x, y)), view.gravity_dir)
    printed = QUANTITIES[view.channel].shown(values).reshape(len(y), len(x))
    if view.channel not in ("sdg", "height"):
        # The others go on below zero beyond tip-over, where the hatching is.
        printed = np.where(printed < 0.0, np.nan, printed)
    best = optimum(view.channel, printed)
    return Plane(
        view.shown(0, x),
        view.shown(1, y),
        printed,
        view.shown(0, fine[0]),
        view.shown(1, fine[1]),
        verdict["tip_angle"].reshape(SAMPLES, SAMPLES),
        None if grip is None else grip.reshape(SAMPLES, SAMPLES),
        None if best is None else divmod(best, len(x)),
    )

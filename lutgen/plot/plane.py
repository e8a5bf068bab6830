"""Contour and surface: a channel over two parameters at one gravity direction."""

import math
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from matplotlib.artist import Artist
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from lutgen.plot.box import box_axes, fit_box
from lutgen.plot.labels import channel_label, name_axes, optimum_text, slide_label, title
from lutgen.plot.legend import add_legend
from lutgen.plot.levels import fill, jumps, label_lines, levels, outline
from lutgen.plot.marks import (
    STAR,
    TIPPED,
    label_tip_over,
    mark_optimum,
    mark_sliding,
    shade_tip_over,
    tip_patch,
)
from lutgen.plot.palette import MAP
from lutgen.plot.style import head, new_figure
from lutgen.plot.view import View, optimum
from lutgen.quantities import QUANTITIES

Floats = NDArray[np.float64]

CONTOUR_SIZE = (3.5, 2.9)
SURFACE_SIZE = (3.5, 3.6)
SAMPLES = 101
# The floor of a surface lies this share of the range below it.
FLOOR = 0.35
# Lines of the mesh drawn on a surface, each way.
MESH = 12
# Numbers beside a surface.
MOST_STEPS = 6


@dataclass(frozen=True)
class Plane:
    """What is drawn, in display units.

    `x` and `y` are the parameters and `values` the channel, NaN where the robot tips over if the
    channel is; `fine_x`, `fine_y`, `tip_angle` and `grip` (rad, see `View.grip`) are the exact
    verdicts on a finer mesh; all (ny, nx).  `best` is the optimum: its place (x, y), value and
    words; None without values.
    """

    x: Floats
    y: Floats
    values: Floats
    fine_x: Floats
    fine_y: Floats
    tip_angle: Floats
    grip: Floats
    best: tuple[float, float, float, str] | None


def draw_contour(view: View) -> Figure:
    """Return the filled contour chart."""
    plane = _plane(view)
    figure = new_figure(CONTOUR_SIZE)
    axes = figure.add_subplot()
    head(figure, title(view, gravity=True))
    name_axes(axes, view, plane.x[0], plane.y[:, 0])
    handles: list[Artist] = []
    if plane.best is not None:
        steps = levels(plane.values, view.scale)
        filled = fill(axes, plane.x, plane.y, plane.values, steps)
        look: dict[str, Any] = {"linewidths": 0.5, "linestyles": "solid"}
        label_lines(axes, outline(axes, plane.x, plane.y, plane.values, steps, **look))
        label = channel_label(view.recipe, view.channel)
        figure.colorbar(filled, ax=axes, pad=0.02, aspect=28, label=label)
        x, y, _, words = plane.best
        handles.append(mark_optimum(axes, x, y, words))
    fine, tip_angle = (plane.fine_x, plane.fine_y), plane.tip_angle
    handles += mark_sliding(axes, fine, plane.grip, tip_angle, slide_label(view.recipe))
    tips = shade_tip_over(axes, *fine, tip_angle)
    if tips and not label_tip_over(axes, *fine, tip_angle, cells=SAMPLES // 8):
        handles.append(tip_patch())
    if handles:
        add_legend(figure, handles)
    return figure


def draw_surface(view: View) -> Figure:
    """Return the surface in perspective with its contour chart on the floor below it."""
    plane = _plane(view)
    figure = new_figure(SURFACE_SIZE)
    axes = box_axes(figure, 26.0, -125.0)
    name_axes(axes, view, plane.x[0], plane.y[:, 0])
    axes.set(zlabel=channel_label(view.recipe, view.channel), zlim=(0.0, 1.0), zticks=[])
    handles: list[Artist] = []
    if plane.best is not None:
        steps = levels(plane.values, view.scale)
        axes.set_zlim(steps[0] - FLOOR * (steps[-1] - steps[0]), steps[-1])
        axes.set_zticks(steps[:: max(1, math.ceil(len(steps) / MOST_STEPS))])
        _raise_surface(axes, plane, steps)
        handles.append(_raise_optimum(axes, *plane.best))
    if (plane.tip_angle < 0.0).any():
        floor = {"zdir": "z", "offset": axes.get_zlim()[0], "zorder": 2}
        axes.contourf(plane.fine_x, plane.fine_y, plane.tip_angle, **floor, **TIPPED)
        handles.append(tip_patch())
    fit_box(figure, axes, (1.0, 1.0, 0.85), title(view, gravity=True), handles)
    return figure


def _raise_surface(axes: Any, plane: Plane, steps: Floats) -> None:
    """Draw the surface and its contour chart on the floor."""
    x, y = plane.x, plane.y
    fill(axes, x, y, plane.values, steps, zdir="z", offset=axes.get_zlim()[0], zorder=1)
    colours = {"cmap": MAP, "norm": Normalize(steps[0], steps[-1]), "antialiased": False}
    every = {"rcount": SAMPLES, "ccount": SAMPLES}
    axes.plot_surface(x, y, plane.values, linewidth=0.0, zorder=5, **every, **colours)
    # Lines on a surface with cliffs would show through it.
    if not jumps(plane.values, 0).any() and not jumps(plane.values, 1).any():
        mesh = {"rcount": MESH, "ccount": MESH, "color": (0, 0, 0, 0.45), "linewidth": 0.35}
        axes.plot_wireframe(x, y, plane.values, zorder=6, **mesh)


def _raise_optimum(axes: Any, x: float, y: float, value: float, words: str) -> Artist:
    """Mark the optimum on the surface and on the floor."""
    floor = axes.get_zlim()[0]
    axes.plot([x, x], [y, y], [floor, value], "k:", linewidth=0.8, zorder=7)
    axes.plot([x], [y], [floor], "k.", markersize=3, zorder=7)
    (star,) = axes.plot([x], [y], [value], zorder=8, label=words, **STAR)
    return cast("Artist", star)


def _plane(view: View) -> Plane:
    """Compute what is drawn: at the map's nodes, or exactly on an even mesh."""
    mesh = np.meshgrid(*(view.knots(place, SAMPLES) for place in (0, 1)))
    fine = np.meshgrid(*(np.linspace(*view.ends(place), SAMPLES) for place in (0, 1)))
    everywhere = view.postures(*fine)
    verdict = view.exact(everywhere, view.gravity_dir, "tip_angle")["tip_angle"]
    tip_angle = verdict.reshape(fine[0].shape)
    grip = view.grip(everywhere, view.gravity_dir).reshape(fine[0].shape)
    x, y, fine_x, fine_y = (view.shown(i, part[i]) for part in (mesh, fine) for i in (0, 1))
    values = QUANTITIES[view.channel].shown(view.drawn(view.postures(*mesh))).reshape(x.shape)
    if view.channel not in ("sdg", "height"):
        # The others go on below zero beyond tip-over, where the hatching is.
        values = np.where(values < 0.0, np.nan, values)
    best, at = None, optimum(view.channel, values)
    if at is not None:
        place, value = (float(x.flat[at]), float(y.flat[at])), float(values.flat[at])
        words = optimum_text(view, value, values, place)
        # The best of a map's nodes, which the robot's own optimum may lie between.
        words += " (map node)" if view.stability_map is not None else ""
        best = (*place, value, words)
    return Plane(x, y, values, fine_x, fine_y, tip_angle, grip, best)

"""Path: where a robot tips over on its way, and what it does against it."""

from collections.abc import Mapping
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from lutgen.plot.labels import parameter_text, plain, unit_label
from lutgen.plot.painter import Camera
from lutgen.plot.style import bare, colours, in_house_style, page, place
from lutgen.recipe import Recipe
from lutgen.search import Drive
from lutgen.vector import Floats

# Inches: the picture of a path, a strip below it, the room between strips, and around them.
BOX, STRIP, GAP, FOOT, LEFT, RIGHT = 2.5, 1.05, 0.16, 0.62, 0.95, 0.25
CAMERA = Camera(-68.0, 20.0, np.eye(3))
DASHES = ("-", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (5, 1.5, 1, 1.5)))


@in_house_style
def draw_path(recipe: Recipe, runs: Mapping[str, Drive]) -> Figure:
    """Draw one or two runs along the same path, the name of each its title.

    The path is in equal scale, red where the robot tips over; below it are strips over the length
    of the path: tip-over angles, and of the last run the parameters and by how much it turned.
    """
    drawn = list(runs.items())[:2]
    last = drawn[-1][1]
    units = dict.fromkeys(parameter.display_unit for parameter in recipe.parameters)
    rows = list(units) if np.ptp(last.params, axis=0).any() else []
    count = 1 + len(rows) + bool(np.any(last.turn))
    below = FOOT + count * (STRIP + GAP) + 0.15
    said = [f"{name} at {run.tips.sum()} of {run.tips.size} points" for name, run in drawn]
    note = f"{plain(recipe.title or recipe.name)}. Red: it tips over. Below: along the path."
    figure = page(below + BOX + 0.3, f"Tips over: {', '.join(said)}", note)
    wide, tall = 8.0 / len(drawn), figure.get_figheight()
    for i, (name, run) in enumerate(drawn):
        _raise_path(bare(place(figure, (0.15 + wide * i, below, wide - 0.3, BOX))), run)
        x, y = (0.25 + wide * i) / 8.0, (below + BOX + 0.05) / tall
        figure.text(x, y, name, size=11, weight="bold")
    boxes = [(LEFT, FOOT + k * (STRIP + GAP), 8.0 - LEFT - RIGHT, STRIP) for k in range(count)]
    strips = [place(figure, box) for box in reversed(boxes)]
    for axes in strips:
        # Two lines of text fit on the left of it, however long the numbers are.
        axes.yaxis.set_label_coords(-0.07, 0.5)
        axes.yaxis.set_major_locator(MaxNLocator(4))
        axes.set_xlim(0.0, float(last.path.distance[-1]))
        axes.tick_params(labelbottom=axes is strips[-1])
    draw_angles(strips[0], dict(drawn))
    for axes, unit in zip(strips[1:], rows, strict=False):
        _draw_parameters(axes, recipe, unit, last)
    if count > 1 + len(rows):
        turn = np.degrees(last.turn)
        strips[-1].step(last.path.distance, turn, where="mid", color=colours().blue)
        strips[-1].set(ylabel="turn\n(deg)", ylim=(-200.0, 200.0), yticks=range(-180, 181, 90))
    strips[-1].set_xlabel(unit_label("path length", recipe.length_unit))
    return figure


def _raise_path(axes: Axes, run: Drive) -> None:
    """Draw the path in parallel projection, on a curtain that hangs down to the floor."""
    look, points = colours(), run.path.position - run.path.position.mean(axis=0)
    foot = points.copy()
    foot[:, 2] = points[:, 2].min() - 0.06 * float(np.ptp(points, axis=0).max())
    quads = np.stack([points[:-1], points[1:], foot[1:], foot[:-1]], axis=1)
    order = np.argsort(quads.mean(axis=1) @ CAMERA.look, kind="stable")
    flat = [CAMERA.flat(quad) for quad in quads[order]]
    paint: dict[str, Any] = {"facecolors": look.slab, "edgecolors": look.slab, "linewidths": 0.3}
    axes.add_collection(PolyCollection(flat, **paint))
    axes.plot(*CAMERA.flat(foot).T, color=look.soft, linewidth=0.5, zorder=1)
    for tips, colour, width in ((False, look.ink, 1.2), (True, look.red, 4.0)):
        parts = [CAMERA.flat(part) for part in _parts(points, run.tips == tips)]
        lines = LineCollection(parts, colors=colour, linewidths=width, zorder=5 + tips)
        axes.add_collection(lines).set(label="tips over" if tips else "stands", capstyle="butt")
    axes.plot(*CAMERA.flat(points[0])[0], "o", color=look.ink, markersize=5, zorder=8)
    axes.margins(0.06)
    axes.autoscale_view()


def _parts(points: Floats, kept: NDArray[np.bool_]) -> list[Floats]:
    """Return the pieces of the path around the points kept, each to half way to the next one."""
    fine = np.empty((2 * len(points) - 1, 3))
    fine[::2], fine[1::2] = points, (points[1:] + points[:-1]) / 2.0
    edges = np.flatnonzero(np.diff(np.pad(kept.astype(int), 1))).reshape(-1, 2)
    return [fine[max(2 * begin - 1, 0) : 2 * end] for begin, end in edges]


def draw_angles(axes: Axes, runs: Mapping[str, Drive]) -> None:
    """Draw the tip-over angles, and hatch below 0."""
    looks = [(colours().soft, 1.2), (colours().blue, 1.6)][-len(runs) :]
    for (name, run), (colour, width) in zip(runs.items(), looks, strict=True):
        tip = np.degrees(run.channels["tip_angle"])
        axes.plot(run.path.distance, tip, label=name, zorder=4, color=colour, linewidth=width)
    low, high = axes.get_ylim()
    low, high = min(low, -0.05 * high), max(high, 0.05 * abs(low))
    shade: dict[str, Any] = {"facecolor": colours().wash, "edgecolor": colours().hatch}
    axes.axhspan(low, 0.0, linewidth=0.0, zorder=0.5, hatch="//", **shade)
    axes.axhline(0.0, color=colours().ink, linewidth=0.8, zorder=2)
    axes.set(ylim=(low, high), ylabel="tip-over\nangle (deg)")
    if len(runs) > 1:
        _legend(axes)


def _legend(axes: Axes) -> None:
    """Write a legend above the lines."""
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.35 * (high - low))
    axes.legend(loc="upper right", ncols=4, borderpad=0.1)


def _draw_parameters(axes: Axes, recipe: Recipe, unit: str, run: Drive) -> None:
    """Draw the parameters of one unit; thin what the robot wanted and had not reached."""
    tints = (colours().blue, colours().ink, "#009e73", "#cc79a7")
    columns = [i for i, p in enumerate(recipe.parameters) if p.display_unit == unit]
    for i, (tint, dashes) in zip(columns, cycle(zip(tints, DASHES, strict=True)), strict=False):
        parameter = recipe.parameters[i]
        wanted, reached = (parameter.shown(v[:, i]) for v in (run.wanted, run.params))
        look: dict[str, Any] = {"where": "mid", "color": tint, "linestyle": dashes}
        axes.step(run.path.distance, reached, label=parameter_text(parameter), lw=1.6, **look)
        if (wanted != reached).any():
            axes.step(run.path.distance, wanted, alpha=0.5, linewidth=0.6, **look)
    named = unit_label("geometry", recipe.length_unit if unit == "1" else unit)
    axes.set_ylabel(named.replace(" (", "\n("))
    axes.margins(y=0.08)
    if len(columns) <= len(tints):
        _legend(axes)

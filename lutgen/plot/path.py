"""Path: where a robot tips over on its way, in 3-D, and what it does against it."""

from collections.abc import Mapping
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from numpy.typing import NDArray

from lutgen.plot.box import box_axes, enlarge, set_limits
from lutgen.plot.labels import parameter_text, unit_label
from lutgen.plot.legend import add_legend
from lutgen.plot.marks import HATCHED, TIPS, tip_patch
from lutgen.plot.palette import BLUE, GREEN, GREY, PURPLE, RED
from lutgen.plot.style import in_house_style, new_figure
from lutgen.recipe import Recipe
from lutgen.search import Drive

Floats = NDArray[np.float64]

STANDING: dict[str, Any] = {"color": "black", "linewidth": 0.9}
TIPPING: dict[str, Any] = {"color": RED, "linewidth": 2.6}
CURTAIN = "#e4e4e4"
LOOKS: tuple[dict[str, Any], ...] = (
    {"color": BLUE, "linestyle": "-"},
    {"color": GREEN, "linestyle": (0, (4, 1.5))},
    {"color": PURPLE, "linestyle": (0, (4, 1.2, 1, 1.2))},
    {"color": GREY, "linestyle": (0, (2.5, 1))},
)
# Inches: a column of a journal, the picture in perspective, and one of the strips below it.
COLUMN, BOX, STRIP = 3.5, 2.75, 0.85
HEADING, LEGEND, LABEL, GAP, LEFT, RIGHT = 0.24, 0.24, 0.34, 0.13, 0.66, 0.12
ELEVATION, AZIMUTH = 16.0, -68.0
# Each side of the box is at least this share of the longest, so that a flat path has room.
THINNEST = 0.3
# Points; seen nearly from the side, the ticks of z need more room.
TICK_PAD, LABEL_PAD = (3.5, 3.5, 6.0), 14.0


@in_house_style
def draw_path(recipe: Recipe, runs: Mapping[str, Drive]) -> Figure:
    """Draw one or two runs along the same path.

    Parameters
    ----------
    recipe : Recipe
        The robot.
    runs : mapping of str to Drive
        One or two; the name of each is its title.  The last one's geometry is drawn.

    Returns
    -------
    matplotlib.figure.Figure
        In equal scale on all three axes, where that leaves a box to look at; below it strips over
        the length of the path: tip-over angles, parameters, and by how much the robot turned.
    """
    drawn = list(runs.items())[:2]
    last = drawn[-1][1]
    rows = _by_unit(recipe) if np.ptp(last.params, axis=0).any() else {}
    turns = bool(np.any(last.turn))
    count = 1 + len(rows) + turns
    below = LEGEND + LABEL + count * STRIP + (count - 1) * GAP
    size = (COLUMN * len(drawn), BOX + HEADING + below + GAP)
    figure = new_figure(size)
    boxes = [box_axes(figure, ELEVATION, AZIMUTH) for _ in drawn]
    for i, ((name, run), axes) in enumerate(zip(drawn, boxes, strict=True)):
        _raise_path(axes, recipe, run)
        _fit(figure, axes, (COLUMN * i, below + GAP, COLUMN, BOX))
        text = f"{recipe.name}, {name}: {TIPS} at {int(run.tips.sum())} of {run.tips.size} points"
        letter = f"({'ab'[i]}) " if len(drawn) > 1 else ""
        at = ((COLUMN * i + 0.06) / size[0], 1.0 - 0.06 / size[1])
        figure.text(*at, f"{letter}{text}", va="top")
    strips = [_strip(figure, k, count, last) for k in range(count)]
    if len(drawn) > 1:
        for letter, axes in zip("cdef", strips, strict=False):
            figure.text(0.06 / size[0], axes.get_position().y1, f"({letter})", va="top")
    draw_angles(strips[0], dict(drawn))
    for axes, unit in zip(strips[1:], rows, strict=False):
        _draw_parameters(axes, recipe, unit, rows[unit], last)
    if turns:
        _draw_turns(strips[-1], last)
    strips[-1].set_xlabel(unit_label("path length", recipe.length_unit))
    strips[-1].tick_params(labelbottom=True)
    stands, tips = Line2D([], [], label="stands", **STANDING), Line2D([], [], label=TIPS, **TIPPING)
    handles: list[Artist] = [stands, tips, tip_patch("tip-over angle < 0")]
    add_legend(figure, handles, columns=3, place="lower center", columnspacing=1.4)
    return figure


def _by_unit(recipe: Recipe) -> dict[str, list[int]]:
    """Return the columns of the parameters that share a unit, by unit."""
    found: dict[str, list[int]] = {}
    for column, parameter in enumerate(recipe.parameters):
        found.setdefault(parameter.display_unit, []).append(column)
    return found


def _raise_path(axes: Any, recipe: Recipe, run: Drive) -> None:
    """Draw the path in perspective, on a curtain that hangs down to the floor."""
    points = run.path.position
    low, high = points.min(axis=0), points.max(axis=0)
    longest = float((high - low).max())
    half = np.maximum((high - low) * 1.04, THINNEST * longest) / 2.0
    middle = (low + high) / 2.0
    set_limits(axes, middle - half, middle + half)
    for i, (name, axis) in enumerate({"x": axes.xaxis, "y": axes.yaxis, "z": axes.zaxis}.items()):
        axis.set_label_text(unit_label(name, recipe.length_unit))
        axis.set_major_locator(MaxNLocator(max(round(6 * half[i] / half.max()), 2), prune="lower"))
        # Matplotlib moves labels away from the box by a share of its other two sides.
        stretch = half.max() / np.delete(half, i).max()
        axis.set_tick_params(pad=TICK_PAD[i] * stretch)
        axis.labelpad = LABEL_PAD * stretch
    # The next box must not cover this one.
    axes.patch.set_visible(False)
    foot = points.copy()
    foot[:, 2] = middle[2] - half[2]
    quads = np.stack([points[:-1], points[1:], foot[1:], foot[:-1]], axis=1)
    axes.add_collection3d(
        Poly3DCollection(quads, facecolors=CURTAIN, edgecolors=CURTAIN, linewidths=0.3, zorder=2)
    )
    axes.plot(*foot.T, color=GREY, linewidth=0.4, zorder=3)
    for tips, look in ((False, STANDING), (True, TIPPING)):
        parts = _parts(points, run.tips == tips)
        if parts:
            lines = Line3DCollection(parts, capstyle="butt", zorder=5 + tips, **look)
            axes.add_collection3d(lines)


def _parts(points: Floats, kept: NDArray[np.bool_]) -> list[Floats]:
    """Return the pieces of the path around the points kept, each to half way to the next one."""
    between = (points[1:] + points[:-1]) / 2.0
    fine = np.empty((2 * len(points) - 1, 3))
    fine[::2], fine[1::2] = points, between
    edges = np.flatnonzero(np.diff(np.pad(kept.astype(int), 1))).reshape(-1, 2)
    return [fine[max(2 * begin - 1, 0) : 2 * end] for begin, end in edges]


def _fit(figure: Figure, axes: Any, window: tuple[float, float, float, float]) -> None:
    """Make a box as large as fits into a window: left, bottom, width and height in inches."""
    # In equal scale.  A tuple, because matplotlib changes an array in place.
    aspect = tuple(np.ptp(lim) for lim in (axes.get_xlim(), axes.get_ylim(), axes.get_zlim()))
    x, y, width, height = window
    across, up = figure.get_size_inches()
    # Larger than the window, because axes cut off what is drawn outside of them.
    axes.set_position(
        ((x - width) / across, (y - height) / up, 3.0 * width / across, 3.0 * height / up)
    )
    corner, far = enlarge(figure, axes, aspect, np.array([width - 0.1, height - 0.1]))
    shift = np.array([x + width / 2.0, y + height / 2.0]) - (corner + far) / 2.0
    box = axes.get_position(original=True)
    axes.set_position((box.x0 + shift[0] / across, box.y0 + shift[1] / up, box.width, box.height))


def _strip(figure: Figure, k: int, count: int, run: Drive) -> Axes:
    """Return the axes of strip k, counted from the top."""
    across, up = figure.get_size_inches()
    bottom = LEGEND + LABEL + (count - 1 - k) * (STRIP + GAP)
    axes = figure.add_axes((LEFT / across, bottom / up, 1.0 - (LEFT + RIGHT) / across, STRIP / up))
    # Two lines of text fit on the left of it, however long the tick labels are.
    axes.yaxis.set_label_coords(-0.5 * LEFT / (across - LEFT - RIGHT), 0.5)
    axes.set_xlim(0.0, float(run.path.distance[-1]))
    axes.tick_params(labelbottom=False)
    axes.yaxis.set_major_locator(MaxNLocator(4))
    return axes


def _legend(axes: Axes) -> None:
    """Put the strip's legend where it covers least, on a plate."""
    legend = axes.legend(
        loc="best", ncols=2, frameon=True, borderpad=0.25, handlelength=2.2, columnspacing=1.2
    )
    legend.get_frame().set(linewidth=0.0, alpha=0.85)


def draw_angles(axes: Axes, runs: dict[str, Drive]) -> None:
    """Draw the tip-over angles, and hatch below 0."""
    looks = (LOOKS[-1] | {"linewidth": 1.0}, LOOKS[0])[-len(runs) :]
    for (name, run), look in zip(runs.items(), looks, strict=True):
        angle = np.degrees(run.channels["tip_angle"])
        axes.plot(run.path.distance, angle, label=name, zorder=4, **look)
    low, high = axes.get_ylim()
    low, high = min(low, -0.05 * high), max(high, 0.05 * abs(low))
    axes.axhspan(low, 0.0, linewidth=0.0, zorder=0.5, **HATCHED)
    axes.axhline(0.0, color="black", linewidth=0.7, zorder=2)
    # Room for the legend above the lines.
    axes.set_ylim(low, high + (0.3 * (high - low) if len(runs) > 1 else 0.0))
    axes.set_ylabel("tip-over\nangle (deg)")
    if len(runs) > 1:
        _legend(axes)


def _draw_parameters(axes: Axes, recipe: Recipe, unit: str, columns: list[int], run: Drive) -> None:
    """Draw the parameters of one unit; thin where the robot wanted what it had not reached."""
    distance = run.path.distance
    for i, look in zip(columns, cycle(LOOKS), strict=False):
        parameter = recipe.parameters[i]
        wanted, reached = (parameter.shown(v[:, i]) for v in (run.wanted, run.params))
        if (wanted != reached).any():
            axes.step(distance, wanted, where="mid", alpha=0.5, **look | {"linewidth": 0.5})
        label = parameter_text(parameter)
        axes.step(distance, reached, where="mid", label=label, **look)
    named = unit_label("geometry", recipe.length_unit if unit == "1" else unit)
    axes.set_ylabel(named.replace(" (", "\n("))
    axes.margins(y=0.08)
    if len(columns) <= 2 * len(LOOKS):
        _legend(axes)


def _draw_turns(axes: Axes, run: Drive) -> None:
    """Draw by how much the robot is turned against the path's heading."""
    axes.step(run.path.distance, np.degrees(run.turn), where="mid", **LOOKS[0])
    axes.set(ylabel="turn\n(deg)", ylim=(-200.0, 200.0), yticks=range(-180, 181, 90))

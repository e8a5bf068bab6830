"""Path: where a robot tips over on its way, what it does against it, and a film of both."""

import math
import os
import tempfile
from collections.abc import Mapping
from itertools import cycle
from pathlib import Path
from subprocess import CalledProcessError
from typing import Any

import numpy as np
from matplotlib.animation import FFMpegWriter, FuncAnimation, PillowWriter
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray
from PIL import Image

from lutgen.errors import InputError, reject
from lutgen.files import write_bytes
from lutgen.plot.labels import angle, parameter_text, plain, unit_label
from lutgen.plot.painter import Camera
from lutgen.plot.scene import draw_scene
from lutgen.plot.solids import reach_of
from lutgen.plot.style import (
    bare,
    colours,
    house_style,
    in_house_style,
    known_suffix,
    new_figure,
    page,
    place,
)
from lutgen.recipe import Recipe, forward
from lutgen.search import Drive
from lutgen.vector import Floats

# Inches: the picture of a path, a strip below it, the room between strips, and around them.
BOX, STRIP, GAP, FOOT, LEFT, RIGHT = 2.5, 1.05, 0.16, 0.62, 0.95, 0.25
CAMERA = Camera(-68.0, 20.0, np.eye(3))
DASHES = ("-", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (5, 1.5, 1, 1.5)))
# Bounds the time and the size of the file.
MOST_FRAMES, COLOURS = 60, 64
# Seconds: the length of a film, and the shortest and longest time of a frame.
LENGTH, SHORTEST, LONGEST = 7.2, 0.12, 0.5
# Inches and dots; films need an even number of dots each way.
SIZE, RESOLUTION = (8.0, 5.6), 80
# Options of ffmpeg: no dates and versions, but our mark (lutgen/files.py).
EXACTLY = ["-fflags", "+bitexact", "-metadata", "comment=lutgen"]


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


class _Gif(PillowWriter):
    """A GIF that repeats, with our mark and one palette, so that colours do not flicker."""

    def finish(self) -> None:
        frames: Any = vars(self)["_frames"]
        whole: list[Any] = [frame.convert("RGB") for frame in frames]
        some = [np.asarray(whole[i]) for i in sorted({0, len(whole) // 2, len(whole) - 1})]
        typical = Image.fromarray(np.concatenate(some))
        palette = typical.quantize(COLOURS, Image.Quantize.MAXCOVERAGE)
        few = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in whole]
        look: dict[str, Any] = {"duration": round(1000 / self.fps), "loop": 0, "comment": b"lutgen"}
        few[0].save(self.outfile, save_all=True, append_images=few[1:], **look)


def check_animation(path: str | os.PathLike[str]) -> None:
    """Refuse other suffixes than .gif and .mp4, and .mp4 without ffmpeg."""
    if known_suffix(path, "film", (".gif", ".mp4")) == ".mp4" and not FFMpegWriter.isAvailable():
        way_out = "install it, or end the name in .gif"
        reject(path, "an MP4 needs the program ffmpeg", "none on the path", way_out, InputError)


def animate(
    recipe: Recipe, runs: Mapping[str, Drive], path: str | os.PathLike[str], force: bool = False
) -> int:
    """Write a film of one or two runs along the same path; return the number of its frames.

    The name of each run is its title; `path` ends in .gif, or in .mp4 if ffmpeg is installed.  The
    frames, at most `MOST_FRAMES`, are evenly spread over the points.  The same runs give the same
    bytes of a GIF.  A file that lutgen did not make is replaced only with `force`.
    """
    check_animation(path)
    drawn, gif = dict(list(runs.items())[:2]), Path(path).suffix.lower() == ".gif"
    points = len(next(iter(drawn.values())).path.position)
    count = min(points, MOST_FRAMES)
    at = np.linspace(0, points - 1, count).round().astype(int)
    rate: Any = 1.0 / min(max(LENGTH / count, SHORTEST), LONGEST)
    writer: Any = _Gif(rate) if gif else FFMpegWriter(rate, extra_args=EXACTLY)
    with house_style(), tempfile.TemporaryDirectory() as folder:
        target, film = Path(folder) / f"film{Path(path).suffix}", _Film(recipe, drawn)
        moving = FuncAnimation(film.figure, film.show, at.tolist(), lambda: None, repeat=False)
        try:
            moving.save(target, writer, dpi=RESOLUTION)
            content = target.read_bytes()
        except (CalledProcessError, OSError) as error:
            raise InputError(
                f"{path}: ffmpeg made no film (got {type(error).__name__}); end the name in .gif."
            ) from error
    write_bytes(path, content, force=force)
    return count


class _Film:
    """The picture: a robot for each run above strips of the terrain and of the tip-over angles."""

    def __init__(self, recipe: Recipe, runs: dict[str, Drive]) -> None:
        self.recipe, self.runs, self.figure = recipe, runs, new_figure(SIZE)
        self.path, share = next(iter(runs.values())).path, 1.0 / len(runs)
        left = [i * share for i in range(len(runs))]
        self.panels = [self.figure.add_axes((x, 0.4, share, 0.52)) for x in left]
        bold: dict[str, Any] = {"size": 14, "weight": "bold", "va": "top"}
        self.titles = [self.figure.text(x + 0.02, 0.98, "", **bold) for x in left]
        ends = [part for run in runs.values() for part in (run.params.min(0), run.params.max(0))]
        self.reach = max(reach_of(recipe, c) for c in forward(recipe, np.array(ends)).centres)
        ground, strip = (self.figure.add_axes((0.12, low, 0.86, 0.14)) for low in (0.27, 0.105))
        distance, z = self.path.distance, self.path.position[:, 2]
        room = max(float(np.ptp(z)), 1e-9)
        ground.fill_between(distance, z, z.min() - room, facecolor=colours().slab, linewidth=0.0)
        ground.plot(distance, z, color=colours().ink, linewidth=1.0)
        label = unit_label("height", recipe.length_unit).replace(" (", "\n(")
        ground.set(ylim=(z.min() - 0.2 * room, z.max() + 0.3 * room), ylabel=label, xticks=[])
        draw_angles(strip, runs)
        strip.set_xlabel(unit_label("path length", recipe.length_unit))
        for axes in (ground, strip):
            axes.set_xlim(0.0, float(distance[-1]))
            axes.yaxis.set_major_locator(MaxNLocator(3))
            axes.yaxis.set_label_coords(-0.08, 0.5)
        self.cursors = [axes.axvline(0.0, color=colours().ink) for axes in (ground, strip)]

    def show(self, i: int) -> None:
        """Show point i."""
        drawn = zip(self.panels, self.titles, self.runs.items(), strict=True)
        for axes, title, (name, run) in drawn:
            axes.clear()
            scene = draw_scene(bare(axes), self.recipe, run.params[i], run.gravity_body[i], 0.7)
            (x, y), wide, high = scene.com, 1.75 * self.reach, 1.45 * self.reach
            axes.set(xlim=(x - wide, x + wide), ylim=(y - high, y + high))
            tip = angle(math.degrees(float(run.channels["tip_angle"][i])))
            title.set_text(f"{plain(name)}: {'tips over' if run.tips[i] else f'stands, {tip}'}")
            title.set_color(colours().red if run.tips[i] else colours().ink)
        for cursor in self.cursors:
            cursor.set_xdata([float(self.path.distance[i])] * 2)

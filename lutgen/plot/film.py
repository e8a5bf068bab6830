"""Film: a robot on its way over terrain, beside the same robot without control."""

import math
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from subprocess import CalledProcessError
from typing import Any

import numpy as np
from matplotlib.animation import FFMpegWriter, FuncAnimation, PillowWriter
from matplotlib.ticker import MaxNLocator
from PIL import Image

from lutgen.errors import InputError, reject
from lutgen.files import write_bytes
from lutgen.plot.labels import angle, plain, unit_label
from lutgen.plot.path import draw_angles
from lutgen.plot.scene import draw_scene
from lutgen.plot.solids import reach_of
from lutgen.plot.style import bare, colours, house_style, known_suffix, new_figure
from lutgen.recipe import Recipe, forward
from lutgen.search import Drive

# Bounds the time and the size of the file.
MOST_FRAMES, COLOURS = 60, 64
# Seconds: the length of a film, and the shortest and longest time of a frame.
LENGTH, SHORTEST, LONGEST = 7.2, 0.12, 0.5
# Inches and dots; films need an even number of dots each way.
SIZE, RESOLUTION = (8.0, 5.6), 80
# Of ffmpeg: no dates and versions, but our mark (lutgen/files.py).
EXACTLY = ["-fflags", "+bitexact", "-metadata", "comment=lutgen"]


class _Gif(PillowWriter):
    """A GIF that repeats, with our mark and one palette, so that colours do not flicker."""

    def finish(self) -> None:
        frames: Any = vars(self)["_frames"]
        whole: list[Any] = [frame.convert("RGB") for frame in frames]
        some = [np.asarray(whole[i]) for i in sorted({0, len(whole) // 2, len(whole) - 1})]
        palette = Image.fromarray(np.concatenate(some)).quantize(
            COLOURS, Image.Quantize.MAXCOVERAGE
        )
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
        for axes, title, (name, run) in zip(
            self.panels, self.titles, self.runs.items(), strict=True
        ):
            axes.clear()
            scene = draw_scene(bare(axes), self.recipe, run.params[i], run.gravity_body[i], 0.7)
            (x, y), wide, high = scene.com, 1.75 * self.reach, 1.45 * self.reach
            axes.set(xlim=(x - wide, x + wide), ylim=(y - high, y + high))
            tip = angle(math.degrees(float(run.channels["tip_angle"][i])))
            title.set_text(f"{plain(name)}: {'tips over' if run.tips[i] else f'stands, {tip}'}")
            title.set_color(colours().red if run.tips[i] else colours().ink)
        for cursor in self.cursors:
            cursor.set_xdata([float(self.path.distance[i])] * 2)

"""Animation: a robot on its way over terrain, beside the same robot without control.

Owns what moves from frame to frame and how frames become a GIF or an MP4.  The picture is laid out
once; the robots are drawn in the world's frame, so that the ground under them slopes and gravity
points down the page.
"""

import io
import math
import os
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from subprocess import CalledProcessError
from typing import Any

import numpy as np
from matplotlib.animation import FFMpegWriter
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from numpy.typing import NDArray
from PIL import Image

from lutgen.analysis import Diagnosis, Posture, diagnose
from lutgen.errors import InputError
from lutgen.files import write_bytes
from lutgen.plot.box import box_axes, set_limits
from lutgen.plot.ground import eye, lay
from lutgen.plot.labels import angle_text, unit_label
from lutgen.plot.palette import BLUE, GREEN, GREY, RED
from lutgen.plot.path import draw_angles
from lutgen.plot.robot import rims
from lutgen.plot.shape import shape_of
from lutgen.plot.style import house_style, known_suffix, new_figure
from lutgen.recipe import Recipe
from lutgen.search import Drive

Floats = NDArray[np.float64]

# Bounds the time and the size of the file, whatever the path.
MOST_FRAMES = 60
# Seconds: the length of a film, and the shortest and longest time of a frame.
LENGTH, SHORTEST, LONGEST = 7.2, 0.12, 0.5
COLOURS = 64
RESOLUTION = 100
# Of ffmpeg: no dates and versions, but our mark (lutgen/files.py).
EXACTLY = ["-fflags", "+bitexact", "-metadata", "comment=lutgen"]
# Inches.  Both sides are whole even numbers of dots, which films need.
WIDTH, HEIGHT = 6.4, 4.5
ELEVATION, AZIMUTH = 28.0, -66.0
DOWN = (0.0, 0.0, -1.0)
EARTH = "#dcdcdc"


def check_animation(path: str | os.PathLike[str]) -> None:
    """Refuse a name of a kind that cannot be written here.

    Raises
    ------
    InputError
        For other suffixes than .gif and .mp4, and for .mp4 where there is no ffmpeg.
    """
    if known_suffix(path, "film", (".gif", ".mp4")) == ".mp4" and not FFMpegWriter.isAvailable():
        raise InputError(
            f"{path}: an MP4 needs the program ffmpeg (got none on the path); install it, or end "
            "the name in .gif."
        )


def animate(
    recipe: Recipe, runs: Mapping[str, Drive], path: str | os.PathLike[str], force: bool = False
) -> int:
    """Write a film of one or two runs along the same path.

    Parameters
    ----------
    recipe : Recipe
        The robot.
    runs : mapping of str to Drive
        One or two; the name of each is its title.
    path : str or path
        Ends in .gif, or in .mp4 where ffmpeg is installed.  The same runs give the same bytes of a
        GIF.
    force : bool
        Whether a file that lutgen did not make may be replaced.

    Returns
    -------
    int
        Number of frames, at most `MOST_FRAMES`, evenly spread over the points of the path.

    Raises
    ------
    InputError
        As `check_animation`; where the file cannot be written, and where ffmpeg fails.
    """
    check_animation(path)
    drawn = dict(list(runs.items())[:2])
    points = len(next(iter(drawn.values())).path.position)
    count = min(points, MOST_FRAMES)
    at = np.linspace(0, points - 1, count).round().astype(int)
    pause = min(max(LENGTH / count, SHORTEST), LONGEST)
    with house_style():
        film = _Film(recipe, drawn)
        frames = (film.frame(int(i)) for i in at)
        gif = Path(path).suffix.lower() == ".gif"
        content = _gif(frames, pause) if gif else _mp4(film.figure, frames, pause, path)
    write_bytes(path, content, force=force)
    return count


def _gif(frames: Iterator[Floats], pause: float) -> bytes:
    """Return frames (height, width, 3) uint8 as a GIF that repeats."""
    pictures = list(frames)
    # One palette for all, so that colours do not flicker.
    some = [pictures[i] for i in sorted({0, len(pictures) // 2, len(pictures) - 1})]
    joined = Image.fromarray(np.concatenate(some))
    palette = joined.quantize(COLOURS, method=Image.Quantize.MAXCOVERAGE)
    few = [Image.fromarray(p).quantize(palette=palette, dither=Image.Dither.NONE) for p in pictures]
    out = io.BytesIO()
    duration = round(1000.0 * pause)
    few[0].save(
        out,
        format="GIF",
        save_all=True,
        append_images=few[1:],
        duration=duration,
        loop=0,
        comment=b"lutgen",
    )
    return out.getvalue()


def _mp4(
    figure: Figure, frames: Iterator[Floats], pause: float, path: str | os.PathLike[str]
) -> bytes:
    """Return a film that ffmpeg made of the frames."""
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "film.mp4"
        writer = FFMpegWriter(fps=1.0 / pause, extra_args=EXACTLY)  # type: ignore[arg-type]
        try:
            with writer.saving(figure, str(target), RESOLUTION):
                for _ in frames:
                    writer.grab_frame()
            return target.read_bytes()
        except (CalledProcessError, OSError) as error:
            raise InputError(
                f"{path}: ffmpeg made no film (got {type(error).__name__}); end the name in .gif."
            ) from error


class _Film:
    """The picture: a box for each run above strips of the terrain and of the tip-over angles."""

    def __init__(self, recipe: Recipe, runs: dict[str, Drive]) -> None:
        self.figure = new_figure((WIDTH, HEIGHT))
        self.figure.set_dpi(RESOLUTION)
        self.figure.set_layout_engine("none")
        last = list(runs.values())[-1]
        share = 1.0 / len(runs)
        self.robots = [
            _Robot(self.figure, i * share, share, recipe, name, run)
            for i, (name, run) in enumerate(runs.items())
        ]
        self.path = last.path
        strips = [self.figure.add_axes((0.1, low, 0.88, 0.14)) for low in (0.265, 0.1)]
        for axes in strips:
            axes.set_xlim(0.0, float(self.path.distance[-1]))
            axes.yaxis.set_major_locator(MaxNLocator(3))
            axes.yaxis.set_label_coords(-0.065, 0.5)
        self.dot = _terrain(strips[0], recipe, last)
        draw_angles(strips[1], runs)
        strips[1].set_xlabel(unit_label("path length", recipe.length_unit))
        self.cursors = [axes.axvline(0.0, color="black", linewidth=0.8) for axes in strips]

    def frame(self, i: int) -> Any:
        """Return the picture at point i, (height, width, 3) uint8."""
        for robot in self.robots:
            robot.move(i)
        here, height = float(self.path.distance[i]), float(self.path.position[i, 2])
        for cursor in self.cursors:
            cursor.set_xdata([here, here])
        self.dot.set_data([here], [height])
        canvas: Any = self.figure.canvas
        canvas.draw()
        return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _terrain(axes: Axes, recipe: Recipe, run: Drive) -> Line2D:
    """Draw the height of the path, and return the dot that is the robot."""
    z = run.path.position[:, 2]
    room = max(float(np.ptp(z)), 1e-9)
    axes.fill_between(run.path.distance, z, z.min() - room, facecolor=EARTH, linewidth=0.0)
    axes.plot(run.path.distance, z, color="black", linewidth=0.8)
    label = unit_label("height", recipe.length_unit).replace(" (", "\n(")
    axes.set(ylim=(z.min() - 0.2 * room, z.max() + 0.3 * room), ylabel=label)
    axes.tick_params(labelbottom=False)
    (dot,) = axes.plot([], [], "o", color="black", markersize=4.5, zorder=6)
    return dot


class _Robot:
    """One robot on the ground, the com in the middle of the box."""

    def __init__(
        self, figure: Figure, left: float, share: float, recipe: Recipe, name: str, run: Drive
    ) -> None:
        self.recipe, self.run, self.name = recipe, run, name
        self.travel = _travel(run)
        # Where contacts are does not depend on gravity.
        states = [
            diagnose(Posture(recipe, params), DOWN)
            for params in (run.params[0], run.params.min(axis=0), run.params.max(axis=0))
        ]
        self.reach = max(
            float((np.linalg.norm(s.centres, axis=1) + s.radius).max()) for s in states
        )
        chord = run.path.position[-1] - run.path.position[0]
        yaw = math.degrees(math.atan2(chord[1], chord[0]))
        axes = box_axes(figure, ELEVATION, yaw + AZIMUTH)
        self.eye = eye(ELEVATION, yaw + AZIMUTH)
        axes.set_axis_off()
        axes.set_position((left, 0.4, share, 0.56))
        half = np.full(3, 1.15 * self.reach)
        set_limits(axes, -half, half)
        axes.set_box_aspect((1.0, 1.0, 1.0), zoom=1.25)
        axes.patch.set_visible(False)
        self.title = figure.text(left + 0.02, 0.985, name, va="top")
        self.ground = Poly3DCollection([], linewidth=0.5)
        self.support = Poly3DCollection([], facecolor=GREEN, alpha=0.35, edgecolor="none")
        self.wheels = Line3DCollection([], colors=GREY, linewidths=1.2)
        self.body = Line3DCollection([], colors="black", linewidths=1.1)
        parts = (self.ground, self.support, self.wheels, self.body)
        for order, part in enumerate(parts, 1):
            part.set_zorder(order)
            # A steep ground may leave the box; the strips below lie on top of it.
            part.set_clip_on(False)
            axes.add_collection3d(part, autolim=False)
        (self.com,) = axes.plot([0.0], [0.0], [0.0], "o", color="black", markersize=4.5, zorder=8)
        (self.plumb,) = axes.plot([], [], [], linewidth=1.2, zorder=7)

    def move(self, i: int) -> None:
        """Put the robot at point i."""
        state = diagnose(Posture(self.recipe, self.run.params[i]), self.run.gravity_body[i])
        turn = to_world(self.run.gravity_body[i], float(self.run.heading[i]))
        tips = bool(self.run.tips[i])
        shape = shape_of(self.recipe, self.run.params[i])
        outlines = [np.concatenate([face, face[:1]]) for face in shape.faces]
        self.body.set_segments([part @ turn.T for part in (*shape.bones, *shape.belts, *outlines)])
        self.wheels.set_segments(
            [rim @ turn.T for i in range(len(state.kind)) for rim in rims(state, i)]
        )
        colour = RED if tips else "black"
        self.body.set_color(colour)
        self.com.set_color(colour)
        self._stand(state, turn, i, tips)
        angle = angle_text(math.degrees(float(self.run.channels["tip_angle"][i])))
        self.title.set_text(f"{self.name}: {'tips over' if tips else 'stands'}, {angle}")
        self.title.set_color(colour)

    def _stand(self, state: Diagnosis, turn: Floats, i: int, tips: bool) -> None:
        """Draw the ground under the robot, its support polygon and the plumb line."""
        normal, height = np.array(DOWN), self.reach
        corners: list[Floats] = []
        if state.facet is not None:
            normal, height = turn @ state.facet.normal, state.facet.height
            corners = [state.facet.points @ turn.T]
        self.support.set_verts(corners)
        self.support.set_facecolor(RED if tips else GREEN)
        foot = height * normal
        along = _across(self.travel[i], normal)
        if np.linalg.norm(along) < 1e-9:
            # The robot stands with its back to a wall that the path climbs.
            along = _across(np.eye(3)[int(np.abs(normal).argmin())], normal)
        along /= np.linalg.norm(along)
        across = np.cross(normal, along)
        place = np.stack([foot, along, across, normal])
        lay(self.ground, place, self.reach, float(self.run.path.distance[i]), self.eye)
        # Down from the com to the ground, or as far as the box goes on a wall.
        rate, furthest = -float(normal[2]), 1.3 * self.reach
        length = min(height / rate, furthest) if rate > 0.0 else furthest
        self.plumb.set_data_3d([0.0, 0.0], [0.0, 0.0], [0.0, -length])
        self.plumb.set_color(RED if tips else BLUE)


def _across(vector: Floats, normal: Floats) -> Floats:
    """Return the part of a vector that is orthogonal to a unit normal."""
    return np.asarray(vector - (vector @ normal) * normal)


def _travel(run: Drive) -> Floats:
    """Return the direction of the path at each point, world frame, (p, 3), unit."""
    slope = np.gradient(run.path.position, run.path.distance, axis=0)
    length = np.linalg.norm(slope, axis=1, keepdims=True)
    return np.asarray(np.where(length > 1e-9, slope / np.maximum(length, 1e-9), [1.0, 0.0, 0.0]))


def to_world(gravity: Floats, heading: float) -> Floats:
    """Return the rotation (3, 3) from the body to the world: gravity down, x to its heading."""
    up = -gravity
    ahead = np.array([1.0, 0.0, 0.0]) - up[0] * up
    if np.linalg.norm(ahead) < 1e-9:
        # The nose points straight up or down: the body's own z axis tells what is ahead.
        ahead = np.array([0.0, 0.0, -up[0]])
    ahead /= np.linalg.norm(ahead)
    level = np.stack([ahead, np.cross(up, ahead), up])
    cos, sin = math.cos(heading), math.sin(heading)
    return np.asarray(np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]) @ level)

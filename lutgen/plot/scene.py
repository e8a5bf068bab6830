"""Scene: a robot on its ground, what it stands on, where it goes over, and labels beside it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from numpy.typing import ArrayLike
from scipy.spatial import ConvexHull

from lutgen.analysis import Diagnosis, Facet, Posture, diagnose
from lutgen.chart import STANDARD_GRAVITY
from lutgen.plot.labels import angle, counted, gravity_text, named
from lutgen.plot.painter import Camera, Solid, arrow, com_mark, frame_of, newell, paint
from lutgen.plot.solids import solids_of
from lutgen.plot.style import bare, colours, new_figure
from lutgen.plot.view import View
from lutgen.quantities import QUANTITIES
from lutgen.recipe import Recipe
from lutgen.vector import Floats

# Words of a label, its place on the paper and its colour.
Label = tuple[str, Floats, str]

AZIMUTH, ELEVATION = -58.0, 24.0
# Room before and beside the robot, and the thickness of the ground, in sizes of the robot.
AHEAD, ASIDE, THICK = 0.10, 0.16, 0.03
# D_g farther off than this, in sizes of the robot, leaves the picture.
FAR = 1.2
# Inches: the width of the picture between the labels, its greatest height, and the room below it.
WIDE, TALLEST, BELOW = 4.3, 4.6, 0.25


@dataclass
class Scene:
    """A drawn robot: its state, its camera, and places on the paper, (2,) each.

    `red` is on the edge over which it tips first, `support` a corner of its support polygon;
    `low` and `high` are the corners of the picture.
    """

    state: Diagnosis
    camera: Camera
    size: float
    com: Floats
    hit: Floats
    low: Floats
    high: Floats
    support: Floats | None = None
    red: Floats | None = None
    force: Floats | None = None


def draw_scene(
    axes: Axes, recipe: Recipe, params: ArrayLike, gravity_dir: Floats, line: float = 1.0
) -> Scene:
    """Draw a posture (k,), rad or length, under gravity (3,) in its body frame.

    `line` scales all lines.  The axes get limits around the picture.
    """
    state = diagnose(Posture(recipe, np.asarray(params, np.float64)), gravity_dir)
    camera = Camera(AZIMUTH, ELEVATION, frame_of(-state.gravity_dir))
    solids = solids_of(recipe, params)
    points = np.concatenate([solid.points for solid in solids])
    size = float(np.ptp(points, axis=0).max())
    near = bool(np.linalg.norm(state.pierced) <= FAR * size)
    end = state.pierced if near else 0.5 * size * state.gravity_dir
    com, hit = camera.flat(np.array([np.zeros(3), end]))
    flat = [camera.flat(points), com[None], hit[None]]
    scene = Scene(state, camera, size, com, hit, com, com)
    if state.facet is not None:
        flat += _ground(axes, solids, state.facet, scene)
        _support(axes, state.facet, scene, line)
    paint(axes, solids, camera, 0.7 * line, 3.0)
    arrow(axes, com, hit, colours().ink, line)
    com_mark(axes, com, 0.026 * size, 8.0)
    if recipe.com_uncertainty > 0.0:
        ball = Circle((com[0], com[1]), recipe.com_uncertainty, fill=False, linestyle=":")
        axes.add_patch(ball).set(edgecolor=colours().ink, zorder=8.3)
    weight = STANDARD_GRAVITY * sum(link.mass for link in recipe.links)
    starts = state.posture.placed.force_points[0]
    for start, force in zip(starts, recipe.forces, strict=True):
        if any(force.force):
            # The weight would be as long as the robot.
            ends = camera.flat(np.array([start, start + size / weight * np.array(force.force)]))
            arrow(axes, ends[0], ends[1], colours().red, line)
            scene.force = ends.mean(axis=0)
            flat.append(ends)
    everything = np.concatenate(flat)
    scene.low, scene.high = everything.min(axis=0), everything.max(axis=0)
    pad = 0.02 * (scene.high - scene.low)
    low, high = scene.low - pad, scene.high + pad
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    return scene


def _ground(axes: Axes, solids: Sequence[Solid], facet: Facet, scene: Scene) -> list[Floats]:
    """Draw the ground, as a wedge if it slopes, and shadows; return its corners on the paper."""
    look, up, camera, size = colours(), -facet.normal, scene.camera, scene.size
    frame, foot = frame_of(up), facet.points[0]
    spots = np.concatenate([solid.points for solid in solids] + [facet.points]) - foot
    room = size * np.array([AHEAD, ASIDE])
    low, high = (spots @ frame[:2].T).min(axis=0) - room, (spots @ frame[:2].T).max(axis=0) + room
    square = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
    corners = foot + square @ frame[:2]
    height = corners @ camera.turn[2]
    base = corners + np.outer(height.min() - THICK * size - height, camera.turn[2])
    for i in range(4):
        quad = np.array([corners[i - 1], corners[i], base[i], base[i - 1]])
        normal = newell(quad)
        normal *= np.sign(normal @ (quad.mean(axis=0) - corners.mean(axis=0)))
        if normal @ camera.look > 1e-9:
            side = Polygon(camera.flat(quad), facecolor=camera.shade(look.slab, normal))
            axes.add_patch(side).set(edgecolor=look.faint, linewidth=0.6, zorder=0.5)
    top = Polygon(camera.flat(corners), facecolor=look.wash, edgecolor=look.faint, linewidth=0.8)
    axes.add_patch(top).set_zorder(1.0)
    # The ground is not seen from below.
    for solid in solids if up @ camera.look > 1e-3 else ():
        spot = camera.flat(solid.points - np.outer((solid.points - foot) @ up, up))
        hull = spot[ConvexHull(spot, qhull_options="QJ").vertices]
        axes.add_patch(Polygon(hull, facecolor=look.faint, edgecolor="none", zorder=1.1))
    return [camera.flat(corners), camera.flat(base)]


def _support(axes: Axes, facet: Facet, scene: Scene, line: float) -> None:
    """Draw the support polygon, and in red the edge over which the robot tips first."""
    look, state = colours(), scene.state
    polygon = scene.camera.flat(facet.points)
    axes.add_patch(Polygon(polygon, facecolor=look.blue, alpha=0.38, edgecolor="none", zorder=2))
    (edge,) = axes.plot(*np.vstack([polygon, polygon[:1]]).T, color=look.blue, linewidth=1.6 * line)
    edge.set(linestyle=(0, (2.2, 1.6)), zorder=6)
    (dots,) = axes.plot(*polygon.T, "o", color=look.blue, markersize=4.5 * line, zorder=7)
    dots.set(markeredgecolor=look.paper, markeredgewidth=0.8 * line)
    scene.support = polygon[0]
    if state.least_stable is not None:
        tip = state.tip_over_axes[state.least_stable]
        red = scene.camera.flat(np.array([tip.start, tip.stop]))
        (edge,) = axes.plot(*red.T, color=look.red, linewidth=4.0 * line, zorder=7.5)
        edge.set_solid_capstyle("round")
        first, second = red if red[0][0] < red[1][0] else red[::-1]
        scene.red = 0.75 * first + 0.25 * second
        away = np.linalg.norm(polygon - red.mean(axis=0), axis=1)
        scene.support = polygon[int(np.argmax(away - 0.5 * polygon[:, 1]))]


def callouts(axes: Axes, labels: Sequence[Label], scene: Scene) -> None:
    """Write labels in two columns beside a picture, with a line to each place."""
    labels = sorted(labels, key=lambda label: float(label[1][0]))
    low, high, half = scene.low, scene.high, len(labels) // 2
    wide = float((high - low)[0])
    gap = 0.05 * wide
    for side, here in ((-1, labels[:half]), (1, labels[half:])):
        edge = high[0] + 0.03 * wide if side > 0 else low[0] - 0.03 * wide
        y, above = float(high[1]) + gap, 0.0
        for words, place, colour in sorted(here, key=lambda label: -float(label[1][1])):
            tall = 0.5 * gap * (1 + words.count("\n"))
            y = min(float(place[1]) + 0.05 * wide, y - above - tall - 0.5 * gap)
            above = tall
            line = ([edge, edge - side * 0.04 * wide, place[0]], [y, y, place[1]])
            look: dict[str, Any] = {"clip_on": False, "markeredgecolor": colours().paper}
            axes.plot(*line, color=colours().paper, lw=2.6, alpha=0.8, zorder=7.0, **look)
            axes.plot(*line, color=colour, lw=0.9, zorder=7.1, **look)
            if place is not scene.com:
                axes.plot(*place, "o", color=colour, ms=3.2, mew=0.6, zorder=9.1, **look)
            text = axes.text(edge + side * 0.012 * wide, y, words, color=colour, va="center")
            text.set(ha="left" if side > 0 else "right", zorder=10, linespacing=1.25)


def draw_robot(view: View) -> Figure:
    """Return the figure."""
    down = view.down(view.params)
    # Its height follows from the robot, so the robot is drawn once beforehand.
    probe = draw_scene(bare(new_figure((1.0, 1.0)).add_subplot()), view.recipe, view.params, down)
    across, up = probe.high - probe.low
    tall = min(WIDE * up / across, TALLEST)
    box = ((8.0 - WIDE) / 2.0, BELOW, WIDE, tall)
    note = named(view.recipe, view.params, (), gravity_text(view.gravity_dir, view.convention))
    figure, axes = view.page(tall + BELOW, box, _verdict(probe.state), note)
    scene = draw_scene(bare(axes), view.recipe, view.params, down)
    state, look = scene.state, colours()
    labels: list[Label] = [("centre of mass", scene.com, look.ink)]
    if scene.support is not None:
        words = "stands on" if state.standing else "would stand on"
        labels.append((f"{words}\n{_carrying(state)}", scene.support, look.blue))
    if scene.red is not None:
        tip = math.degrees(state.channels["tip_angle"])
        words = f"tips over this\nedge first,\nafter {angle(tip)}"
        labels.append((words if tip >= 0.0 else "tips over\nthis edge", scene.red, look.red))
    labels.append(("gravity", 0.3 * scene.com + 0.7 * scene.hit, look.ink))
    if scene.force is not None:
        labels.append(("force", scene.force, look.red))
    callouts(axes, labels, scene)
    return figure


def _verdict(state: Diagnosis) -> str:
    tip = math.degrees(state.channels["tip_angle"])
    if abs(tip) > 179.99:
        return "It never tips over" if state.standing else "It has nothing to stand on"
    if not state.standing:
        return f"Tips over: it leans {angle(math.ceil(-tip))} too far"
    rocks = QUANTITIES["status"].word(state.channels["status"]) == "rocks"
    words = "Rocks between its contacts" if rocks else f"Stands on {_carrying(state)}"
    return f"{words}, {angle(tip)} from tipping over"


def _carrying(state: Diagnosis) -> str:
    corners = dict.fromkeys(state.facet.contacts if state.facet is not None else ())
    return counted([state.posture.recipe.contacts[i].kind for i in corners])

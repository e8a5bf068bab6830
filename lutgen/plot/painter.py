"""Painter: prisms in parallel projection, painted from the back to the front.

The order is exact for convex solids that are apart: one of two that overlap on the paper lies
behind the plane of a face.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.patches import Circle, Polygon, Wedge

from lutgen.plot.style import BLACK, colours
from lutgen.vector import Floats

# Parts of a solid that stick into another one by no more do not overlap.
TOUCH = 1e-6


def newell(face: Floats) -> Floats:
    """Return a polygon's unit normal, (3,)."""
    normal = np.cross(face, np.roll(face, -1, axis=0)).sum(axis=0)
    return np.asarray(normal / max(float(np.linalg.norm(normal)), 1e-300))


def circle(centre: Floats, axis: Floats, radius: float, corners: int = 36) -> Floats:
    """Return points (corners, 3) of a circle around a unit axis."""
    across = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    across /= np.linalg.norm(across)
    turn = np.linspace(0.0, 2.0 * np.pi, corners, endpoint=False)[:, None]
    rim = np.cos(turn) * across + np.sin(turn) * np.cross(axis, across)
    return np.asarray(centre + radius * rim)


def frame_of(up: Floats) -> Floats:
    """Return the rotation (3, 3) into a frame whose z is `up` and whose x is ahead."""
    ahead = np.array([1.0, 0.0, 0.0]) - up[0] * up
    if np.linalg.norm(ahead) < 1e-9:
        # The nose points straight up or down: the z axis of the body is ahead.
        ahead = np.array([0.0, 0.0, -up[0]])
    ahead /= np.linalg.norm(ahead)
    return np.stack([ahead, np.cross(up, ahead), up])


class Solid:
    """A prism between `outline` (k, 3) and `outline + along`.

    Edges between the sides of a `hard` one are drawn; `hubs` are circles on its ends: the centre
    on the first end, and the radius.
    """

    def __init__(
        self, outline: Floats, along: Floats, colour: str, hard: bool = False, hubs: Any = ()
    ) -> None:
        self.outline, self.along, self.colour = outline, along, colour
        self.hard, self.hubs = hard, hubs
        near, far = outline, outline + along
        self.points = np.concatenate([near, far])
        before = np.roll(np.arange(len(near)), 1)
        sides = np.stack([near[before], near, far, far[before]], axis=1)
        self.faces: list[Floats] = [near, far, *sides]
        normals = np.array([newell(face) for face in self.faces])
        centres = np.array([face.mean(axis=0) for face in self.faces])
        out = ((centres - self.points.mean(axis=0)) * normals).sum(axis=1) > 0.0
        self.normals = np.where(out[:, None], normals, -normals)
        self.offsets = (self.normals * centres).sum(axis=1)


def tube(start: Floats, stop: Floats, radius: float, colour: str) -> Solid:
    """Return a round bar."""
    along = stop - start
    return Solid(circle(start, along / np.linalg.norm(along), radius, 20), along, colour)


def box(low: Any, high: Any, colour: str, turn: Floats, at: Floats) -> Solid:
    """Return a box between two corners, turned and moved."""
    (x, y, z), (u, v, w) = low, high
    base = np.array([[x, y, z], [u, y, z], [u, v, z], [x, v, z]])
    return Solid(base @ turn.T + at, turn @ np.array([0.0, 0.0, w - z]), colour, hard=True)


class Camera:
    """A parallel projection of the body frame onto the paper.

    `azimuth` and `elevation` (deg) are those of the eye in the world, `turn` (3, 3) rotates the
    body into the world.
    """

    def __init__(self, azimuth: float, elevation: float, turn: Floats) -> None:
        a, e = np.radians([azimuth, elevation])
        towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        right = np.array([-np.sin(a), np.cos(a), 0.0])
        self.basis = np.array([right, np.cross(towards, right)])
        light = -0.45 * self.basis[0] + 0.75 * self.basis[1] + 0.55 * towards
        self.light = turn.T @ light / np.linalg.norm(light)
        self.turn, self.look = turn, turn.T @ towards

    def flat(self, points: Floats) -> Floats:
        """Return where points (k, 3) or one (3,) of the body are on the paper, (k, 2)."""
        return np.asarray(np.atleast_2d(points) @ self.turn.T @ self.basis.T)

    def shade(self, colour: str, normal: Floats) -> tuple[float, ...]:
        """Return the colour of a face in the light."""
        bright = 0.70 + 0.36 * max(float(normal @ self.light), 0.0)
        rgb = np.array(to_rgb(colour))
        return tuple(np.clip(rgb * bright if bright < 1 else 1 - (1 - rgb) * (2 - bright), 0, 1))


def is_behind(one: Solid, other: Solid, look: Floats) -> bool:
    """Return True if a solid is painted before another one."""
    near = TOUCH * max(float(np.ptp(one.points)), float(np.ptp(other.points)))
    for a, b, answer in ((one, other, True), (other, one, False)):
        beyond = (a.normals @ b.points.T).min(axis=1) - a.offsets > -near
        facing = a.normals @ look
        if (beyond & (np.abs(facing) > 1e-6)).any():
            return answer if (beyond & (facing > 1e-6)).any() else not answer
    return bool((one.points.mean(axis=0) - other.points.mean(axis=0)) @ look < 0.0)


def from_the_back(solids: Sequence[Solid], camera: Camera) -> list[Solid]:
    """Return the solids in the order in which they are painted."""
    flats = [camera.flat(solid.points) for solid in solids]
    depth = [float(solid.points.mean(axis=0) @ camera.look) for solid in solids]
    before: dict[int, set[int]] = {i: set() for i in range(len(solids))}
    for i in range(len(solids)):
        for j in range(i):
            apart = (flats[i].max(0) < flats[j].min(0)) | (flats[j].max(0) < flats[i].min(0))
            if not apart.any():
                first = is_behind(solids[i], solids[j], camera.look)
                before[j if first else i].add(i if first else j)
    order, left = [], set(before)
    while left:
        free = [i for i in left if not before[i] & left] or list(left)
        pick = min(free, key=lambda i: (depth[i], i))
        order.append(solids[pick])
        left.remove(pick)
    return order


def paint(axes: Axes, solids: Sequence[Solid], camera: Camera, width: float, z: float) -> None:
    """Draw solids from `z` up; a later one covers an earlier one.  The axes keep their limits."""
    for n, solid in enumerate(from_the_back(solids, camera)):
        here = z + n / (len(solids) + 1.0)
        seen = solid.normals @ camera.look > 1e-9
        for face, normal, visible in zip(solid.faces, solid.normals, seen, strict=True):
            if visible:
                colour = camera.shade(solid.colour, normal)
                flat = Polygon(camera.flat(face), facecolor=colour, edgecolor=colour, linewidth=0.5)
                axes.add_artist(flat).set_zorder(here)
        near, far = camera.flat(solid.outline), camera.flat(solid.outline + solid.along)
        lines, sides = [], seen[2:]
        for i in range(len(near)):
            after = sides[(i + 1) % len(near)]
            lines += [near[[i - 1, i]]] if seen[0] or sides[i] else []
            lines += [far[[i - 1, i]]] if seen[1] or sides[i] else []
            if sides[i] != after or (solid.hard and (sides[i] or after)):
                lines.append(np.stack([near[i], far[i]]))
        edges = LineCollection(lines, colors=colours().edge, linewidths=width, zorder=here)
        axes.add_collection(edges, autolim=False).set_capstyle("round")
        end = 0 if seen[0] else 1
        for centre, radius in solid.hubs if seen[end] else ():
            axis = solid.along / np.linalg.norm(solid.along)
            ring = camera.flat(circle(centre + end * solid.along, axis, radius))
            fill = camera.shade(colours().body, solid.normals[end])
            hub = Polygon(ring, facecolor=fill, edgecolor=colours().edge, linewidth=0.6 * width)
            axes.add_artist(hub).set_zorder(here)


def com_mark(axes: Axes, at: Floats, radius: float, z: float) -> None:
    """Draw the sign of a centre of mass."""
    spot = (float(at[0]), float(at[1]))
    rim = Circle(spot, radius, facecolor="white", edgecolor=BLACK, linewidth=1.2, zorder=z)
    axes.add_patch(rim)
    for start in (0, 180):
        axes.add_patch(Wedge(spot, radius, start, start + 90, facecolor=BLACK, zorder=z + 0.1))


def arrow(axes: Axes, start: Floats, stop: Floats, colour: str, line: float) -> None:
    """Draw an arrow on the paper; `line` scales its width and its head."""
    part = 0.15 * start + 0.85 * stop
    axes.plot(*np.transpose([start, part]), color=colours().paper, lw=4.2 * line, zorder=7.6)
    head, look = math.sqrt(line), {"color": colour, "linewidth": 1.8 * line}
    look["arrowstyle"] = f"-|>,head_width={0.28 * head:g},head_length={0.5 * head:g}"
    arrow = {"shrinkA": 0, "shrinkB": 0, **look}
    axes.annotate("", (stop[0], stop[1]), (start[0], start[1]), arrowprops=arrow, zorder=7.7)

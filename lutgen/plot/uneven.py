"""Footing: feet on uneven ground from the side and along gravity, and where the com may lie."""

import math
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from lutgen.analysis import Equilibrium, Footing
from lutgen.chart import unit_directions
from lutgen.plot.labels import measured, number, unit_label
from lutgen.plot.legend import add_legend
from lutgen.plot.marks import write_beside
from lutgen.plot.palette import BLUE, GREEN, GREY, ORANGE, SKY
from lutgen.plot.style import in_house_style, new_figure

Floats = NDArray[np.float64]

# Inches: a column of a journal, what its labels take across and down, and the tallest figure.
COLUMN, ACROSS, DOWN, TALLEST = 3.5, 0.6, 1.75, 6.5
# Cones, normals, the ground and the longest force, over the larger side of the picture.
CONE, NORMAL, GROUND, FORCE = 0.14, 0.12, 0.07, 0.22
ROOM = 0.16
# Regions farther out than this, in sides of the feet's box, leave the picture.
FAR = 1.0
SAID = {True: "holds", False: "does not hold", None: "undecided"}
REGION: dict[str, Any] = {"facecolor": SKY, "alpha": 0.35}
EDGE: dict[str, Any] = {"color": BLUE, "linewidth": 1.2}
CONES: dict[str, Any] = {"facecolor": ORANGE, "alpha": 0.25, "linewidth": 0.0}
NORMALS: dict[str, Any] = {"color": ORANGE, "linewidth": 0.9}
PULL: dict[str, Any] = {"color": GREEN, "linewidth": 1.3}
FOOT: dict[str, Any] = {"linestyle": "none", "marker": "o", "color": "black", "markersize": 3.5}
COM: dict[str, Any] = {
    **{"linestyle": "none", "marker": "o", "markersize": 6.0, "zorder": 8},
    **{"markerfacecolor": "white", "markeredgecolor": "black", "markeredgewidth": 1.0},
}
PLUMB: dict[str, Any] = {"color": "black", "linewidth": 0.6, "linestyle": (0, (4, 2)), "zorder": 1}


@in_house_style
def draw_footing(footing: Footing, found: Equilibrium) -> Figure:
    """Draw feet on uneven ground, their friction cones, and the region of the com.

    Parameters
    ----------
    footing : Footing
        The feet and the weight.
    found : Equilibrium
        What `Footing.equilibrium` says of them.

    Returns
    -------
    matplotlib.figure.Figure
        Above seen from the side, gravity down the page; below seen along gravity.  Both in one
        scale, lengths in the footing's unit.  Where the weight is held, with the forces.
    """
    # Ahead, left and up.
    frame = np.vstack([found.axes, np.cross(*found.axes)])
    feet, com = footing.points @ frame.T, frame @ footing.com
    low, high = _box(feet, com, found)
    width, depth, height = high - low
    scale = (COLUMN - ACROSS) / width
    figure = new_figure((COLUMN, min(DOWN + scale * (depth + height), TALLEST)))
    side, above = figure.subplots(2, 1, sharex=True, height_ratios=[height, depth])
    unit = footing.length_unit
    names = ("x", "y", "z") if np.allclose(frame, np.eye(3)) else ("ahead", "left", "up")
    x, y, z = (unit_label(name, unit) for name in names)
    side.set(ylabel=z, xlim=(low[0], high[0]), ylim=(low[2], high[2]))
    above.set(xlabel=x, ylabel=y, ylim=(low[1], high[1]))
    for axes, words in ((side, "(a) from the side"), (above, "(b) along gravity")):
        axes.set_aspect("equal")
        axes.set_title(words)
    words = SAID[found.holds]
    if math.isfinite(found.margin):
        margin = 0.0 if abs(found.margin) < 1e-9 * width else found.margin
        words += f", margin {measured(margin, [0.0, width], unit)}"
    figure.suptitle(f"{footing.title}: {words}", x=0.01, ha="left")
    length = float(max(width, depth, height))
    handles = [*_region(above, found)]
    normals = unit_directions(footing.normals) @ frame.T
    handles += _cones(side, feet, normals, footing.friction, length)
    handles += _normals(side, above, feet, normals, length)
    if found.forces is not None:
        handles += _forces(side, above, feet, found.forces @ frame.T, length)
    for axes, up in ((side, 2), (above, 1)):
        axes.plot(feet[:, 0], feet[:, up], zorder=7, **FOOT)
        axes.plot(com[[0]], com[[up]], **COM)
    side.plot(com[[0, 0]], [com[2], low[2]], **PLUMB)
    above.plot(com[[0, 0]], [com[1], high[1]], **PLUMB)
    handles += [
        Line2D([], [], label="foot", **FOOT),
        Line2D([], [], label="centre of mass", **COM),
    ]
    add_legend(figure, handles)
    figure.align_ylabels()
    _name(above, feet, com, footing.names, found)
    return figure


def _box(feet: Floats, com: Floats, found: Equilibrium) -> tuple[Floats, Floats]:
    """Return the lowest and highest (3,) of the picture: feet, com, and a region that is near."""
    points = np.vstack([feet, com])
    low, high = points.min(axis=0), points.max(axis=0)
    wide = float((high - low).max()) or 1.0
    if len(found.region):
        near = np.clip(found.region, low[:2] - FAR * wide, high[:2] + FAR * wide)
        low[:2] = np.minimum(low[:2], near.min(axis=0))
        high[:2] = np.maximum(high[:2], near.max(axis=0))
    room = ROOM * float((high - low).max()) or 1.0
    return low - room, high + room


def _region(above: Axes, found: Equilibrium) -> list[Artist]:
    """Draw where the com may lie: a polygon, a line, a point or nothing."""
    label = "com may lie here"
    if len(found.region) > 2:
        above.fill(*found.region.T, zorder=0.5, **REGION)
        above.plot(*np.vstack([found.region, found.region[:1]]).T, zorder=2, **EDGE)
        return [Patch(edgecolor=BLUE, label=label, **REGION)]
    if len(found.region) == 0:
        return []
    above.plot(*found.region.T, marker="|" if len(found.region) == 2 else "s", zorder=2, **EDGE)
    return [Line2D([], [], label=label, **EDGE)]


def _cones(
    side: Axes, feet: Floats, normals: Floats, friction: Floats, length: float
) -> list[Artist]:
    """Draw the friction cones from the side, and the ground that they stand on."""
    from scipy.spatial import ConvexHull

    around = np.linspace(0.0, 2.0 * math.pi, 60)
    for foot, normal, mu in zip(feet, normals, friction, strict=True):
        place, seen = foot[[0, 2]], normal[[0, 2]]
        # Ground that is seen face on has no line.
        if np.linalg.norm(seen) > 0.2:
            along = np.array([seen[1], -seen[0]]) / np.linalg.norm(seen)
            ends = place + np.outer([-1.0, 1.0], GROUND * length * along)
            side.plot(*ends.T, color=GREY, linewidth=2.2, solid_capstyle="butt", zorder=1.5)
        if mu <= 0.0:
            continue
        across = np.eye(3)[int(np.argmin(np.abs(normal)))]
        first = np.cross(normal, across) / np.linalg.norm(np.cross(normal, across))
        ring = np.outer(np.cos(around), first) + np.outer(np.sin(around), np.cross(normal, first))
        rim = (normal + mu * ring) / math.hypot(1.0, mu)
        outline = np.vstack([place, place + CONE * length * rim[:, [0, 2]]])
        side.fill(*outline[ConvexHull(outline).vertices].T, zorder=1, **CONES)
    words = "friction cone"
    if np.ptp(friction) == 0.0:
        words += rf" ($\mu$ = {number(float(friction[0]))})"
    return [Patch(label=words, **CONES)] if friction.any() else []


def _normals(side: Axes, above: Axes, feet: Floats, normals: Floats, length: float) -> list[Artist]:
    """Draw the contacts' normals in both views."""
    for axes, up in ((side, 2), (above, 1)):
        for foot, normal in zip(feet, normals, strict=True):
            ends = np.array([foot, foot + NORMAL * length * normal])
            axes.plot(ends[:, 0], ends[:, up], zorder=3, **NORMALS)
    return [Line2D([], [], label="normal of the ground", **NORMALS)]


def _forces(side: Axes, above: Axes, feet: Floats, forces: Floats, length: float) -> list[Artist]:
    """Draw one set of forces that carries the weight, as arrows away from the feet."""
    largest = float(np.linalg.norm(forces, axis=1).max())
    look = {"arrowstyle": "-|>", "shrinkA": 0.0, "shrinkB": 0.0, "mutation_scale": 6.0, **PULL}
    for axes, up in ((side, 2), (above, 1)):
        for foot, force in zip(feet, forces, strict=True):
            tip = foot + FORCE * length / largest * force
            # A head alone would say which way a force goes that is not there.
            if math.hypot(tip[0] - foot[0], tip[up] - foot[up]) > 0.02 * length:
                ends = {"xy": tip[[0, up]], "xytext": foot[[0, up]]}
                axes.annotate("", **ends, arrowprops=look, zorder=6)
    words = f"force, at most {number(largest)} of the weight"
    return [Line2D([], [], label=words, **PULL)]


def _name(
    above: Axes, feet: Floats, com: Floats, names: tuple[str, ...], found: Equilibrium
) -> None:
    """Write the feet's names beside them, off each other, the com and the region's sides."""
    above.figure.draw_without_rendering()  # type: ignore[union-attr]
    plumb = np.column_stack([np.full(40, com[0]), np.linspace(com[1], above.get_ylim()[1], 40)])
    covered = [above.transData.transform(part) for part in (feet[:, :2], plumb)]
    if len(found.region):
        corners = np.vstack([found.region, found.region[:1]])
        share = np.linspace(0.0, 1.0, 40)[:, None, None]
        line = corners[:-1] + share * (corners[1:] - corners[:-1])
        covered.append(above.transData.transform(line.reshape(-1, 2)))
    for foot, name in zip(feet, names, strict=True):
        write_beside(above, (foot[0], foot[1]), name.replace("_", " "), covered)

"""Robot: the body in 3-D with its support, its tip-over axes and the gravity ray."""

import math
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import (  # type: ignore[import-untyped]
    Line3DCollection,
    Poly3DCollection,
)
from numpy.typing import ArrayLike, NDArray

from lutgen.analysis import Diagnosis, Facet, Posture, diagnose
from lutgen.parts import KINDS
from lutgen.plot.box import box_axes, fit_box, place
from lutgen.plot.labels import angle_text, length_label, title, with_unit
from lutgen.plot.marks import write_beside
from lutgen.plot.style import BLUE, GREEN, GREY, ORANGE, PURPLE, new_figure
from lutgen.plot.view import View
from lutgen.support import DISC, SPHERE

__all__ = ["SIZE", "draw_robot", "rims"]

Floats = NDArray[np.float64]

SIZE = (3.5, 4.2)
# Contacts are named on the picture up to this many; more names would cover it.
NAMED = 6
ELEVATION, AZIMUTH = 20.0, -62.0
CORNERS = 49
# Letters of two contacts' names that fit on one line of the legend.
LONG_NAMES = 26


def draw_robot(view: View, size: tuple[float, float] | None) -> Figure:
    """Return the figure, in the body frame with the com as the origin."""
    state = diagnose(Posture(view.recipe, view.params), view.gravity_dir)
    figure = new_figure(size or SIZE)
    axes = box_axes(figure, ELEVATION, AZIMUTH)
    heading = title(view, gravity=True, more=_verdict(state))
    handles = [*_body(axes, state), *_load(axes, view, state)]
    handles += [*_support(axes, view, state), *_edges(axes, state)]
    sides = _frame(axes, view, state)
    fit_box(figure, axes, sides, heading, handles, size)
    if len(state.centres) <= NAMED:
        _name_contacts(axes, view, state)
    return figure


def _verdict(state: Diagnosis) -> str:
    """Return whether the robot stands, and by how much."""
    angle = math.degrees(state.channels["tip_angle"])
    if abs(angle) > 179.99:
        return "never tips over" if state.standing else "nothing to stand on"
    away = angle_text(abs(angle))
    return f"stands, {away} from tip-over" if state.standing else f"tips over, {away} too far"


def _name_contacts(axes: Any, view: View, state: Diagnosis) -> None:
    """Write the contacts' names beside them, clear of the lines."""
    ends = [(np.zeros(3), centre) for centre in state.centres]
    ends += [(np.asarray(axis.start), np.asarray(axis.stop)) for axis in state.tip_over_axes]
    if state.facet is not None:
        ends.append((np.zeros(3), np.asarray(state.pierced)))
    part = np.linspace(0.0, 1.0, 41)[:, None]
    lines = [place(axes, start + part * (stop - start))[1] for start, stop in ends]
    for name, centre in zip(view.recipe.contact_names, state.centres, strict=True):
        x, y = place(axes, centre[None, :])[0][0]
        write_beside(axes, float(x), float(y), name.replace("_", " "), lines)


def circle(centre: ArrayLike, axis: ArrayLike, radius: float) -> Floats:
    """Return (49, 3) points of a circle around a unit axis, the first and last the same."""
    normal = np.asarray(axis, dtype=np.float64)
    across = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    across /= np.linalg.norm(across)
    turn = np.linspace(0.0, 2.0 * math.pi, CORNERS)[:, None]
    rim = np.cos(turn) * across + np.sin(turn) * np.cross(normal, across)
    return np.asarray(centre + radius * rim, dtype=np.float64)


def rims(state: Diagnosis, index: int) -> list[Floats]:
    """Return the circles that show a contact, (49, 3) each: of a wheel one, of a ball three."""
    normals = {DISC: [state.disc_axes[index]], SPHERE: list(np.eye(3))}
    centre, radius = state.centres[index], float(state.radius[index])
    return [circle(centre, normal, radius) for normal in normals.get(int(state.kind[index]), [])]


def _body(axes: Any, state: Diagnosis) -> list[Artist]:
    """Draw the contacts and their links to the com."""
    for i, centre in enumerate(state.centres):
        _line(axes, np.zeros(3), centre, color="#a0a0a0", linewidth=0.8, zorder=2)
        found = rims(state, i)
        if not found:
            axes.plot(*centre[:, None], "o", color=GREY, markersize=3.5, zorder=6)
        elif state.kind[i] == DISC:
            wheel = Poly3DCollection(found, facecolor=(0.3, 0.3, 0.3, 0.12), edgecolor="none")
            axes.add_collection3d(wheel)
            axes.plot(*found[0].T, color=GREY, linewidth=0.8, zorder=3)
        else:
            axes.add_collection3d(Line3DCollection(found, colors=GREY, linewidths=0.6, zorder=3))
    # Small beside the ball in which it may lie.
    dot = 2.0 if state.com_uncertainty > 0.0 else 4.5
    axes.plot([0.0], [0.0], [0.0], "o", color="black", markersize=dot, zorder=8)
    kinds = sorted({f"{KINDS[int(kind)]}s" for kind in state.kind})
    hollow = GREY if kinds == ["points"] else "none"
    return [
        _sample("centre of mass", "o", "black", dot),
        _sample(f"contacts ({', '.join(kinds)})", "o", GREY, 4.5, hollow),
    ]


def _load(axes: Any, view: View, state: Diagnosis) -> list[Artist]:
    """Draw the ball in which the com lies, and the forces: the weight is as long as the robot."""
    handles: list[Artist] = []
    if state.com_uncertainty > 0.0:
        rims = [circle(np.zeros(3), normal, state.com_uncertainty) for normal in np.eye(3)]
        axes.add_collection3d(Line3DCollection(rims, colors="black", linewidths=0.5, zorder=8))
        words = f"com anywhere within {with_unit(state.com_uncertainty, view.recipe.length_unit)}"
        handles.append(Line2D([], [], color="black", linewidth=0.5, label=words))
    acting = np.linalg.norm(state.forces, axis=1) > 0.0
    for start, force in zip(state.force_points[acting], state.forces[acting], strict=True):
        _line(axes, np.zeros(3), start, color="#a0a0a0", linewidth=0.8, zorder=2)
        tip = _size(state) * force
        axes.quiver(*start, *tip, color=PURPLE, linewidth=1.6, arrow_length_ratio=0.25, zorder=9)
    if acting.any():
        handles.append(Line2D([], [], color=PURPLE, linewidth=1.6, label="force"))
    return handles


def _ray(state: Diagnosis, facet: Facet, far: bool) -> tuple[Floats, str]:
    """Return where the line that ends on the support at D_g begins, and what it is."""
    if len(state.forces) == 0 or far:
        return np.zeros(3), "gravity through the com"
    # Without a moment it begins at the com.
    reach = facet.height / float(facet.normal @ state.resultant)
    return state.pierced - reach * state.resultant, "weight and forces together"


def _support(axes: Any, view: View, state: Diagnosis) -> list[Artist]:
    """Draw gravity, the support polygon, its centre s, the pierced point D_g and |SD_g|."""
    facet = state.facet
    reach = 1.5 * _size(state)
    if facet is None:
        _arrow(axes, reach * state.gravity_dir)
        return [Line2D([], [], color="black", linewidth=1.0, label="gravity")]
    pierced = np.asarray(state.pierced)
    far = not np.isfinite(pierced).all() or np.linalg.norm(pierced) > reach
    start, what = _ray(state, facet, bool(far))
    _arrow(axes, reach * state.gravity_dir if far else pierced, start)
    polygon = Poly3DCollection([facet.points], facecolor=GREEN, alpha=0.25, edgecolor="none")
    axes.add_collection3d(polygon)
    polygon.set_zorder(1)
    axes.plot(*np.transpose(facet.points), "o", color=GREEN, markersize=3, zorder=6)
    axes.plot(*np.asarray(facet.centroid)[:, None], "s", color=BLUE, markersize=4, zorder=8)
    handles: list[Artist] = [
        Patch(facecolor=GREEN, alpha=0.3, label="support polygon"),
        _sample("its centre $s$", "s", BLUE, 4),
        Line2D([], [], color="black", linewidth=1.0, label=what),
    ]
    if not far:
        _line(axes, facet.centroid, pierced, color=BLUE, linewidth=1.8, zorder=7)
        axes.plot(*pierced[:, None], "D", color="black", markersize=3.5, zorder=8)
        span = float(np.linalg.norm(pierced - np.asarray(facet.centroid)))
        words = rf"$|SD_g|$ = {with_unit(span, view.recipe.length_unit)}"
        handles += [
            _sample("$D_g$, where it meets the support", "D", "black", 3.5),
            Line2D([], [], color=BLUE, linewidth=1.8, label=words),
        ]
    return handles


def _edges(axes: Any, state: Diagnosis) -> list[Artist]:
    """Draw the tip-over axes, the least stable one in colour."""
    handles: list[Artist] = []
    for index, axis in enumerate(state.tip_over_axes):
        if index != state.least_stable:
            _line(axes, axis.start, axis.stop, color="black", linewidth=0.9, zorder=4)
    if len(state.tip_over_axes) > 1:
        handles.append(Line2D([], [], color="black", linewidth=0.9, label="tip-over axes"))
    if state.least_stable is not None:
        axis = state.tip_over_axes[state.least_stable]
        _line(axes, axis.start, axis.stop, color=ORANGE, linewidth=2.0, zorder=5)
        angle = angle_text(math.degrees(axis.tip_angle))
        ends = list(dict.fromkeys(name.replace("_", " ") for name in axis.names))
        # Two long names take a line each.
        between = (" to " if len("".join(ends)) <= LONG_NAMES else " to\n").join(ends)
        words = f"least stable, {angle}:\n{between}"
        handles.append(Line2D([], [], color=ORANGE, linewidth=2.0, label=words))
    return handles


def _frame(axes: Any, view: View, state: Diagnosis) -> Floats:
    """Name the axes, give them room for everything drawn, and return their lengths, (3,)."""
    reach = state.radius[:, None]
    drawn = [np.zeros((1, 3)), state.centres - reach, state.centres + reach]
    if state.facet is not None:
        drawn.append(np.asarray(state.facet.points))
        pierced = np.asarray(state.pierced)
        if np.isfinite(pierced).all() and np.linalg.norm(pierced) <= 1.5 * _size(state):
            drawn.append(pierced[None, :])
    drawn += [state.force_points, state.force_points + _size(state) * state.forces]
    everything = np.concatenate(drawn)
    low, high = everything.min(axis=0), everything.max(axis=0)
    margin = 0.06 * float((high - low).max())
    low, high = low - margin, high + margin
    for index, (name, way) in enumerate((("x", "forward"), ("y", "left"), ("z", "up"))):
        axis = (axes.xaxis, axes.yaxis, axes.zaxis)[index]
        share = float((high - low)[index] / (high - low).max())
        axis.set_major_locator(MaxNLocator(max(2, round(5 * share)), steps=[1, 2, 5, 10]))
        axis.set_label_text(length_label(view.recipe, f"{name} {way}"))
        (axes.set_xlim, axes.set_ylim, axes.set_zlim)[index](low[index], high[index])
    return np.asarray(high - low)


def _size(state: Diagnosis) -> float:
    """Return the distance from the com to the furthest contact."""
    return float(np.linalg.norm(state.centres, axis=1).max() + state.radius.max())


def _line(axes: Any, start: ArrayLike, stop: ArrayLike, **style: Any) -> None:
    axes.plot(*np.transpose([start, stop]), **style)


def _arrow(axes: Any, tip: Floats, start: ArrayLike = (0.0, 0.0, 0.0)) -> None:
    """Draw the ray of gravity, by default from the com."""
    begin = np.asarray(start, dtype=np.float64)
    along = tip - begin
    _line(axes, begin, tip, color="black", linewidth=1.0, zorder=7)
    axes.quiver(
        *(begin + 0.5 * along),
        *(0.1 * along),
        color="black",
        linewidth=1.0,
        arrow_length_ratio=1.0,
        zorder=7,
    )


def _sample(label: str, marker: str, colour: str, size: float, face: str | None = None) -> Line2D:
    """Return the legend's sample of a marker."""
    return Line2D(
        [],
        [],
        linestyle="none",
        marker=marker,
        markersize=size,
        color=colour,
        markerfacecolor=colour if face is None else face,
        label=label,
    )

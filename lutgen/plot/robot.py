"""Robot: the body in 3-D with its support, its tip-over axes and the gravity ray."""

import math
from itertools import pairwise
from typing import Any, cast

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from numpy.typing import NDArray

from lutgen.analysis import Diagnosis, Facet, Posture, diagnose
from lutgen.parts import KINDS
from lutgen.plot.box import box_axes, fit_box, label_boxes, place, set_limits
from lutgen.plot.labels import angle_text, title, unit_label, with_unit
from lutgen.plot.marks import covered, write_beside
from lutgen.plot.palette import BLUE, GREEN, GREY, PURPLE, RED
from lutgen.plot.shape import circle, shape_of
from lutgen.plot.style import new_figure
from lutgen.plot.view import View
from lutgen.plot.words import folded
from lutgen.quantities import QUANTITIES

Floats = NDArray[np.float64]

SIZE = (3.5, 4.2)
# Contacts are named on the picture up to this many; more names would cover it.
NAMED = 6
ELEVATION, AZIMUTH = 20.0, -62.0
# Letters of a line of a name on the picture.
SHORT = 16
# Letters of two contacts' names that fit on one line of the legend.
LONG_NAMES = 26
LINK: dict[str, Any] = {"color": "#808080", "linewidth": 1.4, "zorder": 2}
LEVER: dict[str, Any] = {"color": "#a0a0a0", "linewidth": 0.8, "zorder": 2}
# Bodies are sketched, so they are faint.
BODY, WHEEL = (0.3, 0.3, 0.3, 0.07), (0.3, 0.3, 0.3, 0.12)


def draw_robot(view: View) -> Figure:
    """Return the figure, in the body frame with the com as the origin."""
    state = diagnose(Posture(view.recipe, view.params), view.gravity_dir)
    figure = new_figure(SIZE)
    axes = box_axes(figure, ELEVATION, AZIMUTH)
    heading = title(view, gravity=True, more=_verdict(state))
    handles = [*_body(axes, view, state), *_load(axes, view, state)]
    handles += [*_support(axes, view, state), *_edges(axes, state)]
    sides = _frame(axes, view, state)
    fit_box(figure, axes, sides, heading, handles)
    if len(state.centres) <= NAMED:
        _name_contacts(axes, view, state)
    return figure


def _verdict(state: Diagnosis) -> str:
    """Return whether the robot stands, and by how much."""
    angle = math.degrees(state.channels["tip_angle"])
    if abs(angle) > 179.99:
        return "never tips over" if state.standing else "nothing to stand on"
    away = angle_text(abs(angle))
    if not state.standing:
        return f"tips over, {away} too far"
    return f"{QUANTITIES['status'].word(state.channels['status'])}, {away} from tip-over"


def _name_contacts(axes: Any, view: View, state: Diagnosis) -> None:
    """Write the contacts' names beside them, clear of the lines."""
    ends = [(bone[0], bone[1]) for bone in shape_of(view.recipe, view.params).bones]
    ends += [(axis.start, axis.stop) for axis in state.tip_over_axes]
    if state.facet is not None:
        ends.append((np.zeros(3), state.pierced))
        # The polygon, too, is not to be covered: lines from its centre to its edges.
        corners = state.facet.points
        edges = np.concatenate([np.linspace(p, q, 9) for p, q in pairwise([*corners, corners[0]])])
        ends += [(state.facet.centroid, edge) for edge in edges]
    part = np.linspace(0.0, 1.0, 41)[:, None]
    lines = [place(axes, start + part * (stop - start))[1] for start, stop in ends]
    lines += [place(axes, rim)[1] for i in range(len(state.kind)) for rim in rims(state, i)]
    words = [covered(box) for box in label_boxes(axes)]
    for name, centre in zip(view.recipe.contact_names, state.centres, strict=True):
        x, y = place(axes, centre[None, :])[0][0]
        text = folded(name.replace("_", " "), SHORT)
        words.append(write_beside(axes, (float(x), float(y)), text, lines, words))


def rims(state: Diagnosis, index: int) -> list[Floats]:
    """Return the circles that show a contact, (49, 3) each: of a wheel one, of a ball three."""
    normals = {"disc": [state.disc_axes[index]], "sphere": list(np.eye(3)), "point": []}
    centre, radius = state.centres[index], float(state.radius[index])
    return [circle(centre, normal, radius) for normal in normals[KINDS[state.kind[index]]]]


def _body(axes: Any, view: View, state: Diagnosis) -> list[Artist]:
    """Draw the body and the contacts."""
    shape = shape_of(view.recipe, view.params)
    for bone in shape.bones:
        _line(axes, *bone, **LINK)
    if shape.faces:
        axes.add_collection3d(Poly3DCollection(shape.faces, facecolor=BODY, edgecolor="none"))
    for belt in shape.belts:
        axes.add_collection3d(Poly3DCollection([belt], facecolor=WHEEL, edgecolor="none"))
        axes.plot(*belt.T, color=GREY, linewidth=0.8, zorder=3)
    for i, centre in enumerate(state.centres):
        found = rims(state, i)
        if not found:
            axes.plot(*centre[:, None], "o", color=GREY, markersize=3.5, zorder=6)
        elif KINDS[state.kind[i]] == "disc":
            axes.add_collection3d(Poly3DCollection(found, facecolor=WHEEL, edgecolor="none"))
            axes.plot(*found[0].T, color=GREY, linewidth=0.8, zorder=3)
        else:
            axes.add_collection3d(Line3DCollection(found, colors=GREY, linewidths=0.6, zorder=3))
    # Small beside the ball in which it may lie.
    dot = 2.0 if state.com_uncertainty > 0.0 else 4.5
    com = _mark(axes, np.zeros(3), "o", "black", dot, label="centre of mass")
    kinds = sorted({f"{KINDS[kind]}s" for kind in state.kind})
    hollow = GREY if kinds == ["points"] else "none"
    look: dict[str, Any] = {"color": GREY, "markersize": 4.5, "markerfacecolor": hollow}
    words = f"contacts ({', '.join(kinds)})"
    return [com, Line2D([], [], linestyle="none", marker="o", label=words, **look)]


def _load(axes: Any, view: View, state: Diagnosis) -> list[Artist]:
    """Draw the ball in which the com lies, and the forces: the weight is as long as the robot."""
    handles: list[Artist] = []
    if state.com_uncertainty > 0.0:
        rims = [circle(np.zeros(3), normal, state.com_uncertainty) for normal in np.eye(3)]
        axes.add_collection3d(Line3DCollection(rims, colors="black", linewidths=0.5, zorder=8))
        words = f"com anywhere within {with_unit(state.com_uncertainty, view.recipe.length_unit)}"
        handles.append(Line2D([], [], color="black", linewidth=0.5, label=words))
    acting = state.forces.any(axis=1)
    for start, force in zip(state.force_points[acting], state.forces[acting], strict=True):
        _line(axes, np.zeros(3), start, **LEVER)
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
    facet, pierced = state.facet, state.pierced
    down = 1.5 * _size(state) * state.gravity_dir
    if facet is None:
        return [_arrow(axes, np.zeros(3), down, "gravity")]
    near = _is_near(state)
    start, what = _ray(state, facet, far=not near)
    ray = _arrow(axes, start, pierced if near else down, what)
    polygon = Poly3DCollection([facet.points], facecolor=GREEN, alpha=0.25, edgecolor="none")
    axes.add_collection3d(polygon)
    polygon.set_zorder(1)
    axes.plot(*facet.points.T, "o", color=GREEN, markersize=3, zorder=6)
    centre = _mark(axes, facet.centroid, "s", BLUE, 4, label="its centre $s$")
    handles = [Patch(facecolor=GREEN, alpha=0.3, label="support polygon"), centre, ray]
    if near:
        far = math.dist(pierced, facet.centroid)
        words = rf"$|SD_g|$ = {with_unit(far, view.recipe.length_unit)}"
        look: dict[str, Any] = {"color": BLUE, "linewidth": 1.8, "zorder": 7}
        span = _line(axes, facet.centroid, pierced, label=words, **look)
        words = "$D_g$, where it meets the support"
        handles += [_mark(axes, pierced, "D", "black", 3.5, label=words), span]
    return handles


def _edges(axes: Any, state: Diagnosis) -> list[Artist]:
    """Draw the tip-over axes, the least stable one in colour."""
    others: dict[str, Any] = {"color": "black", "linewidth": 0.9, "label": "tip-over axes"}
    handles: list[Artist] = [
        _line(axes, axis.start, axis.stop, zorder=4, **others)
        for index, axis in enumerate(state.tip_over_axes)
        if index != state.least_stable
    ][:1]
    if state.least_stable is not None:
        axis = state.tip_over_axes[state.least_stable]
        angle = angle_text(math.degrees(axis.tip_angle))
        ends = list(dict.fromkeys(name.replace("_", " ") for name in axis.names))
        # Two long names take a line each.
        between = (" to " if len("".join(ends)) <= LONG_NAMES else " to\n").join(ends)
        # With marks at its ends: over a wheel it may be as short as a point.
        look: dict[str, Any] = {"color": RED, "linewidth": 2.0, "marker": "o", "markersize": 3.0}
        look["zorder"] = 7
        words = f"least stable, {angle}:\n{between}"
        handles.append(_line(axes, axis.start, axis.stop, label=words, **look))
    return handles


def _frame(axes: Any, view: View, state: Diagnosis) -> Floats:
    """Name the axes, give them room for everything drawn, and return their lengths, (3,)."""
    reach = state.radius[:, None]
    drawn = [np.zeros((1, 3)), state.centres - reach, state.centres + reach]
    drawn += [part for parts in shape_of(view.recipe, view.params) for part in parts]
    if state.facet is not None:
        drawn.append(state.facet.points)
    if _is_near(state):
        drawn.append(state.pierced[None, :])
    drawn += [state.force_points, state.force_points + _size(state) * state.forces]
    everything = np.concatenate(drawn)
    low, high = everything.min(axis=0), everything.max(axis=0)
    margin = 0.06 * float((high - low).max())
    low, high = low - margin, high + margin
    sides = high - low
    named = {"x forward": axes.xaxis, "y left": axes.yaxis, "z up": axes.zaxis}
    for (name, axis), share in zip(named.items(), sides / sides.max(), strict=True):
        axis.set_major_locator(MaxNLocator(max(2, round(5 * share)), steps=[1, 2, 5, 10]))
        axis.set_label_text(unit_label(name, view.recipe.length_unit))
    set_limits(axes, low, high)
    return np.asarray(sides)


def _is_near(state: Diagnosis) -> bool:
    """Tell whether D_g is near enough to be drawn; without a facet there is none."""
    return bool(np.linalg.norm(state.pierced) <= 1.5 * _size(state))


def _size(state: Diagnosis) -> float:
    """Return the distance from the com to the furthest contact."""
    return float(np.linalg.norm(state.centres, axis=1).max() + state.radius.max())


def _line(axes: Any, start: Floats, stop: Floats, **look: Any) -> Artist:
    """Draw a line."""
    return cast("Artist", axes.plot(*np.transpose([start, stop]), **look)[0])


def _mark(axes: Any, at: Floats, marker: str, colour: str, size: float, label: str) -> Artist:
    """Draw a marker."""
    (mark,) = axes.plot(*at[:, None], marker, color=colour, markersize=size, zorder=8, label=label)
    return cast("Artist", mark)


def _arrow(axes: Any, start: Floats, tip: Floats, label: str) -> Artist:
    """Draw the ray of gravity."""
    along = tip - start
    look: dict[str, Any] = {"color": "black", "linewidth": 1.0, "zorder": 7}
    ray = _line(axes, start, tip, label=label, **look)
    axes.quiver(*(start + 0.5 * along), *(0.1 * along), arrow_length_ratio=1.0, **look)
    return ray

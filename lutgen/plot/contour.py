"""Contour: which posture is best, over two parameters, and the nodes of a search for it."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from lutgen.chart import unit_directions
from lutgen.plot.disc import hatch_where
from lutgen.plot.key import STAR, Scale, add_key
from lutgen.plot.labels import angle, found_text, gravity_text, name_axis, named, quantity_text
from lutgen.plot.plane import Plane
from lutgen.plot.scene import draw_scene
from lutgen.plot.style import BLACK, bare, colours, halo, in_house_style, ink_on, place
from lutgen.plot.view import View, is_sealed
from lutgen.quantities import QUANTITIES
from lutgen.recipe import Recipe
from lutgen.search import Optimum
from lutgen.vector import Floats

# Where the best posture is, and its value, as shown.
Best = tuple[float, float, float]

RIGHT = 6.55
# Parts of the axes' width: labels of lines keep so far from each other, the frame and jumps.
APART, INSIDE, AWAY = 0.06, 0.03, 0.035
# One marker for each step; a search of more steps begins again.
MARKERS = ("o", "s", "^", "D", "v", "P")
# Room around the nodes, in spacings.
ROOM = 0.5


def draw_contour(view: View) -> Figure:
    """Return the figure."""
    plane = Plane(view)
    best, jumps, shown = plane.best(), plane.lines(), np.where(plane.tips, np.nan, plane.big)
    figure, axes = view.page(6.25, (0.95, 0.72, 5.35, 5.35), *plane_words(view, best))
    scale = Scale(view, shown)
    extent = (plane.fx[0], plane.fx[-1], plane.fy[0], plane.fy[-1])
    axes.set_facecolor(colours().wash)
    scale.picture(axes, shown, extent)
    hatch_where(axes, plane.fx, plane.fy, plane.tips)
    for width, colour in ((3.6, "white"), (2.0, BLACK)):
        lines = LineCollection(list(jumps), colors=colour, linewidths=width, zorder=3)
        axes.add_collection(lines, autolim=False).set_capstyle("round")
    avoid = [*jumps.reshape(-1, 2), *([best[:2]] if best else [])]
    _name_levels(axes, plane, scale, np.array(avoid).reshape(-1, 2))
    flat = plane.flat() if view.channel == "tip_angle" else None
    if flat is not None and best is not None and _has_room(plane, flat, best):
        back = scale.colour(flat[2])
        text = axes.text(*flat[:2], f"{angle(flat[2])} everywhere here", color=ink_on(back))
        text.set(ha="center", va="center", zorder=6, path_effects=halo(3.0, back))
    for i, axis in enumerate((axes.xaxis, axes.yaxis)):
        name_axis(axis, view.parameter(i), extent[2 * i : 2 * i + 2], 52 - 6 * i)
    if best is not None:
        axes.plot([best[0]], [best[1]], label="best", **STAR)
    if view.ax is None:
        scale.bar(figure, RIGHT, 5.62)
        entries = [("jump", "jump: other\ncontacts carry")] if len(jumps) else []
        entries += [("hatch", "tips over")] if plane.tips.any() else []
        add_key(figure, entries, RIGHT, 3.35)
        if best is not None:
            # Less than half a hundredth of the scale is noise of the mesh.
            value = best[2] if abs(best[2]) > 0.005 * (scale.high - scale.low) else 0.0
            _show_best(figure, view, (*best[:2], value))
    return figure


def plane_words(view: View, best: Best | None) -> tuple[str, str]:
    """Return the answer and the note of a figure over two parameters."""
    where, one = gravity_text(view.gravity_dir, view.convention), QUANTITIES[view.channel]
    what = "How far it can lean from there before it tips over"
    if view.channel != "tip_angle":
        good = "small" if one.sign > 0 else "large"
        what = f"{one.label[0].upper()}{one.label[1:]}: {good} is good"
    note = f"{named(view.recipe, view.params, view.axes, where)}\n{what}."
    if best is None:
        return f"Tips over in every posture, {where}", note
    spots = [found_text(view.parameter(i), best[i], view.window(i)) for i in (0, 1)]
    where = "with a level body" if where == "body level" else where
    return f"Best {where}: {' and '.join(spots)}", note


def _show_best(figure: Figure, view: View, best: Best) -> None:
    """Draw the best posture at the lower right, and write its value."""
    wide, tall = figure.get_size_inches()
    words = f"\N{WHITE STAR} best: {quantity_text(view.recipe, view.channel, best[2])}"
    figure.text(RIGHT / wide, 0.82 / tall, words, size=11, weight="bold", va="center")
    if is_sealed(view.recipe):
        return
    spots = [np.clip(view.parameter(i).stored(best[i]), *view.ends(i)) for i in (0, 1)]
    (posture,) = view.postures(*spots)
    picture = bare(place(figure, (6.45, 0.98, 1.5, 1.3)))
    draw_scene(picture, view.recipe, posture, view.down(posture), line=0.45)
    picture.set_anchor("S")


def _has_room(plane: Plane, flat: Best, best: Best) -> bool:
    """Return True if words in the flat area would not cover the star, nor leave the picture."""
    low = np.array([plane.fx[0], plane.fy[0]])
    span = np.array([plane.fx[-1], plane.fy[-1]]) - low
    spot, star = (np.array(flat[:2]) - low) / span, (np.array(best[:2]) - low) / span
    return bool(0.17 < spot[0] < 0.83 and (np.abs(spot - star) > [0.3, 0.06]).any())


def _name_levels(axes: Axes, plane: Plane, scale: Scale, avoid: Floats) -> None:
    """Draw lines of levels where they are clear, and write each once on its longest piece."""
    if plane.tips.all():
        return
    lines = axes.contour(plane.fx, plane.fy, plane.broken(), levels=scale.levels, linewidths=0.0)
    to_paper, taken = axes.transData - axes.transAxes, np.empty((0, 2))
    tree = cKDTree(to_paper.transform(avoid)) if len(avoid) else None
    for level, segments in zip(scale.levels, lines.allsegs, strict=True):
        back = scale.colour(level)
        pieces = [part for piece in segments if len(piece) > 1 for part in plane.clear(piece)]
        for piece in pieces:
            axes.plot(*piece.T, color=ink_on(back), linewidth=0.9, zorder=2)
        flat = [to_paper.transform(piece) for piece in pieces if len(piece) > 10]
        longest = max(flat, key=_length, default=np.empty((0, 2)))
        found = _spot(longest, taken, tree) if _length(longest) > 0.2 else None
        if found is not None:
            spot, slope = found
            taken = np.vstack([taken, spot])
            x, y = spot
            text = axes.text(x, y, scale.text(level), size=10, color=ink_on(back))
            text.set(ha="center", va="center", transform=axes.transAxes)
            text.set(rotation=slope, zorder=4, path_effects=halo(3.2, back))


def _length(piece: Floats) -> float:
    return float(np.linalg.norm(np.diff(piece, axis=0), axis=1).sum())


def _spot(piece: Floats, taken: Floats, avoid: Any) -> tuple[Floats, float] | None:
    """Return where on a line its level is written (parts of the axes), and its slope in deg."""
    inside = np.minimum(piece, 1.0 - piece).min(axis=1)
    apart = np.linalg.norm(piece[:, None] - taken, axis=2).min(axis=1, initial=np.inf)
    k = max(len(piece) // 40, 3)
    ahead = np.roll(piece, -k, axis=0) - np.roll(piece, k, axis=0)
    turn = np.abs(np.diff(np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0])), append=0.0))
    score = np.minimum(apart, 0.25) + np.minimum(inside, 0.12) - 0.3 * np.minimum(turn * 10, 0.5)
    score[:k] = score[-k:] = -1.0
    if avoid is not None:
        score[avoid.query(piece)[0] < AWAY] = -1.0
    at = int(np.argmax(score))
    if score[at] < 0.0 or apart[at] < APART or inside[at] < INSIDE:
        return None
    slope = math.degrees(math.atan2(ahead[at][1], ahead[at][0]))
    return piece[at], (slope + 90.0) % 180.0 - 90.0


@in_house_style
def draw_steps(recipe: Recipe, found: Optimum, gravity: ArrayLike, steps: Sequence[int]) -> Figure:
    """Return the nodes of some steps of a search over the contours of its objective.

    `found` is of a robot with two parameters, of the method `search` and one channel, under
    `gravity` (3,); `steps` count from 0, and the figure covers their nodes.
    """
    nodes = np.concatenate([found.trace[step].nodes for step in steps])
    window = []
    for i, parameter in enumerate(recipe.parameters):
        spots = np.unique(found.trace[steps[0]].nodes[:, i].round(12))
        room = ROOM * np.diff(spots).max(initial=0.0)
        ends = nodes[:, i].min() - room, nodes[:, i].max() + room
        window.append(replace(parameter, minimum=float(ends[0]), maximum=float(ends[1])))
    near, down = replace(recipe, parameters=tuple(window)), unit_directions(np.asarray(gravity))
    view = View(near, None, nodes[0], down, found.objective, (0, 1), found.convention)
    figure = draw_contour(view)
    axes = figure.axes[0]
    # The best of the search is marked instead.
    for star in [line for line in axes.get_lines() if line.get_label() == "best"]:
        star.remove()
    for order, step in enumerate(steps):
        at, smaller = found.trace[step], min(order, 3)
        places = [p.shown(at.nodes[:, i]) for i, p in enumerate(recipe.parameters)]
        (marks,) = axes.plot(*places, linestyle="none", marker=MARKERS[order % len(MARKERS)])
        marks.set(markersize=8 - smaller, markerfacecolor="white", markeredgecolor=BLACK)
        marks.set(zorder=5 + 0.1 * order, clip_on=False, label=f"nodes of step {step + 1}")
        best = [[float(p.shown(at.params[i]))] for i, p in enumerate(recipe.parameters)]
        axes.plot(*best, **STAR | {"markersize": 20 - 3 * smaller, "zorder": 9 + 0.1 * order})
    words = f"searched in {found.trace[steps[-1]].evaluations} evaluations"
    figure.texts[1].set_text(f"{figure.texts[1].get_text()} {words.capitalize()}.")
    return figure

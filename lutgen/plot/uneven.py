"""Footing: feet on uneven ground seen along gravity, and where the com may lie."""

import math
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from lutgen.analysis import Equilibrium, Footing
from lutgen.plot.labels import given, plain, unit_label
from lutgen.plot.painter import arrow, com_mark
from lutgen.plot.style import colours, halo, in_house_style, page, place
from lutgen.vector import Floats

# Inches: margins of the view, its width and its greatest height.
LEFT, BELOW, WIDE, TALLEST = 1.0, 0.75, 6.7, 6.5
# Room around, and the longest force, over the larger side of the picture.
ROOM, FORCE = 0.18, 0.18
# Regions farther out than this, in sides of the feet's box, leave the picture.
FAR = 1.0
NEAR: dict[str, Any] = {"textcoords": "offset points", "size": 10, "zorder": 9}
SAID = {True: "Holds", False: "Does not hold", None: "Unknown if it holds"}


@in_house_style
def draw_footing(footing: Footing, found: Equilibrium) -> Figure:
    """Draw feet on uneven ground, seen along gravity, and the region in which the com may lie.

    `found` is what `Footing.equilibrium` says; of a weight that is held, forces are drawn, too.
    """
    feet, com = footing.points @ found.axes.T, found.axes @ footing.com
    low, high = _box(feet, com, found)
    span = high - low
    scale = min(WIDE / span[0], TALLEST / span[1])
    words, unit = SAID[found.holds], footing.length_unit
    if math.isfinite(found.margin):
        margin = 0.0 if abs(found.margin) < 1e-9 * span[0] else found.margin
        words += f", margin {given(margin, unit)}"
    note = f"{plain(footing.title)}, seen along gravity. Blue: the centre of mass may lie here."
    figure = page(BELOW + scale * span[1] + 0.1, words, note)
    axes = place(figure, (LEFT, BELOW, scale * span[0], scale * span[1]))
    level = np.allclose(found.axes, np.eye(3)[:2])
    labels = [unit_label(name, unit) for name in (("x", "y") if level else ("ahead", "left"))]
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel=labels[0], ylabel=labels[1])
    look, length = colours(), float(span.max())
    if len(found.region):
        axes.fill(*found.region.T, zorder=0.5, facecolor=look.pale)
        closed = np.vstack([found.region, found.region[:1]])
        axes.plot(*closed.T, color=look.blue, linewidth=1.8, marker="s", markersize=3, zorder=2)
    if found.forces is not None:
        forces = found.forces @ found.axes.T
        largest = float(np.linalg.norm(found.forces, axis=1).max())
        for foot, force in zip(feet, FORCE * length / largest * forces, strict=True):
            # A head alone would say which way a force goes that is not there.
            if np.linalg.norm(force) > 0.02 * length:
                arrow(axes, foot, foot + force, look.soft, 0.9)
    axes.plot(*feet.T, "o", color=look.ink, markersize=6, zorder=7.8)
    com_mark(axes, com, 0.02 * length, 8.0)
    for foot, name in zip(feet, footing.names, strict=True):
        side = np.where(foot >= feet.mean(axis=0), 1.0, -1.0)
        text = axes.annotate(plain(name), tuple(foot), tuple(6.0 * side), **NEAR)
        text.set(ha="left" if side[0] > 0 else "right", va="bottom" if side[1] > 0 else "top")
        text.set_path_effects(halo())
    return figure


def _box(feet: Floats, com: Floats, found: Equilibrium) -> tuple[Floats, Floats]:
    """Return the lowest and highest (2,) of the picture: feet, com, and a region that is near."""
    points = np.vstack([feet, com])
    low, high = points.min(axis=0), points.max(axis=0)
    wide = float((high - low).max()) or 1.0
    if len(found.region):
        near = np.clip(found.region, low - FAR * wide, high + FAR * wide)
        low, high = np.minimum(low, near.min(axis=0)), np.maximum(high, near.max(axis=0))
    room = ROOM * float((high - low).max()) or 1.0
    return low - room, high + room

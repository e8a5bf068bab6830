"""Sphere: a channel over all gravity directions at one posture, in discs of equal area.

Lambert's azimuthal projection seen from above, the nose at the top and left at the left: equal
areas of paper are equal shares of the directions.  The whole sphere is two discs, around straight
down and around straight up; a cone is one disc.  Values are evaluated, not read from the map.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray

from lutgen.analysis import tilted
from lutgen.errors import InputError
from lutgen.plot.labels import (
    HEADINGS,
    attitude,
    channel_label,
    optimum_text,
    slide_label,
    title,
    with_unit,
)
from lutgen.plot.legend import add_legend
from lutgen.plot.levels import fill, levels, outline
from lutgen.plot.marks import (
    CENTRED,
    HALO,
    mark_optimum,
    mark_sliding,
    rock_patch,
    shade_rocking,
    shade_tip_over,
    tip_patch,
)
from lutgen.plot.palette import GREY, MAP, ON_COLOURS
from lutgen.plot.style import head, new_figure
from lutgen.plot.view import View, optimum
from lutgen.quantities import QUANTITIES

Floats = NDArray[np.float64]

CONE_SIZE = (3.5, 3.2)
SPHERE_SIZE = (7.0, 3.75)
# The mesh of a disc: every half degree of tilt and every degree of heading.
TILTS, HEADING_COUNT = 181, 361


@dataclass(frozen=True)
class Disc:
    """One disc: tilts (rad) from `inner` at the middle to `outer` at the rim, and its mesh.

    `x`, `y`, `values` (display unit), `tip_angle`, `grip` (rad, see `View.grip`) and `rocks` are
    (TILTS, HEADING_COUNT).
    """

    inner: float
    outer: float
    x: Floats
    y: Floats
    values: Floats
    tip_angle: Floats
    grip: Floats
    rocks: NDArray[np.bool_]


def draw_sphere(view: View) -> Figure:
    """Return the figure."""
    chart = view.recipe.chart
    whole = chart.kind == "sphere"
    if not whole and chart.nodes == 1:
        raise InputError(
            f"plot: the chart of {view.recipe.name} is a single gravity direction (got "
            "nodes = 1); sweep more nodes, or draw the kinds curve, contour or surface."
        )
    half = math.pi / 2.0
    spans = [(0.0, half), (math.pi, half)] if whole else [(0.0, chart.max_tilt)]
    discs = [_disc(view, *span) for span in spans]
    # A disc that is hatched all over says no more than the share of directions that tip.
    discs = [disc for disc in discs if (disc.tip_angle >= 0.0).any()] or discs[:1]
    stack = np.stack([disc.values for disc in discs])
    best = optimum(view.channel, stack)
    figure = new_figure(SPHERE_SIZE if len(discs) > 1 else CONE_SIZE)
    head(figure, title(view, gravity=False))
    panels = figure.subplots(1, len(discs), squeeze=False)[0]
    handles: list[Artist] = []
    if best is not None:
        steps = levels(stack, view.scale)
        for panel, disc in zip(panels, discs, strict=True):
            if np.isfinite(disc.values).any():
                fill(panel, disc.x, disc.y, disc.values, steps)
                outline(panel, disc.x, disc.y, disc.values, steps, linewidths=0.4)
        scale = ScalarMappable(BoundaryNorm(steps, 256), MAP)
        label = channel_label(view.recipe, view.channel)
        figure.colorbar(scale, ax=list(panels), pad=0.01, aspect=30, shrink=0.9, label=label)
        number, *node = np.unravel_index(best, stack.shape)
        x, y, value = (
            float(part[*node]) for part in (discs[number].x, discs[number].y, stack[number])
        )
        tilt = discs[number].inner + (discs[number].outer - discs[number].inner) * node[0] / (
            TILTS - 1
        )
        words = f"{optimum_text(view, value, stack)},\n{attitude(tilt, math.atan2(-x, y))}"
        handles.append(mark_optimum(panels[number], x, y, words))
    slides: list[Artist] = []
    tips = rocks = False
    for panel, disc in zip(panels, discs, strict=True):
        mesh, label = (disc.x, disc.y), slide_label(view.recipe)
        slides += mark_sliding(panel, mesh, disc.grip, disc.tip_angle, label)
        rocks |= shade_rocking(panel, mesh, disc.rocks, "white")
        tips |= shade_tip_over(panel, *mesh, disc.tip_angle)
        _graticule(panel, disc)
    handles += slides[:1]
    if rocks:
        handles.append(rock_patch("white", GREY))
    if tips:
        share = 100.0 * _share_that_tips(view)
        where = "all directions" if whole else "the chart's directions"
        handles.append(tip_patch(f"tips over ({share:.1f} % of {where})"))
    add_legend(figure, handles)
    return figure


def _share_that_tips(view: View) -> float:
    """Return the share of the chart's solid angle in which the posture tips over."""
    chart = view.recipe.chart
    angle = view.exact(view.params, chart.directions().reshape(-1, 3), "tip_angle")["tip_angle"]
    weight = chart.solid_angle().ravel()
    return float(weight[angle < 0.0].sum() / weight.sum())


def _disc(view: View, inner: float, outer: float) -> Disc:
    """Compute the mesh of one disc."""
    around = np.linspace(0.0, 2.0 * math.pi, HEADING_COUNT)
    tilt, heading = np.meshgrid(np.linspace(inner, outer, TILTS), around, indexing="ij")
    directions = tilted(tilt.ravel(), heading.ravel())
    radius = _radius(tilt, inner, outer)
    x, y = -radius * np.sin(heading), radius * np.cos(heading)
    exact = view.exact(view.params, directions, view.channel, "tip_angle")
    exact = {name: values.reshape(tilt.shape) for name, values in exact.items()}
    tip_angle, values = exact["tip_angle"], QUANTITIES[view.channel].shown(exact[view.channel])
    # Beyond tip-over some channels go on; the hatching is there.
    values = np.where(tip_angle < 0.0, np.nan, values)
    grip = view.grip(view.params, directions).reshape(tilt.shape)
    rocks = view.rocks(directions).reshape(tilt.shape)
    return Disc(inner, outer, x, y, values, tip_angle, grip, rocks)


def _radius(tilt: Any, inner: float, outer: float) -> Any:
    """Return the place of a tilt between the middle (0) and the rim (1) of its disc."""
    return np.sin(np.abs(tilt - inner) / 2.0) / math.sin(abs(outer - inner) / 2.0)


def _name_ring(panel: Axes, ring: float, place: tuple[float, float]) -> None:
    """Write its tilt (deg) on a circle."""
    words = with_unit(ring, "deg")
    panel.text(*place, words, fontsize=6, zorder=6, path_effects=HALO, **CENTRED)


def _graticule(panel: Axes, disc: Disc) -> None:
    """Draw circles of equal tilt, four headings, and their names."""
    around = np.linspace(0.0, 2.0 * math.pi, 181)
    low, high = sorted((math.degrees(disc.inner), math.degrees(disc.outer)))
    rings = [ring for ring in np.arange(15.0, 180.0, 15.0) if low + 1e-6 < ring < high - 1e-6]
    style: dict[str, Any] = {"color": "black", "linewidth": 0.35, "alpha": 0.55, "zorder": 5}
    style["gid"] = ON_COLOURS
    for ring in rings:
        radius = _radius(math.radians(ring), disc.inner, disc.outer)
        panel.plot(radius * np.sin(around), radius * np.cos(around), **style)
        corner = (radius * math.sqrt(0.5), -radius * math.sqrt(0.5))
        _name_ring(panel, ring, corner)
    for heading in (0.0, 45.0, 90.0, 135.0):
        x, y = -math.sin(math.radians(heading)), math.cos(math.radians(heading))
        panel.plot([-x, x], [-y, y], **style)
    panel.plot(np.sin(around), np.cos(around), color="black", linewidth=0.8, zorder=5)
    _name_ring(panel, math.degrees(disc.outer), (math.sqrt(0.5), -math.sqrt(0.5)))
    for heading, name in HEADINGS.items():
        x, y = -math.sin(math.radians(heading)), math.cos(math.radians(heading))
        turn = 90 * round(-x) if abs(x) > 0.5 else 0
        panel.text(1.07 * x, 1.07 * y, name, rotation=turn, fontsize=7, **CENTRED)
    if high >= 90.0 or low > 0.0:
        panel.set_title(f"tilt {low:g} to {high:g} deg", loc="center", pad=2)
    panel.set(aspect="equal", xlim=(-1.14, 1.14), ylim=(-1.14, 1.14))
    panel.set_axis_off()

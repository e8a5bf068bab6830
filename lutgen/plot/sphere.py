"""Sphere: how far a posture is from tipping over under every gravity, or one robot in three."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lutgen.analysis import Posture, posture_limits
from lutgen.errors import InputError, reject
from lutgen.plot import disc
from lutgen.plot.key import Scale
from lutgen.plot.labels import angle, named, quantity_text
from lutgen.plot.scene import draw_scene
from lutgen.plot.style import BLACK, bare, colours, halo, in_house_style, new_figure, place
from lutgen.plot.view import View, is_sealed, optimum
from lutgen.quantities import QUANTITIES
from lutgen.recipe import Recipe
from lutgen.vector import Floats

PIXELS = 801
# Rocking is named from this share of the disc on.
NAMED = 0.002
DOWN = np.array([0.0, 0.0, -1.0])
# Inches: the page, a picture, a disc, and from one posture to the next.
SIZE, SCENE, PLATE, STEP = (8.0, 3.5), (2.5, 1.42), 1.55, 2.62
NOTE = "Discs: every direction of gravity, nose down at the top. Bright: far from tipping over."


def draw_sphere(view: View) -> Figure:
    """Return the figure: one disc of equal areas, to its rim upside down if it stands beyond 90."""
    chart, sealed = view.recipe.chart, is_sealed(view.recipe)
    if sealed and chart.nodes == 1:
        what = f"the chart of {view.recipe.name} is a single gravity direction"
        way_out = "sweep more nodes, or draw the kinds curve, contour or surface"
        reject("plot", what, "nodes = 1", way_out, InputError)
    rim = math.degrees(chart.max_tilt) if sealed and chart.kind == "cone" else 90.0
    if chart.kind == "sphere":
        up = chart.directions().reshape(-1, 3)
        up = up[up[:, 2] > 0.0]
        rim = 180.0 if (view.exact(view.params, up, "tip_angle")["tip_angle"] >= 0.0).any() else rim
    line, inside, down = disc.raster(PIXELS, rim)
    found = view.exact(view.params, down, view.channel, "tip_angle")
    values = disc.filled(inside, QUANTITIES[view.channel].shown(found[view.channel]))
    tips = disc.filled(inside, found["tip_angle"] < 0.0)
    scale = Scale(view, np.where(tips == 0.0, values, np.nan))
    found = view.exact(view.params, DOWN, view.channel, "tip_angle")
    level = float(QUANTITIES[view.channel].shown(found[view.channel][0]))
    tip = math.degrees(float(found["tip_angle"][0]))
    sentence = _sentence(view, np.where(tips == 0.0, values, np.nan), level, tip)
    good = "Bright: far from tipping over" if view.channel == "tip_angle" else "Bright is good"
    where = "Middle: body level; the further out, the more it is tilted"
    note = f"{named(view.recipe, view.params)}\n{where}. {good}."
    figure, axes = view.page(6.6, (0.02, 0.2, 6.55, 6.4), sentence, note)
    disc.colour_disc(axes, line, values, tips, scale)
    disc.name_headings(axes)
    disc.name_lines(axes, values, scale)
    rocks = (disc.filled(inside, view.rocks(down)) == 1.0) & (tips == 0.0)
    if rocks.any():
        _show_rocking(axes, line, rocks, bool(rocks.sum() > NAMED * inside.sum()))
    disc.write_in(axes, tips == 1.0, "tips over", colours().wash)
    disc.ruler(axes, disc.spread, rim)
    look: dict[str, Any] = {"markeredgecolor": BLACK, "markersize": 5, "zorder": 8}
    axes.plot([0.0], [0.0], "o", color="white", **look)
    if tip >= 0.0:
        plate = {"boxstyle": "round,pad=0.22", "facecolor": "white", "edgecolor": "none"}
        words = f"level {quantity_text(view.recipe, view.channel, level)}"
        text = axes.text(-0.06, 0.0, words, ha="right", va="center", size=10, bbox=plate)
        text.set(color=BLACK, zorder=8)
    if view.ax is None:
        tall = figure.get_figheight()
        scale.bar(figure, 6.75, tall - 1.75)
        if not sealed:
            above = bare(place(figure, (6.7, 0.95, 1.15, 1.7)))
            disc.top_view(above, view.recipe, view.params, 1.0)
            above.set(xlim=(-0.75, 0.75), ylim=(-1.05, 1.05), anchor="S")
            text = figure.text(7.27 / 8.0, 0.88 / tall, "seen from above", size=9.5)
            text.set(color=colours().soft, ha="center", va="top")
    return figure


def _show_rocking(axes: Axes, line: Floats, rocks: disc.Bools, name: bool) -> None:
    """Draw white dots where the robot rocks, and say so at the lower left."""
    look: dict[str, Any] = {"levels": [0.5, 1.5], "colors": "none", "hatches": ["...."]}
    dots = axes.contourf(line, line, rocks.astype(np.float64), zorder=2.2, **look)
    dots.set(hatchcolor="white")
    if name:
        text, spots = np.array([-1.02, -0.98]), np.argwhere(rocks)
        places = np.column_stack([line[spots[:, 1]], line[spots[:, 0]]])
        near = places[int(np.argmin(np.linalg.norm(places - text, axis=1)))]
        shaft = {"arrowstyle": "-", "color": colours().ink, "linewidth": 0.9, "shrinkB": 0}
        words = "rocks onto\nother contacts"
        note = axes.annotate(words, (near[0], near[1]), (text[0], text[1]), arrowprops=shaft)
        note.set(size=10.5, ha="center", va="center", zorder=9, path_effects=halo())


def _sentence(view: View, values: Floats, level: float, tip: float) -> str:
    """Return the channel `level`, where the tip-over angle is `tip` (deg), and the best of all."""
    best = optimum(view.channel, values)
    if best is None:
        return "It tips over under every gravity"
    most = float(values.flat[best])
    if view.channel != "tip_angle":
        name = QUANTITIES[view.channel].symbol
        text = f"Level, its {name} is {quantity_text(view.recipe, view.channel, level)}"
        text = text if tip >= 0.0 else f"Level, it tips over; {name}"
        return f"{text}, {quantity_text(view.recipe, view.channel, most)} at best"
    if most > 179.99:
        return "It never tips over"
    if tip < 0.0:
        return f"Level, it tips over; at best it is {angle(most)} from that"
    more = f"{angle(most)} at best" if most > tip + 1.0 else "and less where it leans"
    return f"Level, it is {angle(tip)} from tipping over, {more}"


@in_house_style
def draw_hero(recipe: Recipe, postures: Mapping[str, Sequence[float]], title: str) -> Figure:
    """Draw a robot on level ground in three postures, with its disc of tip-over angles.

    `postures` are (k,), rad or length, by what they are called; `title` is the question that the
    figure answers.
    """
    figure, scenes = new_figure(SIZE), []
    figure.text(0.025, 0.965, title, size=15, weight="bold", va="top")
    words = figure.text(0.025, 0.885, f"{NOTE} Hatched: tips over.", size=9.5, va="top")
    words.set_color(colours().soft)
    for n, (name, params) in enumerate(postures.items()):
        view = View(recipe, None, np.asarray(params), DOWN, "tip_angle", convention="plane")
        left = 0.12 + n * STEP
        axes = bare(place(figure, (left, 1.62, *SCENE)))
        scene = draw_scene(axes, recipe, params, view.down(view.params), 0.6)
        scenes.append((axes, scene))
        _disc(place(figure, (left + 0.02, 0.06, PLATE, PLATE)), view)
        x, tip = (left + PLATE + 0.09) / SIZE[0], math.degrees(scene.state.channels["tip_angle"])
        figure.text(x, 0.93 / SIZE[1], angle(tip), size=27, weight="bold", va="center")
        text = figure.text(x, 0.68 / SIZE[1], name, size=9.5, va="top", linespacing=1.25)
        text.set_color(colours().soft)
    # One scale and one ground.
    sizes = np.array([scene.high - scene.low for _, scene in scenes])
    half = 0.515 * np.array(SCENE) * float((sizes / SCENE).max())
    for axes, scene in scenes:
        x, low = float((scene.low + scene.high)[0]) / 2.0, float(scene.low[1])
        axes.set(xlim=(x - half[0], x + half[0]), ylim=(low, low + 2.0 * half[1]))
    return figure


def _disc(axes: Axes, view: View) -> None:
    """Draw the tip-over angle under every gravity, and the worst heading in red."""
    line, inside, down = disc.raster(500, 90.0)
    body = View(view.recipe, None, view.params, DOWN, "tip_angle")
    angle = body.exact(view.params, down, "tip_angle")["tip_angle"]
    values = disc.filled(inside, np.degrees(angle))
    tips = np.where(inside, values < 0.0, np.nan)
    disc.colour_disc(axes, line, values, tips, Scale(body, values))
    worst = posture_limits(Posture(view.recipe, view.params), "body").worst
    if math.isfinite(worst.heading):
        tilt = disc.spread(math.degrees(worst.tilt), 90.0)
        x, y = disc.at(math.degrees(worst.heading), tilt)
        for width, colour in ((3.4, "white"), (1.8, colours().red)):
            axes.plot([0.0, x], [0.0, y], color=colour, linewidth=width, zorder=6)
        axes.plot([x], [y], "o", color=colours().red, ms=5, mec="white", mew=0.8, zorder=7)
    axes.set(xlim=(-1.03, 1.03), ylim=(-1.03, 1.03))

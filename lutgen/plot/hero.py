"""Hero: one robot in three postures, and how far it may lean in each."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lutgen.analysis import Posture, posture_limits
from lutgen.plot import disc
from lutgen.plot.key import Scale
from lutgen.plot.labels import angle
from lutgen.plot.scene import draw_scene
from lutgen.plot.style import bare, colours, in_house_style, new_figure, place
from lutgen.plot.view import View
from lutgen.recipe import Recipe

DOWN = np.array([0.0, 0.0, -1.0])
# Inches: the page, a picture, a disc, and from one posture to the next.
SIZE, SCENE, PLATE, STEP = (8.0, 3.5), (2.5, 1.42), 1.55, 2.62
NOTE = "Discs: every direction of gravity, nose down at the top. Bright: far from tipping over."


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
        down, left = view.in_bodies(view.params[None], DOWN[None])[0, 0], 0.12 + n * STEP
        axes = bare(place(figure, (left, 1.62, *SCENE)))
        scene = draw_scene(axes, recipe, params, down, 0.6)
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

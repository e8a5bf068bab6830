"""Steps: the nodes of a refining search over the map that it searches."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from lutgen.chart import unit_directions
from lutgen.plot.contour import draw_contour
from lutgen.plot.key import STAR
from lutgen.plot.style import BLACK, in_house_style
from lutgen.plot.view import View
from lutgen.recipe import Recipe
from lutgen.search import Optimum

# One marker for each step; a search of more steps begins again.
MARKERS = ("o", "s", "^", "D", "v", "P")
# Room around the nodes, in spacings.
ROOM = 0.5


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

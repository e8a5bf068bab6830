"""Steps: the nodes of a refining search over the map that it searches."""

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from lutgen.errors import InputError
from lutgen.plot.labels import axis_label, channel_label, measured, parameter_text
from lutgen.plot.legend import add_legend
from lutgen.plot.levels import fill, levels
from lutgen.plot.marks import STAR, shade_tip_over, tip_patch
from lutgen.plot.style import in_house_style, new_figure
from lutgen.quantities import QUANTITIES, RANKED
from lutgen.recipe import Recipe
from lutgen.search import Objective, Optimum

Floats = NDArray[np.float64]

SIZE = (3.5, 3.2)
SAMPLES = 121
# One marker for each step; a search of more steps begins again.
MARKERS = ("o", "s", "^", "D", "v", "P")
# Room around the nodes, in spacings.
ROOM = 0.5


@in_house_style
def draw_steps(recipe: Recipe, found: Optimum, gravity: ArrayLike, steps: Sequence[int]) -> Figure:
    """Return the nodes of some steps of a search over the filled contours of its objective.

    Parameters
    ----------
    recipe : Recipe
        A robot with two parameters.
    found : Optimum
        Of the method `search`, for one channel.
    gravity : (3,) array_like
        As it was searched.
    steps : sequence of int
        Which steps, from 0; the figure covers their nodes.

    Raises
    ------
    InputError
        For other robots, objectives and methods, and steps that the search did not make.
    """
    if len(recipe.parameters) != 2 or found.objective not in RANKED:
        raise InputError(
            "plot: the steps of a search are drawn over two parameters and one channel (got "
            f"{len(recipe.parameters)} parameters and the objective {found.objective}); "
            "draw a contour instead."
        )
    known = [step for step, at in enumerate(found.trace) if len(at.nodes)]
    if not steps or not set(steps) <= set(known):
        raise InputError(
            f"plot: the search has no mesh of every one of these steps (got "
            f"{', '.join(str(step + 1) for step in steps) or 'none'}); it has "
            f"{', '.join(str(step + 1) for step in known) or 'none'}."
        )
    x, y, values = _mesh(recipe, found, gravity, steps)
    figure = new_figure(SIZE)
    axes = figure.add_subplot()
    one = len(steps) == 1
    words = f"step {steps[0] + 1}" if one else f"steps {steps[0] + 1} to {steps[-1] + 1}"
    evaluations = found.trace[steps[-1]].evaluations
    axes.set_title(f"{recipe.name}: {words} of the search, {evaluations} evaluations")
    across, up = (axis_label(parameter) for parameter in recipe.parameters)
    axes.set(xlabel=across, ylabel=up, xlim=x[[0, -1]], ylim=y[[0, -1]])
    if np.isfinite(values).any():
        filled = fill(axes, x, y, values, levels(values))
        label = channel_label(recipe, found.objective)
        figure.colorbar(filled, ax=axes, pad=0.02, aspect=28, label=label)
    handles: list[Artist] = []
    if shade_tip_over(axes, x, y, np.where(np.isnan(values), -1.0, 1.0)):
        handles.append(tip_patch())
    handles += [_nodes(axes, recipe, found, *at) for at in enumerate(steps)]
    spread = 2.0 if one else 20.0
    handles += [_best(axes, recipe, found, *at, spread) for at in enumerate(steps)]
    add_legend(figure, handles, columns=1 if one else 2)
    return figure


def _mesh(
    recipe: Recipe, found: Optimum, gravity: ArrayLike, steps: Sequence[int]
) -> tuple[Floats, Floats, Floats]:
    """Return the parameters, (SAMPLES,) each, around the nodes, and the objective over them."""
    nodes = np.concatenate([found.trace[step].nodes for step in steps])
    lines = []
    for column, coarse in zip(nodes.T, found.trace[steps[0]].nodes.T, strict=True):
        room = ROOM * np.diff(np.unique(coarse.round(12))).max(initial=0.0)
        lines.append(np.linspace(column.min() - room, column.max() + room, SAMPLES))
    goal = Objective(recipe, gravity, found.objective, found.convention)
    costs = goal.cost(np.stack([part.ravel() for part in np.meshgrid(*lines)], axis=1))
    values = np.array([goal.value(cost) for cost in costs]).reshape(SAMPLES, SAMPLES)
    x, y = (p.shown(line) for p, line in zip(recipe.parameters, lines, strict=True))
    return x, y, QUANTITIES[found.objective].shown(values)


def _nodes(axes: Axes, recipe: Recipe, found: Optimum, order: int, step: int) -> Line2D:
    """Draw the nodes of a step."""
    nodes = found.trace[step].nodes
    (line,) = axes.plot(
        *(p.shown(nodes[:, i]) for i, p in enumerate(recipe.parameters)),
        linestyle="none",
        marker=MARKERS[order % len(MARKERS)],
        markersize=4.0 - 0.5 * min(order, 3),
        markerfacecolor="white",
        markeredgecolor="black",
        markeredgewidth=0.6,
        zorder=5 + order,
        label=f"nodes of step {step + 1}",
    )
    return line


def _best(
    axes: Axes, recipe: Recipe, found: Optimum, order: int, step: int, spread: float
) -> Line2D:
    """Mark the best node of a step and name it."""
    at = found.trace[step]
    spacing = recipe.parameters[0].shown(np.diff(np.unique(at.nodes[:, 0])).max())
    among = np.array([0.0, spread * spacing])
    place = [float(p.shown(at.params[i])) for i, p in enumerate(recipe.parameters)]
    where = ", ".join(
        f"{parameter_text(p)} = {measured(value, among, p.display_unit)}"
        for p, value in zip(recipe.parameters, place, strict=True)
    )
    quantity = QUANTITIES[found.objective]
    value = float(quantity.shown(at.value))
    unit = quantity.shown_unit(recipe.length_unit)
    words = measured(value, [0.0, max(abs(value), 1e-9)], unit)
    look = STAR | {"markersize": STAR["markersize"] - 1.5 * min(order, 3), "zorder": 10 + order}
    x, y = place
    (star,) = axes.plot([x], [y], label=f"{quantity.symbol} = {words} at {where}", **look)
    return star

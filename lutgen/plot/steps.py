"""Steps: the nodes of a refining search over the map that it searches."""

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from lutgen.errors import InputError
from lutgen.plot.labels import axis_label, channel_label, measured, parameter_text, symbol
from lutgen.plot.levels import extend, levels
from lutgen.plot.marks import STAR, shade_tip_over, tip_patch
from lutgen.plot.style import MAP, house_style, new_figure, settled
from lutgen.quantities import QUANTITIES, RANKED
from lutgen.recipe import Recipe
from lutgen.search import Objective, Optimum

__all__ = ["SIZE", "draw_steps"]

Floats = NDArray[np.float64]

SIZE = (3.5, 3.2)
SAMPLES = 121
# One marker for each step; a search of more steps begins again.
MARKERS = ("o", "s", "^", "D", "v", "P")
# Room around the nodes, in spacings.
ROOM = 0.5


def draw_steps(
    recipe: Recipe,
    found: Optimum,
    gravity: ArrayLike,
    steps: Sequence[int],
    size: tuple[float, float] | None = None,
) -> Figure:
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
    size : (float, float), optional
        Inches.

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
    with house_style():
        return settled(_draw(recipe, found, gravity, steps, size or SIZE))


def _draw(
    recipe: Recipe,
    found: Optimum,
    gravity: ArrayLike,
    steps: Sequence[int],
    size: tuple[float, float],
) -> Figure:
    nodes = np.concatenate([found.trace[step].nodes for step in steps])
    coarse = found.trace[steps[0]].nodes
    spacing = [np.diff(np.unique(coarse[:, i].round(12))).max(initial=0.0) for i in (0, 1)]
    lines = [
        np.linspace(
            nodes[:, i].min() - ROOM * spacing[i], nodes[:, i].max() + ROOM * spacing[i], SAMPLES
        )
        for i in (0, 1)
    ]
    goal = Objective(recipe, gravity, found.objective, found.convention)
    mesh = np.stack([part.ravel() for part in np.meshgrid(*lines)], axis=1)
    costs = goal.cost(mesh)
    printed = np.array([goal.value(cost) for cost in costs]).reshape(SAMPLES, SAMPLES)
    values = QUANTITIES[found.objective].shown(printed)
    x, y = (recipe.parameters[i].shown(lines[i]) for i in (0, 1))
    figure = new_figure(size)
    axes = figure.add_subplot()
    one = len(steps) == 1
    words = f"step {steps[0] + 1}" if one else f"steps {steps[0] + 1} to {steps[-1] + 1}"
    evaluations = found.trace[steps[-1]].evaluations
    axes.set_title(f"{recipe.name}: {words} of the search, {evaluations} evaluations")
    axes.set_xlabel(axis_label(recipe.parameters[0]))
    axes.set_ylabel(axis_label(recipe.parameters[1]))
    if np.isfinite(values).any():
        rounds = levels(values)
        under = np.clip(extend(values), rounds[0], rounds[-1])
        fill = axes.contourf(x, y, under, levels=rounds, cmap=MAP)
        bar = figure.colorbar(fill, ax=axes, pad=0.02, aspect=28)
        bar.set_label(channel_label(recipe, found.objective))
    handles: list[Artist] = []
    if shade_tip_over(axes, x, y, np.where(np.isnan(values), -1.0, 1.0)):
        handles.append(tip_patch())
    for order, step in enumerate(steps):
        handles.append(_nodes(axes, recipe, found, step, order))
    for order, step in enumerate(steps):
        handles.append(_best(axes, recipe, found, step, order, 2.0 if one else 20.0))
    axes.set_xlim(x[0], x[-1])
    axes.set_ylim(y[0], y[-1])
    figure.legend(handles=handles, loc="outside lower center", ncols=1 if one else 2)
    return figure


def _nodes(axes, recipe: Recipe, found: Optimum, step: int, order: int) -> Line2D:  # type: ignore[no-untyped-def]
    """Draw the nodes of a step."""
    nodes = found.trace[step].nodes
    (line,) = axes.plot(
        recipe.parameters[0].shown(nodes[:, 0]),
        recipe.parameters[1].shown(nodes[:, 1]),
        linestyle="none",
        marker=MARKERS[order % len(MARKERS)],
        markersize=4.0 - 0.5 * min(order, 3),
        markerfacecolor="white",
        markeredgecolor="black",
        markeredgewidth=0.6,
        zorder=5 + order,
        label=f"nodes of step {step + 1}",
    )
    return line  # type: ignore[no-any-return]


def _best(axes, recipe: Recipe, found: Optimum, step: int, order: int, spread: float) -> Line2D:  # type: ignore[no-untyped-def]
    """Mark the best node of a step and name it."""
    at = found.trace[step]
    spacing = recipe.parameters[0].shown(np.diff(np.unique(at.nodes[:, 0])).max())
    among = np.array([0.0, spread * spacing])
    place = [float(p.shown(at.params[i])) for i, p in enumerate(recipe.parameters)]
    where = ", ".join(
        f"{parameter_text(p)} = {measured(place[i], among, p.display_unit)}"
        for i, p in enumerate(recipe.parameters)
    )
    value = float(QUANTITIES[found.objective].shown(at.value))
    unit = QUANTITIES[found.objective].shown_unit(recipe.length_unit)
    shown = measured(value, [0.0, max(abs(value), 1e-9)], unit)
    style = {**STAR, "markersize": STAR["markersize"] - 1.5 * min(order, 3)}
    (star,) = axes.plot(
        *([part] for part in place),
        linestyle="none",
        zorder=10 + order,
        label=f"{symbol(found.objective)} = {shown} at {where}",
        **style,
    )
    return star  # type: ignore[no-any-return]

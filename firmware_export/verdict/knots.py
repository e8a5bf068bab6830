"""Knots of the codec `grid` where a robot's standing region jumps: a bounded search.

Owns the cost of one linear piece between two places of an axis, estimated on lines through the
configuration space, the choice of knots with the least sum (dynamic programming), and how many
knots of each axis go together.
"""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid import LARGEST, SPAN, evenly, from_places, to_places
from firmware_export.truth import Model, Sample, uniform, uniform_directions
from lutgen.jit import njit, prange
from lutgen.vector import Floats

SEED = 71
# Places of a parameter that compete for knots, at most; sub-cells between two of them for tables of
# fewer nodes than this, and in all, at most.
PLACES = 120
EFFORT = ((4_000, 1), (24_000, 2), (1 << 62, 4))
SUB_CELLS = 230_400
# Places of u and v that compete for knots; lines through the space; clip of the tip angle (rad).
RASTER, LINES, CLIP = 33, 3_000, 0.26
# By which share of what the best knots of an axis give up even ones may give up more.
EVEN_LOSES = 0.02
# Nodes of an axis to begin with.
FEWEST = 3


def places_of(model: Model) -> int:
    """Return how many intervals of a parameter can begin or end at a knot."""
    finest = int(SUB_CELLS ** (1.0 / max(model.k, 1)) * (1.0 + 1e-9))
    return max(2, min(PLACES, finest // EFFORT[-1][1]))


def sub_cells(model: Model, nodes: int) -> int:
    """Return into how many sub-cells each parameter is cut for a table of so many nodes."""
    return places_of(model) * next(factor for most, factor in EFFORT if nodes < most)


@njit(parallel=True)
def _losses(line: Floats, place: Floats) -> Floats:
    """Return for each pair of places what one linear piece between them gives up on the lines.

    The piece is lowered until it is nowhere above the line (n, lines).
    """
    n, lines = line.shape
    loss = np.full((n, n), 1e300)
    for i in prange(n):
        for j in range(i + 1, n):
            total = 0.0
            for c in range(lines):
                a, slope = line[i, c], (line[j, c] - line[i, c]) / (place[j] - place[i])
                over = 0.0
                for k in range(i + 1, j):
                    over = max(over, a + slope * (place[k] - place[i]) - line[k, c])
                for k in range(i, j):
                    here = line[k, c]
                    if here > 0.0 and a + slope * (place[k] - place[i]) - over < 0.0:
                        total += min(here, 0.09) * (place[k + 1] - place[k])
            loss[i, j] = total
    return loss


@lru_cache(maxsize=16)
def _axis_losses(model: Model, axis: int) -> tuple[Floats, NDArray[np.float64]]:
    """Return the losses between places of an axis (k + 2: parameters, v, u), and the places."""
    rng = np.random.default_rng(SEED + axis)
    if axis < model.k:
        count = places_of(model) + 1
        place = np.rint(np.linspace(0.0, 1.0, count) * SPAN) / SPAN
        lines, per = LINES // 12, 12
    else:
        angle = np.linspace(-1.0, 1.0, RASTER) * math.atan(model.chart_limit)
        place = np.rint((np.tan(angle) / model.chart_limit + 1.0) / 2.0 * SPAN) / SPAN
        lines, per = LINES // 2, 2
    count = len(place)
    base = uniform(model, 40 * lines, SEED + axis)
    params = base.params[:lines]
    gravity = uniform_directions(model, rng, (lines, per))
    if axis < model.k:
        params = np.repeat(params, count, axis=0)
        params[:, axis] = np.tile(
            model.lower[axis] + (model.upper[axis] - model.lower[axis]) * place, lines
        )
        tip = model.exact(params, np.repeat(gravity, count, axis=0)).tip_angle
        line = tip.reshape(lines, count, per).transpose(1, 0, 2).reshape(count, -1)
    else:
        at, face = to_places(model, Sample(params, gravity))
        at = np.repeat(at, count, axis=0)
        at[:, axis] = np.tile(place, lines * per)
        towards = from_places(model, at, np.repeat(face, count))[1]
        tip = model.exact(params, towards.reshape(lines, per * count, 3)).tip_angle
        line = tip.reshape(lines * per, count).T
    return _losses(np.ascontiguousarray(np.clip(line, -CLIP, CLIP)), place), place


@lru_cache(maxsize=16)
def _paths(model: Model, axis: int) -> tuple[Floats, NDArray[np.int64]]:
    """Return the least loss with each number of knots (n,), and where each last piece begins."""
    loss, place = _axis_losses(model, axis)
    best = np.full(len(place), 1e300)
    best[0] = 0.0
    least, came = [math.inf], []
    for _ in range(len(place) - 1):
        total = best[:, None] + loss
        came.append(total.argmin(axis=0))
        best = total.min(axis=0)
        least.append(float(best[-1]))
    return np.array(least), np.array(came)


def chosen_knots(model: Model, axis: int, count: int) -> NDArray[np.uint16]:
    """Return the `count` knots that give up least, by dynamic programming.

    Even ones where they give up next to nothing more: they are read in half of the time, and take
    no bytes.
    """
    loss, place = _axis_losses(model, axis)
    least, came = _paths(model, axis)
    count = min(count, len(place))
    near = np.abs(place - np.linspace(0.0, 1.0, count)[:, None]).argmin(axis=1)
    # Where the table is proved nothing may be between two of the places at which it bends.
    met = axis >= model.k or (len(place) - 1) % max(count - 1, 1) == 0
    given = loss[near[:-1], near[1:]].sum() if met and (np.diff(near) > 0).all() else math.inf
    if given <= least[count - 1] * (1.0 + EVEN_LOSES):
        return evenly(count)
    at = [len(place) - 1]
    for back in came[: count - 1][::-1]:
        at.append(int(back[at[-1]]))
    return np.rint(place[at[::-1]] * SPAN).astype(np.uint16)


def balanced(model: Model, nodes: int) -> tuple[int, ...]:
    """Return how many nodes of each parameter, of v and of u a verdict of so many should have.

    The losses of the axes are added, as if each were the only one: what a table gives up follows
    that sum closely.  Always the axis grows that loses most per factor of nodes.
    """
    axes = range(model.k + 2)
    loss = [_paths(model, axis)[0] for axis in axes]
    shape = [FEWEST] * len(axes)
    while True:
        total = model.faces * math.prod(shape)
        best, most = None, 0.0
        for axis in axes:
            n = shape[axis]
            if n >= min(len(loss[axis]), LARGEST) or total // n * (n + 1) > nodes:
                continue
            gain = float(loss[axis][n - 1] - loss[axis][n]) / math.log((n + 1) / n)
            if gain > most:
                best, most = axis, gain
        if best is None:
            return tuple(shape)
        shape[best] += 1

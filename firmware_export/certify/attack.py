"""Search for the points where an export is worst, from the worst that a sample has seen.

Steps are random and their length adapts: errors of tables have kinks everywhere, so no derivative
is used.  Many starts are walked side by side.  Where |SD_g| jumps is found by halving.
"""

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from firmware_export.certify.answers import Measured, Reader, Witness
from firmware_export.model import (
    Model,
    Sample,
    cross_boundary,
    on_chart,
    uniform_directions,
    uniform_params,
    unit,
)
from lutgen.vector import Floats

# (measured) -> what is maximised, (m, d); -inf where a point does not count.
Value = Callable[[Measured], Floats]

# Candidates for each start and round: postures, and directions of each.
POSTURES, DIRECTIONS = 4, 6
# First step, in shares of the box and in rad, and how it changes.
FIRST_STEP, LONGER, SHORTER = 0.05, 1.5, 0.6
# A shorter step moves no float32 query by more than its rounding: the walk has arrived.
SHORTEST = 3e-8
FINE_STEP = 0.005
# Random directions that are tried to cross the boundary.
TRIES = 24
# Only this near (rad) to the tip-over boundary can a verdict be made wrong by moving along it.
NEAR = 0.05


class Found(NamedTuple):
    """Where a search ended: params (s, k), gravity (s, 3), value (s,), and false safes it met."""

    params: Floats
    gravity: Floats
    value: Floats
    points: int
    false_safe: int
    witness: Witness | None


def sdg_error(measured: Measured) -> Floats:
    """Return the error of |SD_g| where the robot stands and is said to, else -inf."""
    error = np.abs(measured.answers.sdg - measured.exact.sdg)
    counts = measured.standing & measured.answers.stands & np.isfinite(error)
    return np.where(counts, error, -np.inf)


def _excess(measured: Measured) -> Floats:
    """Return by how much the answered tip angle exceeds the true one, near the boundary."""
    true, said = measured.exact.tip_angle, measured.answers.tip_angle
    return np.where(np.abs(true) < NEAR, said - true, -np.inf)


def clearance(measured: Measured) -> Floats:
    """Return the answered tip angle where the robot tips, -inf where it stands."""
    return np.where(measured.exact.tip_angle < 0.0, measured.answers.tip_angle, -np.inf)


def climb(
    reader: Reader,
    begin: tuple[Floats, Floats],
    value: Value,
    rounds: int,
    seed: int,
    first_step: float = FIRST_STEP,
) -> Found:
    """Maximise a value by random steps from s starts, in the box and on the chart.

    `begin` are parameters (s, k) and gravity (s, 3); the best point of each start is returned.
    The first step is in shares of the box and in rad.
    """
    model, rng = reader.model, np.random.default_rng([seed, 2])
    best_q, best_g = (one.copy() for one in begin)
    s, k = best_q.shape
    best, step = np.full(s, -np.inf), np.full(s, first_step)
    points = false_safe = 0
    first = None
    for _ in range(rounds):
        able = np.flatnonzero(step >= SHORTEST)
        if len(able) == 0:
            break
        count, stride = len(able), step[able]
        # Half of the coordinates move; the first candidate keeps the posture, and its first
        # direction is the point itself.
        moves = rng.normal(size=(count, POSTURES, k)) * (rng.random((count, POSTURES, k)) < 0.5)
        moves[:, 0] = 0.0
        q = best_q[able, None] + stride[:, None, None] * moves * (model.upper - model.lower)
        q = np.clip(q, model.lower, model.upper)
        turn = rng.normal(size=(count, POSTURES, DIRECTIONS, 3)) * stride[:, None, None, None]
        turn[:, :, 0] = 0.0
        g = unit(best_g[able, None, None] + turn)
        sample = Sample(q.reshape(count * POSTURES, k), g.reshape(-1, DIRECTIONS, 3))
        measured = reader.measure(sample)
        found = np.where(on_chart(model, sample.gravity), value(measured), -np.inf)
        found = found.reshape(count, -1)
        points += sample.points
        false_safe += int(measured.false_safe.sum())
        first = first or measured.witness()
        at, row = found.argmax(axis=1), np.arange(count)
        better = found[row, at] > best[able]
        gained = able[better]
        best[gained] = found[row, at][better]
        best_q[gained] = q[row, at // DIRECTIONS][better]
        best_g[gained] = g.reshape(count, -1, 3)[row, at][better]
        step[able] = np.minimum(stride * np.where(better, LONGER, SHORTER), 0.3)
    return Found(best_q, best_g, best, points, false_safe, first)


def starts(seen: Sequence[Measured], values: Sequence[Value], count: int) -> tuple[Floats, Floats]:
    """Return params (s, k) and gravity (s, 3) of the points of greatest value.

    At most `count` of each sample and for each value, one of each posture.
    """
    params, gravity = [], []
    for measured in seen:
        for value in values:
            found = value(measured)
            at = found.argmax(axis=1)
            best = found[np.arange(len(at)), at]
            order = np.argsort(-best, kind="stable")[:count]
            order = order[np.isfinite(best[order])]
            params.append(measured.sample.params[order])
            gravity.append(measured.sample.gravity[order, at[order]])
    return np.concatenate(params), unit(np.concatenate(gravity))


def _just_outside(reader: Reader, params: Floats, gravity: Floats, seed: int) -> Floats:
    """Return for each point a direction (s, 3) near it that only just tips.

    The tip angle is the distance to the boundary, so half as much again in one of many random
    directions crosses it.  Other points are returned as they are.
    """
    model, rng = reader.model, np.random.default_rng([seed, 3])
    here = gravity[:, None]
    own = model.exact(params, here).tip_angle
    reach = 1e-6 + 1.5 * np.abs(own)[..., None]
    turn = rng.normal(size=(len(params), TRIES, 3))
    turn -= (turn * here).sum(axis=-1, keepdims=True) * here
    tried = unit(here + reach * unit(turn))
    stands = own >= 0.0
    across = (stands != (model.exact(params, tried).tip_angle >= 0.0)) & on_chart(model, tried)
    other = tried[np.arange(len(params)), across.argmax(axis=1)][:, None]
    found = across.any(axis=1)[:, None, None]
    inside = np.where(found & ~stands[..., None], other, here)
    outside = np.where(found & stands[..., None], other, here)
    _, tips = cross_boundary(model, params, inside, outside)
    return np.asarray(np.where(found, tips, here)[:, 0])


def worst_false_safe(
    reader: Reader, seen: Sequence[Measured], count: int, rounds: int, seed: int
) -> Found:
    """Search for a point that is said to stand where the robot tips.

    It starts where the answer exceeds the exact one most near the boundary, and where the answer is
    nearest to safe among points that tip.  First the excess is maximised, which has no edge at
    the boundary to be held up by, then the answer itself on the side that tips.
    """
    begin = starts(seen, (_excess, clearance), count)
    excess = climb(reader, begin, _excess, rounds, seed)
    begin = excess.params, _just_outside(reader, excess.params, excess.gravity, seed)
    found = climb(reader, begin, clearance, rounds, seed + 1, FINE_STEP)
    return found._replace(
        points=excess.points + found.points,
        false_safe=excess.false_safe + found.false_safe,
        witness=excess.witness or found.witness,
    )


# Halvings after which the first and the second difference is taken.  From pairs about 1 apart the
# second are some 1e-10 apart: what is smooth differs by nothing there.
EARLY, LATE = 20, 32
# A jump keeps most of its height while the distance shrinks by 2^(LATE - EARLY).
KEPT = 0.5
# Least height, in shares of the range, that is called a jump.
LEAST = 1e-3
# Postures between whose directions, and pairs of postures between which it is looked for.
LOOKED, WAYS, PAIRS, SEED = 48, 40, 96, 501


def _halved(model: Model, params: Floats, gravity: Floats) -> tuple[Floats, Floats]:
    """Halve pairs of points, keeping the half over which |SD_g| changes more.

    `params` has the shape (2, m, k), `gravity` (2, m, d, 3); where two postures differ, d = 1.  The
    differences (m d,) that are left after EARLY and after LATE halvings; 0 for pairs that came to a
    place where the robot tips.
    """
    q, g = params, gravity
    low, high = (model.exact(*end).sdg for end in zip(q, g, strict=True))
    early = np.zeros(low.shape)
    for turn in range(LATE):
        middle_q, middle_g = 0.5 * (q[0] + q[1]), unit(g[0] + g[1])
        middle = model.exact(middle_q, middle_g).sdg
        upper = np.abs(high - middle) > np.abs(middle - low)
        up, turned = upper[:, :1], upper[..., None]
        q = np.stack([np.where(up, middle_q, q[0]), np.where(up, q[1], middle_q)])
        g = np.stack([np.where(turned, middle_g, g[0]), np.where(turned, g[1], middle_g)])
        low, high = np.where(upper, middle, low), np.where(upper, high, middle)
        if turn == EARLY:
            early = np.abs(high - low)
    return np.nan_to_num(early).ravel(), np.nan_to_num(np.abs(high - low)).ravel()


@lru_cache(maxsize=8)
def largest_jump(model: Model) -> float:
    """Return the height (length unit) of the largest jump of |SD_g|, or 0.

    With more than three contacts the support facet changes, and its centroid with it: two points
    however near each other differ by a finite amount, and no table that interpolates can bound its
    largest error there.  Jumps are searched between directions of one posture, and between
    postures.
    """
    if model.is_tripod:
        return 0.0
    rng = np.random.default_rng([SEED, 4])
    here = uniform_params(model, rng, LOOKED)
    ends = uniform_directions(model, rng, (2, LOOKED, WAYS))
    values = model.exact(here, ends[0]).sdg
    values = values[np.isfinite(values)]
    found = [_halved(model, np.stack([here, here]), ends)]
    if model.k:
        pairs = rng.uniform(model.lower, model.upper, (2, PAIRS, model.k))
        found.append(_halved(model, pairs, uniform_directions(model, rng, (2, PAIRS, 1))))
    early, late = (np.concatenate(one) for one in zip(*found, strict=True))
    span = float(np.ptp(values)) if len(values) else 0.0
    jumps = (late > KEPT * early) & (late > LEAST * span)
    return float(np.max(late, where=jumps, initial=0.0))

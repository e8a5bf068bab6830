"""The tip-over boundary: where directions of gravity stop to stand, found to a rounding.

Tables err most beside it, and nowhere else can a verdict be wrong by little.
"""

import numpy as np

from firmware_export.truth.model import Model
from lutgen.vector import Bools, Floats

# Steps to the boundary: most brackets are then narrower than a float32 resolves.
STEPS = 11
TINY = 1e-300
# Shortest step (rad) across the boundary.
FINEST = 1e-8
# A direction of the rim comes back from its unit vector within a few 1e-16.
ROUNDING = 1e-12
# Directions that are added at a time where a posture's own may all be alike.
POOL = 12
# Decades (rad) of the distance to the boundary: float32 resolves 1e-7.
NEAREST, FARTHEST = -7.0, -1.0


def on_chart(model: Model, gravity: Floats) -> Bools:
    """Tell which directions (..., 3) the chart holds."""
    if model.faces == 6:
        return np.ones(gravity.shape[:-1], np.bool_)
    reach = np.abs(gravity[..., :2]).max(axis=-1)
    rim = model.chart_limit * (1.0 + ROUNDING)
    return np.asarray((gravity[..., 2] < 0.0) & (reach <= -gravity[..., 2] * rim))


def unit(vectors: Floats) -> Floats:
    """Return vectors (..., 3) with length 1; they must not be zero."""
    length: Floats = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
    return np.asarray(vectors / length)


def boundary(
    model: Model, params: Floats, inside: Floats, outside: Floats
) -> tuple[Floats, Floats]:
    """Find where great arcs leave the standing region, by false position on the exact tip angle.

    Parameters
    ----------
    params : (m, k) float64
        Postures.
    inside, outside : (m, d, 3) float64
        Ends of the arcs: a direction that stands and one that tips, not opposite.

    Returns
    -------
    last, first : (m, d, 3) float64
        Directions on the arc, unit, either side of the boundary: most are 1e-8 rad apart.
    """
    low, high = inside.copy(), outside.copy()
    below = model.exact(params, low).tip_angle
    above = model.exact(params, high).tip_angle
    for turn in range(STEPS):
        gap = np.sqrt(((high - low) ** 2).sum(axis=-1))
        if turn % 3 == 0:
            share = below / np.maximum(below - above, TINY)
        elif turn % 3 == 1:
            # False position leaves one end behind.  The tip angle changes by less than the way,
            # seldom by less than a third of it: this far beyond the near end is the other side.
            step = np.maximum(3.0 * np.minimum(below, -above), FINEST)
            near = np.minimum(step / np.maximum(gap, TINY), 0.5)
            share = np.where(below < -above, near, 1.0 - near)
        else:
            share = np.full(gap.shape, 0.5)
        middle = unit(low + np.clip(share, 0.0, 1.0)[..., None] * (high - low))
        value = model.exact(params, middle).tip_angle
        stands = value >= 0.0
        low = np.where(stands[..., None], middle, low)
        high = np.where(stands[..., None], high, middle)
        below, above = np.where(stands, value, below), np.where(stands, above, value)
    return low, high


def _wider(model: Model, rng: np.random.Generator, params: Floats, gravity: Floats) -> Floats:
    """Return the directions (m, d, 3) and POOL more, sought where a posture may stand.

    The first are round about; then, twice, round the one that is nearest to standing, no further
    away than the region can be.
    """
    m = len(params)
    shown = gravity
    for turn in range(3):
        tip = model.exact(params, shown).tip_angle
        best = shown[np.arange(m), tip.argmax(axis=1)][:, None]
        reach = np.abs(tip).max(axis=1) if turn == 0 else np.abs(tip.max(axis=1))
        new = unit(best + rng.normal(size=(m, POOL, 3)) * reach[:, None, None])
        # Off the chart a direction is no use; the one that it was to improve is.
        new = np.where(on_chart(model, new)[..., None], new, best)
        shown = np.concatenate([shown, new], axis=1)
    return shown


def arcs(
    model: Model, rng: np.random.Generator, params: Floats, gravity: Floats
) -> tuple[Floats, Floats, Bools]:
    """Pair directions of each posture: one that stands with one that tips.

    Returns the ends (m, d, 3) of as many arcs as there are directions, each of which is one of
    them if the posture has any of the other verdict, the standing ones first; and whether (m, d)
    directions of both kinds were found on the chart.
    """
    pool = _wider(model, rng, params, gravity)
    stands = model.exact(params, pool).tip_angle >= 0.0
    m, d = gravity.shape[:2]
    row, turn = np.arange(m)[:, None], np.arange(d)[None, :]
    key = rng.random(stands.shape)
    count = stands.sum(axis=1, keepdims=True)
    other = []
    for kind, number in ((stands, count), (~stands, stands.shape[1] - count)):
        # All of a kind, shuffled, in front.
        order = np.argsort(np.where(kind, key, 2.0), axis=1)
        pick = np.take_along_axis(order, turn % np.maximum(number, 1), axis=1)
        other.append(pool[row, pick])
    own = stands[:, :d, None]
    inside = np.where(own, gravity, other[0])
    outside = np.where(own, other[1], gravity)
    opposite = (inside * outside).sum(axis=-1) < -0.999
    both = (count > 0) & (count < stands.shape[1])
    return inside, outside, np.broadcast_to(both, opposite.shape) & ~opposite


def beside_boundary(
    model: Model, rng: np.random.Generator, params: Floats, gravity: Floats
) -> Floats:
    """Return directions (m, d, 3) close to the tip-over boundary, half of them on each side.

    Where a posture's directions all stand or all tip they are returned as they are.
    """
    inside, outside, found = arcs(model, rng, params, gravity)
    safe = np.where(found[..., None], outside, inside)
    last, first = boundary(model, params, inside, safe)
    along = outside - inside
    along -= (along * last).sum(axis=-1, keepdims=True) * last
    length = np.sqrt((along * along).sum(axis=-1, keepdims=True))
    along /= np.where(length > 0.0, length, 1.0)
    offset = 10.0 ** rng.uniform(NEAREST, FARTHEST, found.shape)
    beyond = rng.random(found.shape) < 0.5
    near = np.where(beyond[..., None], first, last)
    near = unit(near + np.where(beyond, offset, -offset)[..., None] * along)
    good = found & on_chart(model, near)
    return np.where(good[..., None], near, np.where(found[..., None], last, gravity))

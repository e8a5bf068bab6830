"""Find directions beside the tip-over boundary, where tables err most."""

import numpy as np

from firmware_export.truth.crossing import cross_boundary, unit
from firmware_export.truth.model import Model
from lutgen.vector import Bools, Floats

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


def _wider(
    model: Model, rng: np.random.Generator, params: Floats, gravity: Floats
) -> tuple[Floats, Floats]:
    """Return the directions (m, d, 3) and 3 POOL more, sought where a posture may stand.

    Only postures whose directions all stand or all tip need more: first round about, then, twice,
    round the direction that is nearest to standing, no further away than the region can be.  The
    others get that direction again.  With them their tip angles.
    """
    m = np.arange(len(params))
    shown, tip = gravity, model.tip_angle(model.postures(params), gravity)
    for turn in range(3):
        at = tip.argmax(axis=1)
        new = np.repeat(shown[m, at][:, None], POOL, axis=1)
        angle = np.repeat(tip[m, at][:, None], POOL, axis=1)
        stands = (tip >= 0.0).sum(axis=1)
        rows = np.flatnonzero((stands == 0) | (stands == tip.shape[1]))
        if len(rows):
            here = tip[rows]
            reach = np.abs(here).max(axis=1) if turn == 0 else np.abs(here.max(axis=1))
            tried = rng.normal(size=(len(rows), POOL, 3)) * reach[:, None, None]
            tried = unit(new[rows] + tried)
            # Off the chart a direction is no use; the one that it was to improve is.
            new[rows] = np.where(on_chart(model, tried)[..., None], tried, new[rows])
            angle[rows] = model.tip_angle(model.postures(params[rows]), new[rows])
        shown = np.concatenate([shown, new], axis=1)
        tip = np.concatenate([tip, angle], axis=1)
    return shown, tip


def arcs(
    model: Model, rng: np.random.Generator, params: Floats, gravity: Floats
) -> tuple[Floats, Floats, Bools]:
    """Pair directions of each posture: one that stands with one that tips.

    Returns the ends (m, d, 3) of as many arcs as there are directions, each of which is one of
    them if the posture has any of the other verdict, the standing ones first; and whether (m, d)
    directions of both kinds were found on the chart.
    """
    pool, tip = _wider(model, rng, params, gravity)
    stands = tip >= 0.0
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
    model: Model, rng: np.random.Generator, params: Floats, gravity: Floats, count: int
) -> Floats:
    """Return directions (m, count, 3) close to the tip-over boundary: pairs, one on each side.

    A crossing takes longer to find than two pairs to measure.  The crossings are on arcs from the
    last of the directions (m, d, 3), which are returned as they are where a posture's directions
    all stand or all tip.
    """
    part = -(-count // 4)
    ins, outs, both = arcs(model, rng, params, gravity)
    inside, outside, given = (one[:, -part:] for one in (ins, outs, gravity))
    found = np.asarray(both[:, -part:, None])
    ends = cross_boundary(model, params, inside, np.where(found, outside, inside))
    along = outside - inside
    along -= (along * ends[0]).sum(axis=-1, keepdims=True) * ends[0]
    length = np.sqrt((along * along).sum(axis=-1, keepdims=True))
    along /= np.where(length > 0.0, length, 1.0)
    sides = []
    for sign, end in 2 * list(zip((-1.0, 1.0), ends, strict=True)):
        near = unit(end + sign * 10.0 ** rng.uniform(NEAREST, FARTHEST, found.shape) * along)
        good = found & on_chart(model, near)[..., None]
        sides.append(np.where(good, near, np.where(found, ends[0], given)))
    return np.concatenate(sides, axis=1)[:, :count]

"""How v becomes a place on the tree's last axis: folded at the plane in which a robot is mirrored.

Owns the search for that plane.  A robot whose left is as its right needs half of the tree; where
its com is a little off the middle, one side is a little stretched.  Nothing depends on how well the
sides agree but what the tree gives up: both are proved.
"""

import math

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid import PLACES, RATE, Fold
from firmware_export.truth import Model, uniform
from lutgen.vector import Floats

# Postures that are looked at, stretches of one side that are tried at once, how far they reach at
# first, and how often the best is sought more closely.
POSTURES, STRETCHES, REACH, TURNS = 200, 11, 0.15, 4
# Tip angles (rad) beyond which it does not matter how far apart they are.
CLIP = 0.1
# Share of what stands on one side that may tip on the other.
MOST_APART = 0.005
SEED = 91


FLAT = Fold(PLACES // 2, RATE, RATE)


def folded(fold: Fold, v: Floats) -> Floats:
    """Return the places, 0 to 1, of v in units of the chart's limit."""
    rate = np.where(v >= 0.0, fold.ahead, fold.behind) / (2.0 * RATE)
    return np.asarray(fold.base / PLACES + v * rate)


def sides_of(fold: Fold) -> NDArray[np.float64]:
    """Return per side (1 or 2, 3): the place of v = 0, places for 1 of v, the last place."""
    first, ahead = fold.base / PLACES, fold.ahead / (2.0 * RATE)
    if fold == FLAT:
        return np.array([[first, ahead, 1.0]])
    behind = fold.behind / (2.0 * RATE)
    return np.array([[0.0, ahead, ahead], [0.0, behind, -behind]])


def _mirrored(stretch: float) -> Fold:
    """Return the fold where v of the one side is as -v (1 - stretch) / (1 + stretch)."""
    # At the rim the last place, and none beyond it.
    whole = (2.0 * RATE - 1.0) * (1.0 - abs(stretch))
    return Fold(0, round(whole / (1.0 + stretch)), -round(whole / (1.0 - stretch)))


def fold_of(model: Model) -> Fold:
    """Return how v is folded: at v = 0 where the robot is mirrored there, or not at all."""
    if model.faces != 1:
        return FLAT
    sample = uniform(model, 40 * POSTURES, SEED)
    where = model.postures(sample.params[:POSTURES])
    gravity = sample.gravity[: len(where.com)]
    u, v = gravity[..., 0] / -gravity[..., 2], np.abs(gravity[..., 1] / -gravity[..., 2])

    def tips(side: Floats) -> Floats:
        return model.tip_angle(where, model.uv_to_gravity(0, u, side))

    here = tips(v)
    best, apart, reach = 0.0, math.inf, REACH
    for _ in range(TURNS):
        for stretch in best + reach * np.linspace(-1.0, 1.0, STRETCHES):
            there = tips(-v * (1.0 - stretch) / (1.0 + stretch))
            off = float(np.abs(np.clip(here, -CLIP, CLIP) - np.clip(there, -CLIP, CLIP)).mean())
            if off < apart:
                best, apart = float(stretch), off
        reach /= 4.0
    there = tips(-v * (1.0 - best) / (1.0 + best))
    stands = np.count_nonzero((here >= 0.0) | (there >= 0.0))
    differ = np.count_nonzero((here >= 0.0) != (there >= 0.0))
    return _mirrored(best) if differ <= MOST_APART * stands else FLAT

"""Whether |SD_g| jumps: whether two points however near each other can differ by a finite amount.

With more than three contacts the support facet changes, and its centroid with it.  No table that
interpolates can bound its largest error there.
"""

from typing import NamedTuple

import numpy as np

from firmware_export.truth import Model, uniform, uniform_directions, unit
from lutgen.vector import Floats

# Halvings after which the first and the second difference is taken.  From pairs about 1 apart the
# second are some 1e-10 apart: what is smooth differs by nothing there.
EARLY, LATE = 20, 32
# A jump keeps most of its height while the distance shrinks by 2^(LATE - EARLY).
KEPT = 0.5
# Least height, in shares of the range, that is called a jump.
LEAST = 1e-3
POSTURES, DIRECTIONS, PAIRS = 48, 40, 256


class Jumps(NamedTuple):
    """`found`; `height` of the largest jump seen (length unit)."""

    found: bool
    height: float


def _sdg(model: Model, params: Floats, gravity: Floats) -> Floats:
    return model.exact(params, gravity).sdg


def _close_in(
    model: Model, params: tuple[Floats, Floats], gravity: tuple[Floats, Floats]
) -> tuple[Floats, Floats]:
    """Halve pairs of points, keeping the half over which |SD_g| changes more.

    Returns the differences (m, d) that are left after EARLY and after LATE halvings; 0 for pairs
    that came to a place where the robot tips.
    """
    (low_q, high_q), (low_g, high_g) = params, gravity
    low, high = _sdg(model, low_q, low_g), _sdg(model, high_q, high_g)
    early = np.zeros(low.shape)
    for turn in range(LATE):
        middle_q = 0.5 * (low_q + high_q)
        middle_g = unit(low_g + high_g)
        middle = _sdg(model, middle_q, middle_g)
        upper = np.abs(high - middle) > np.abs(middle - low)
        # With several directions to a posture the ends' postures are the same.
        up = upper[:, :1]
        low_q, high_q = np.where(up, middle_q, low_q), np.where(up, high_q, middle_q)
        low_g = np.where(upper[..., None], middle_g, low_g)
        high_g = np.where(upper[..., None], high_g, middle_g)
        low, high = np.where(upper, middle, low), np.where(upper, high, middle)
        if turn == EARLY:
            early = np.abs(high - low)
    return np.nan_to_num(early), np.nan_to_num(np.abs(high - low))


def find_jumps(model: Model, seed: int) -> Jumps:
    """Look for jumps of |SD_g| between directions of one posture, and between postures."""
    if model.is_tripod:
        return Jumps(False, 0.0)
    rng = np.random.default_rng([seed, 4])
    q = uniform(model, POSTURES, seed).params[:POSTURES]
    q = rng.uniform(model.lower, model.upper, (POSTURES, model.k)) if len(q) < POSTURES else q
    ends = uniform_directions(model, rng, (2, POSTURES, DIRECTIONS))
    early, late = _close_in(model, (q, q), (ends[0], ends[1]))
    values = _sdg(model, q, ends[0])
    if model.k:
        pair = rng.uniform(model.lower, model.upper, (2, PAIRS, model.k))
        ends = uniform_directions(model, rng, (2, PAIRS, 1))
        across = _close_in(model, (pair[0], pair[1]), (ends[0], ends[1]))
        early = np.concatenate([early.ravel(), across[0].ravel()])
        late = np.concatenate([late.ravel(), across[1].ravel()])
    span = float(np.nanmax(values) - np.nanmin(values)) if np.isfinite(values).any() else 0.0
    jumps = (late > KEPT * early) & (late > LEAST * span)
    return Jumps(bool(jumps.any()), float(np.max(late, where=jumps, initial=0.0)))

"""Test for jumps of |SD_g|: two points however near each other that differ by a finite amount.

With more than three contacts the support facet changes, and its centroid with it.  No table that
interpolates can bound its largest error there.
"""

from functools import lru_cache

import numpy as np

from firmware_export.model import Model, uniform_directions, uniform_params, unit
from lutgen.vector import Floats

# Halvings after which the first and the second difference is taken.  From pairs about 1 apart the
# second are some 1e-10 apart: what is smooth differs by nothing there.
EARLY, LATE = 20, 32
# A jump keeps most of its height while the distance shrinks by 2^(LATE - EARLY).
KEPT = 0.5
# Least height, in shares of the range, that is called a jump.
LEAST = 1e-3
# Postures between whose directions, and pairs of postures between which it is looked for.
POSTURES, DIRECTIONS, PAIRS, SEED = 48, 40, 96, 501


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

    Jumps are searched between directions of one posture, and between postures.
    """
    if model.is_tripod:
        return 0.0
    rng = np.random.default_rng([SEED, 4])
    here = uniform_params(model, rng, POSTURES)
    ends = uniform_directions(model, rng, (2, POSTURES, DIRECTIONS))
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

"""How far the positions that the C has of a robot given by code are from the code's.

Nothing is known of the code but its values, so the bound is of what is seen.  On a dense grid of
postures the very C is asked, in single precision.  Between two neighbours of the grid the
difference rises by about half of what it changes from one to the other; for every axis the whole
of the largest such change is added to the largest difference.  That holds for all that a grid as
dense can show.  Ends, cuts and random postures are looked at beside.
"""

import numpy as np

from firmware_export.host import Host
from firmware_export.truth import Model, combinations, widened
from lutgen.vector import Floats

# Places along each axis of the grid by the number of parameters, and other postures.
PLACES, POSTURES, SEED = (1, 20_001, 301, 46), 30_000, 13


def most_off(model: Model, host: Host, order: tuple[int, ...], knots: tuple[Floats, ...]) -> float:
    """Return a bound of how far (length) any contact of the C is from the real one.

    Parameters
    ----------
    model : Model
        The robot; looked at as far beyond its box as sensors may say.
    host : Host
        A map with its tables of positions; nothing else of it counts.
    order : tuple of int
        The recipe's contacts as the map has them.
    knots : tuple of (p,) float64
        Where the tables are cut.
    """
    box = widened(model)

    def off(params: Floats) -> Floats:
        centres = box.postures(_single(params)).centres[:, list(order)]
        return host.positions(params) - centres

    low, high = _single(box.lower), _single(box.upper)
    count = PLACES[model.k]
    grid = combinations([np.linspace(a, b, count) for a, b in zip(low, high, strict=True)])
    seen = off(grid).reshape(*(count,) * model.k, -1, 3)
    bound = float(np.sqrt((seen**2).sum(axis=-1)).max())
    for axis in range(model.k):
        between = np.diff(seen, axis=axis)
        bound += float(np.sqrt((between**2).sum(axis=-1)).max())
    others = off(_others(low, high, knots))
    return max(bound, float(np.sqrt((others**2).sum(axis=-1)).max()))


def _single(numbers: Floats) -> Floats:
    """Return numbers rounded to single precision."""
    return numbers.astype(np.float32).astype(np.float64)


def _others(low: Floats, high: Floats, knots: tuple[Floats, ...]) -> Floats:
    """Return random postures (m, k), and some on both sides of each end and cut."""
    rng = np.random.default_rng(SEED)
    params = (low + (high - low) * rng.random((POSTURES, len(low)))).astype(np.float32)
    for axis, cuts in enumerate(knots):
        single = cuts.astype(np.float32)
        beside = np.concatenate(
            [single, np.nextafter(single, low[axis]), np.nextafter(single, high[axis])]
        )
        some = slice(axis, POSTURES // 2, len(knots))
        params[some, axis] = np.clip(rng.choice(beside, len(params[some])), low[axis], high[axis])
    return params.astype(np.float64)

"""Which posture each node of the table has: among the nearly best, those that make it smooth.

Owns the selection.  The best posture alone jumps: two that are far apart are equally good, and a
robot would swing from one to the other.  Of all that are within a little of the best the one is
taken that is nearest to its neighbours' and to home, node after node until none changes.
"""

import numpy as np

from lutgen.vector import Floats

# Times that all nodes are gone through; what nearness to home counts beside that to neighbours.
ROUNDS, HOME = 40, 0.02


def choose(postures: Floats, score: Floats, home: Floats, scale: Floats, within: float) -> Floats:
    """Return the postures (n, n, k) of a table's nodes.

    Parameters
    ----------
    postures : (p, k) float64
        What there is to choose from.
    score : (n, n, p) float64
        The larger the better.
    home : (k,) float64
        Where the robot is if nothing else matters.
    scale : (k,) float64
        A move of one of each parameter.
    within : float
        By how much less than the best score will do.
    """
    n = score.shape[0]
    places = postures / scale
    away = ((places - home / scale) ** 2).sum(axis=1)
    good = score >= score.max(axis=2, keepdims=True) - within
    chosen = np.empty((n, n), np.int64)
    for i, j in np.ndindex(n, n):
        among = np.flatnonzero(good[i, j])
        chosen[i, j] = among[away[among].argmin()] if within > 0.0 else score[i, j].argmax()
    for _ in range(ROUNDS if within > 0.0 else 0):
        before = chosen.copy()
        for i, j in np.ndindex(n, n):
            among = np.flatnonzero(good[i, j])
            beside = [
                chosen[a, b]
                for a, b in ((i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1))
                if 0 <= a < n and 0 <= b < n
            ]
            apart = (
                ((places[among, None, :] - places[None, beside, :]) ** 2).sum(axis=2).sum(axis=1)
            )
            chosen[i, j] = among[(apart + HOME * away[among]).argmin()]
        if (before == chosen).all():
            break
    return np.asarray(postures[chosen])

"""Choose the posture of each node of a policy's table, and move nodes until it loses little.

The best posture of each node alone jumps, because two that are far apart are equally good.  The one
nearest to its neighbours' is taken among all that are nearly the best.  Nodes that are each nearly
the best may still have a bad posture half way, so nodes are moved where all slopes of the cells
around them lose less, together.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from lutgen.vector import Floats

# Times that all nodes are gone through; what nearness to home counts beside that to neighbours.
ROUNDS, HOME = 40, 0.02
# Slopes of a cell along each side; how often each move is tried at most.
SIDE, TRIES = 3, 2
# Moves (rad, or parts of a length's axis): of every table, and of the one that loses least.
COARSE, FINE = (0.8, 0.4, 0.2), (0.1, 0.05)


def smooth(postures: Floats, score: Floats, home: Floats, scale: Floats, within: float) -> Floats:
    """Return postures (n, n, k) of a table's nodes, each within a little of its best.

    `postures` (p, k) have a `score` (n, n, p).  Those less than `within` below the best count; with
    0 the best counts alone.  `home` (k,) is where the robot is if nothing else
    matters; a move by `scale` (k,) counts as one.
    """
    if within <= 0.0:
        return np.asarray(postures[score.argmax(axis=2)])
    n = score.shape[0]
    places = postures / scale
    away = ((places - home / scale) ** 2).sum(axis=1)
    good = score >= score.max(axis=2, keepdims=True) - within
    chosen = np.where(good, away, np.inf).argmin(axis=2)
    for _ in range(ROUNDS):
        before = chosen.copy()
        for i, j in np.ndindex(n, n):
            among = np.flatnonzero(good[i, j])
            beside = [
                chosen[a, b]
                for a, b in ((i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1))
                if 0 <= a < n and 0 <= b < n
            ]
            apart = ((places[among, None] - places[None, beside]) ** 2).sum(axis=2).sum(axis=1)
            chosen[i, j] = among[(apart + HOME * away[among]).argmin()]
        if (before == chosen).all():
            break
    return np.asarray(postures[chosen])


def polished(
    tables: Sequence[Floats],
    best: Floats,
    ends: tuple[Floats, Floats],
    scale: Floats,
    score: Callable[[Floats, Floats], Floats],
) -> Floats:
    """Return the postures (n, n, k) of a table's nodes: of some tables the best, moved.

    Moves only go downhill, so it is begun from several tables.  For marv, whose flippers turn
    all the way round, the best of each node ends at a loss of 5.3 deg, one posture for all at 0.2.
    `best` (n, n) is the score that will do at each node, and between them what lies between;
    `score` takes postures (m, k) at places (m, 2) in parts of the table's sides.
    """
    n = len(best)
    cells = np.array([*np.ndindex(n - 1, n - 1)])
    parts = (np.array([*np.ndindex(SIDE, SIDE)]) + 0.5) / SIDE
    cell, part = np.repeat(cells, len(parts), axis=0), np.tile(parts, (len(cells), 1))
    places = (cell + part) / (n - 1)
    wanted = between(best[:, :, None], cell, part)[:, 0]

    def lost(table: Floats) -> Floats:
        return np.asarray(np.maximum(wanted - score(between(table, cell, part), places), 0.0))

    def moved(values: Floats, now: Floats, step: Floats) -> tuple[Floats, Floats]:
        # Every cell has one corner of each of four kinds, so nodes of a kind move at once.
        for kind in ((0, 0), (0, 1), (1, 0), (1, 1)):
            some = np.zeros((n, n), bool)
            some[kind[0] :: 2, kind[1] :: 2] = True
            trial = np.where(some[:, :, None], np.clip(values + step, *ends), values)
            then = lost(trial)
            corner = tuple((cell + (cell + kind) % 2).T)
            gained = np.zeros((n, n))
            np.add.at(gained, corner, now - then)
            taken = some & (gained > 1e-9)
            values = np.where(taken[:, :, None], trial, values)
            now = np.where(taken[corner], then, now)
        return values, now

    def by(moves: Sequence[float], values: Floats) -> tuple[float, Floats]:
        now = lost(values)
        for move in moves:
            for _ in range(TRIES):
                before = float(now.sum())
                for step in move * np.concatenate([-np.diag(scale), np.diag(scale)]):
                    values, now = moved(values, now, step)
                if now.sum() > before - 1e-3 * (abs(before) + 1e-9):
                    break
        return float(now.sum()), values

    _, values = min((by(COARSE, table) for table in tables), key=lambda found: found[0])
    return by(FINE, values)[1]


def between(table: Floats, cell: NDArray[np.int64], part: Floats) -> Floats:
    """Return a table (n, n, k) within its cells (m, 2), in parts (m, 2) of their sides."""
    i, j = cell.T
    u, v = part.T[:, :, None]
    low = table[i, j] + (table[i, j + 1] - table[i, j]) * v
    high = table[i + 1, j] + (table[i + 1, j + 1] - table[i + 1, j]) * v
    return np.asarray(low + (high - low) * u)

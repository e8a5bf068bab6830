"""What lies between the nodes of a table: nodes are moved until slopes between them lose little.

Owns the moves and what counts as a loss.  Nodes that are each nearly the best may have a bad
posture half way; a node moves where all slopes of the cells around it lose less by that, together.
"""

from collections.abc import Callable

import numpy as np

from lutgen.vector import Floats

# Slopes of a cell along each side; moves (rad, or parts of a length's axis), one after the other;
# how often each is tried at most.
SIDE, MOVES, ROUNDS = 3, (0.2, 0.1, 0.05), 4


def polished(
    values: Floats,
    best: Floats,
    ends: tuple[Floats, Floats],
    scale: Floats,
    score: Callable[[Floats, Floats], Floats],
) -> Floats:
    """Return the postures (n, n, k) of a table's nodes, moved.

    Parameters
    ----------
    values : (n, n, k) float64
        Of the nodes, u first.
    best : (n, n) float64
        The score that will do at each node; between them what lies between is wanted.
    ends : ((k,), (k,)) float64
        Of the axes.
    scale : (k,) float64
        A move of one of each parameter.
    score : callable
        Of postures (m, k) at places (m, 2) of the table, in parts of its sides: scores (m,).
    """
    n, k = values.shape[0], values.shape[2]
    inner = (np.arange(SIDE) + 0.5) / SIDE
    cells = np.stack(np.meshgrid(np.arange(n - 1), np.arange(n - 1), indexing="ij"), axis=-1)
    parts = np.stack(np.meshgrid(inner, inner, indexing="ij"), axis=-1).reshape(-1, 2)
    cell = np.repeat(cells.reshape(-1, 2), len(parts), axis=0)
    part = np.tile(parts, ((n - 1) ** 2, 1))
    places = (cell + part) / (n - 1)
    wanted = _between(best[:, :, None], cell, part)[:, 0]

    def lost(table: Floats) -> Floats:
        return np.asarray(np.maximum(wanted - score(_between(table, cell, part), places), 0.0))

    values, now = values.copy(), lost(values)
    for move in np.array(MOVES):
        for _ in range(ROUNDS):
            before = float(now.sum())
            for axis in range(k):
                for sign in (-1.0, 1.0):
                    step = np.zeros(k)
                    step[axis] = sign * move * scale[axis]
                    values, now = _moved(values, now, step, ends, cell, lost)
            if now.sum() > before - 1e-3 * (abs(before) + 1e-9):
                break
    return values


def _moved(
    values: Floats,
    now: Floats,
    step: Floats,
    ends: tuple[Floats, Floats],
    cell: np.ndarray,
    lost: Callable[[Floats], Floats],
) -> tuple[Floats, Floats]:
    """Return a table with each node moved by a step that has slopes lose less, and their losses.

    Of the four corners of every cell one is of each kind, so that nodes of a kind move at once.
    """
    n = len(values)
    for kind in ((0, 0), (0, 1), (1, 0), (1, 1)):
        some = np.zeros((n, n), bool)
        some[kind[0] :: 2, kind[1] :: 2] = True
        trial = np.where(some[:, :, None], np.clip(values + step, *ends), values)
        then = lost(trial)
        corner = cell + (cell + kind) % 2
        gained = np.zeros((n, n))
        np.add.at(gained, tuple(corner.T), now - then)
        taken = some & (gained > 1e-9)
        values = np.where(taken[:, :, None], trial, values)
        now = np.where(taken[tuple(corner.T)], then, now)
    return values, now


def _between(table: Floats, cell: np.ndarray, part: Floats) -> Floats:
    """Return a table (n, n, k) within its cells (m, k), between four nodes."""
    i, j = cell.T
    u, v = part.T[:, :, None]
    low = table[i, j] + (table[i, j + 1] - table[i, j]) * v
    high = table[i + 1, j] + (table[i + 1, j + 1] - table[i + 1, j]) * v
    return np.asarray(low + (high - low) * u)

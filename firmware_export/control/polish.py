"""What lies between the nodes of a table: nodes are moved until slopes between them lose little.

Owns the moves and what counts as a loss.  Nodes that are each nearly the best may have a bad
posture half way; a node moves where all slopes of the cells around it lose less by that, together.
Moves only go downhill, so it is begun from several tables.  Where many joints may be combined, one
posture for all slopes is a better beginning than the best of each: of marv, whose flippers turn
all the way round, the former loses 0.2 deg in the end and the latter 5.3.
"""

from collections.abc import Callable, Sequence

import numpy as np

from lutgen.vector import Floats

# Slopes of a cell along each side; how often each move is tried at most.
SIDE, ROUNDS = 3, 2
# Moves (rad, or parts of a length's axis), one after the other: of every table, and of the one that
# loses least.
COARSE, FINE = (0.8, 0.4, 0.2), (0.1, 0.05)


def polished(
    tables: Sequence[Floats],
    best: Floats,
    ends: tuple[Floats, Floats],
    scale: Floats,
    score: Callable[[Floats, Floats], Floats],
) -> Floats:
    """Return the postures (n, n, k) of a table's nodes: of some tables the best, moved.

    Parameters
    ----------
    tables : sequence of (n, n, k) float64
        To begin from; postures of the nodes, u first.
    best : (n, n) float64
        The score that will do at each node; between them what lies between is wanted.
    ends : ((k,), (k,)) float64
        Of the axes.
    scale : (k,) float64
        A move of one of each parameter.
    score : callable
        Of postures (m, k) at places (m, 2) of the table, in parts of its sides: scores (m,).
    """
    n = len(best)
    cells = np.stack(np.meshgrid(np.arange(n - 1), np.arange(n - 1), indexing="ij"), axis=-1)
    inner = (np.arange(SIDE) + 0.5) / SIDE
    parts = np.stack(np.meshgrid(inner, inner, indexing="ij"), axis=-1).reshape(-1, 2)
    cell = np.repeat(cells.reshape(-1, 2), len(parts), axis=0)
    part = np.tile(parts, ((n - 1) ** 2, 1))
    places = (cell + part) / (n - 1)
    wanted = _between(best[:, :, None], cell, part)[:, 0]

    def lost(table: Floats) -> Floats:
        return np.asarray(np.maximum(wanted - score(_between(table, cell, part), places), 0.0))

    def by(moves: Sequence[float], values: Floats) -> tuple[float, Floats]:
        now = lost(values)
        for move in moves:
            for _ in range(ROUNDS):
                before = float(now.sum())
                for step in move * np.concatenate([-np.diag(scale), np.diag(scale)]):
                    values, now = _moved(values, now, step, ends, cell, lost)
                if now.sum() > before - 1e-3 * (abs(before) + 1e-9):
                    break
        return float(now.sum()), values

    _, values = min((by(COARSE, table) for table in tables), key=lambda found: found[0])
    return by(FINE, values)[1]


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

"""How far a body reaches in a direction: what decides where a plane touches it.

Two bodies that reach equally far in the directions from which the ground can come touch it alike,
so that a simple shape may stand for a mesh, and how far they differ is the error of a guess.
"""

import math

import numpy as np

from lutgen.vector import Floats, Ints

# Directions of a fan, and of a turn in a plane; even, so that opposite ones are among them.
RINGS, ROUND = 9, 1440
# Vertices that are asked at once, which bounds the memory.
CHUNK = 4_000
# Decimals of a metre: a guess is no better, and the same mesh in single precision or in text gives
# the same numbers.
DIGITS = 6


def reaches(points: Floats, directions: Floats) -> tuple[Floats, Ints]:
    """Return how far points (n, 3) reach in directions (d, 3), and which of them does (d,)."""
    best = np.full(len(directions), -math.inf)
    which = np.zeros(len(directions), np.int64)
    for first in range(0, len(points), CHUNK):
        high = points[first : first + CHUNK] @ directions.T
        at = high.argmax(axis=0)
        found = high[at, np.arange(len(directions))]
        better = found > best
        best[better], which[better] = found[better], first + at[better]
    return best, which


def across(direction: Floats) -> tuple[Floats, Floats]:
    """Return two unit vectors (3,) at right angles to a unit vector (3,), right-handed with it."""
    helper = np.eye(3)[int(np.argmin(np.abs(direction)))]
    first = np.cross(direction, helper)
    first /= np.linalg.norm(first)
    return first, np.cross(direction, first)


def ring(direction: Floats, angle: float, count: int = ROUND) -> Floats:
    """Return unit vectors (count, 3) evenly around a unit vector, at an angle (rad) to it."""
    first, second = across(direction)
    turn = 2.0 * math.pi / count * np.arange(count)[:, None]
    around = np.cos(turn) * first + np.sin(turn) * second
    return np.asarray(math.cos(angle) * direction + math.sin(angle) * around)


def fan(direction: Floats, angle: float) -> Floats:
    """Return unit vectors (d, 3) that fill the cone up to an angle (rad) around a unit vector."""
    rings = [ring(direction, angle * k / RINGS, 8 * k) for k in range(1, RINGS + 1)]
    return np.concatenate([direction[None], *rings])


def plain(values: Floats) -> tuple[float, ...]:
    """Return lengths (n,) as plain numbers, to a micrometre: finer than any mesh is made."""
    return tuple((np.round(values, DIGITS) + 0.0).tolist())

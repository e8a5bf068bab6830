"""Points, spheres and discs that touch a plane, and polygons in one, in plain NumPy.

A primitive is a row (8,): centre, axis (zero unless a disc), radius (zero of a point), kind.
"""

import math
from itertools import combinations

import numpy as np


def norm(v):
    return np.asarray(np.sqrt((v * v).sum(-1)))


def unit(v):
    return np.asarray(v / np.maximum(norm(v), 1e-300)[..., None])


def touch(rows, n):
    """Return the points of primitives (..., 8) that reach furthest along unit normals (..., 3)."""
    axis = rows[..., 3:6]
    return np.asarray(
        rows[..., :3] + rows[..., 6:7] * unit(n - (n * axis).sum(-1)[..., None] * axis)
    )


def reach(rows, n):
    """Return how far primitives (k, 8) reach along normals (m, 3): (m, k)."""
    return np.asarray((touch(rows, n[:, None]) * n[:, None]).sum(-1))


def sphere(count):
    """Return unit vectors spread evenly over the sphere."""
    k = np.arange(count) + 0.5
    z, turn = 1.0 - 2.0 * k / count, k * math.pi * (3.0 - math.sqrt(5.0))
    return np.stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z], -1)


def size_of(rows):
    """Return the greatest distance of a far side from the com."""
    return float((norm(rows[:, :3]) + rows[:, 6]).max())


def least_turn(a, b):
    """Return the least rotation (3, 3) from one unit vector to another."""
    x, y, z = np.cross(a, b)
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + k + k @ k / (1.0 + a @ b))


def turns(a, b):
    """Return twice the area of triangles in a plane, positive if they turn left."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def polygon(points, normal, slack):
    """Return the corners of points in a plane, counter-clockwise about the normal, by wrapping."""
    first = unit(np.cross(normal, np.eye(3)[np.argmin(abs(normal))]))
    flat = points @ np.stack([first, np.cross(normal, first)], -1)
    keep = [k for k, p in enumerate(flat) if (abs(flat[:k] - p).max(-1) > slack).all()]
    flat = flat[keep]
    chain = [int(np.argmax(norm(flat - flat.mean(0))))]
    while True:
        arm = flat - flat[chain[-1]]
        far, left = norm(arm), turns(arm[:, None], arm[None])
        good = (left >= -slack * far[:, None]).all(1) & (far > 0.0)
        at = int(np.argmax(np.where(good, far, -1.0)))
        if at in chain or not good.any():
            break
        chain.append(at)
    ahead = np.roll(flat[chain], -1, 0) - flat[chain]
    wide = (abs(turns(ahead, np.roll(ahead, 1, 0))) > slack * norm(ahead)).any()
    return np.array(keep)[chain] if wide and len(chain) > 2 else np.zeros(0, int)


def planes_of_three(rows, size):
    """Return normals of planes that touch three primitives, none below, the widest first."""
    some = np.array(list(combinations(range(len(rows)), 3)))
    even, fine = sphere(8), sphere(4000)
    three = np.sort(np.argsort(reach(rows, fine), 1)[:, -3:], 1)
    three = np.concatenate([np.repeat(some, len(even), 0), three])
    n = np.concatenate([np.tile(even, (len(some), 1)), fine])
    for _ in range(25):
        p = touch(rows[three], n[:, None])
        across = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
        n = unit(across * np.where((across * n).sum(-1) < 0.0, -1.0, 1.0)[:, None])
    h = reach(rows, n)
    altitude = norm(across) / np.maximum(norm(p[:, [1, 2, 0]] - p).max(1), 1e-300)
    mine = np.take_along_axis(h, three, 1).min(1)
    good = (h.max(1) - mine <= 1e-11 * size) & (altitude > 1e-9 * size)
    n, three = (x[good][np.argsort(-altitude[good], kind="stable")] for x in (n, three))
    once = np.unique(np.c_[three, np.rint(n * 1e7)], axis=0, return_index=True)[1]
    return np.asarray(n[np.sort(once)])

"""The verdict on many robots at once, each under directions of its own, by either search.

Owns the loop.  It goes below the public functions, which choose the search by themselves: what is
compared here is one search with another, and robots with and without noise.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lutgen.channels.angles import tip_angle
from lutgen.jit import njit
from lutgen.support.boundary import find_region
from lutgen.support.rails import find_rail_facets
from lutgen.support.region import TIPS, Acceptance, acceptance, empty_region, status_of
from lutgen.support.region import supporting_facet as pierced
from lutgen.support.rounds import find_round_facets
from lutgen.support.search import find_facets
from lutgen.support.table import facet_table, robot_size
from lutgen.support.unite import unite
from lutgen.vector import Floats, Ints, row

CHOSEN, RAILS, ROLLING = 0, 1, 2


@njit()
def _ask(
    primitives: Floats,
    acceptance: Acceptance,
    gravity_dir: Floats,
    search: int,
    status: Ints,
    angle: Floats,
) -> int:
    n, refused = primitives.shape[1], 0
    table, region = facet_table(n), empty_region(n)
    for m in range(len(primitives)):
        size = robot_size(primitives[m])
        if search == ROLLING:
            find_round_facets(table.work, primitives[m], acceptance.lowest_up, size)
        elif search == RAILS:
            refused += 0 if find_rail_facets(table.work, primitives[m], size) else 1
        else:
            find_facets(table.work, primitives[m], acceptance.lowest_up, size)
        unite(table, primitives[m], size)
        find_region(region, table, primitives[m], acceptance, size)
        for d in range(gravity_dir.shape[1]):
            g = row(gravity_dir[m], d)
            status[m, d] = status_of(region, pierced(region.facet, region.tally[0], g), g)
            angle[m, d] = tip_angle(region.tally, region.segment, status[m, d] != TIPS, g)
    return refused


def ask(
    primitives: Floats, limits: Acceptance, gravity_dir: Floats, search: int = CHOSEN
) -> tuple[NDArray[np.int64], Floats]:
    """Return status and tip angle (rad), both (m, d), of robots (m, n, 8) under unit directions.

    `gravity_dir` (m, d, 3); `search` one of CHOSEN, RAILS, ROLLING.
    """
    status = np.empty(gravity_dir.shape[:2], np.int64)
    angle = np.empty(gravity_dir.shape[:2])
    if _ask(np.ascontiguousarray(primitives), limits, gravity_dir, search, status, angle):
        raise ValueError("a robot without parallel axes was given to the closed form")
    return status, angle


# The default limits: deg, and parts of the size.
UPRIGHT, ROCK, WIDTH, NEAR = 80.0, 30.0, 0.01, 1e-4


def limits_for(
    size: float,
    upright: float = UPRIGHT,
    rock: float = ROCK,
    width: float = WIDTH,
    near: float = NEAR,
) -> Acceptance:
    """Return the default limits of robots of a size; angles in deg, lengths in sizes."""
    return acceptance(math.radians(upright), math.radians(rock), 0.0, width * size, near * size)


def directions(rng: np.random.Generator, robots: int, count: int) -> Floats:
    """Return unit directions (robots, count, 3), all of them downwards."""
    found = rng.standard_normal((robots, count, 3))
    found[..., 2] = -np.abs(found[..., 2]) - 0.3
    return np.asarray(found / np.linalg.norm(found, axis=-1, keepdims=True))

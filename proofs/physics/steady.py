"""What must hold of the verdict whatever the engine says: steady under noise, derived twice.

python -m proofs.physics.steady [--all]

Prints robots with noise against robots without, the closed form for parallel axes against the
search that rolls, and regions with stricter limits against wider ones.  Exits with 1 where one is
wrong.  `--all` takes 10,000 robots with noise and 100,000 random ones.
"""

import argparse
import sys
from collections.abc import Sequence

import numpy as np

from lutgen.support import DISC, pack
from lutgen.support.region import TIPS
from lutgen.vector import Floats
from proofs.physics.asked import RAILS, ROLLING, ask, directions, limits_for
from proofs.physics.noise import KINDS, NOISES, Compared, compared, table

COUNTS = (3, 4, 5, 6, 8, 12)
# rad; nearer to the boundary than this rounding may say either.
CLEAR = 1e-6
# Absolem with both rims of each flipper branches where it rolls, and a branch is a threshold: of so
# many robots in a thousand some direction changes.
BRANCHING = {"absolem, both rims": 40}
# From this noise on postures near a threshold (rest_width, rock_angle, upright) cross it: so many
# robots in a thousand.
COARSE, NEAR = 1e-4, 12


def parallel_robots(rng: np.random.Generator, contacts: int, count: int) -> Floats:
    """Return random robots (count, contacts, 8) whose axes are all y: discs and points."""
    robots = []
    for _ in range(count):
        kind = rng.integers(4)
        centres = rng.uniform([-1.0, -0.6, -0.7], [1.0, 0.6, -0.1], (contacts, 3))
        radius = rng.uniform(0.03, 0.3, contacts)
        if kind == 0:
            centres[:, 1] = rng.choice([-0.5, -0.4, 0.4, 0.5], contacts)
        elif kind == 1:
            centres[:, 1], centres[:, 2], radius[:] = rng.choice([-0.5, 0.5], contacts), -0.4, 0.15
        elif kind == 2:
            radius[1:][rng.random(contacts - 1) < 0.4] = 0.0
        axes = np.where(radius[:, None] > 0.0, [0.0, 1.0, 0.0], 0.0)
        robots.append(pack(centres, axes, radius, np.where(radius > 0.0, DISC, 0)))
    return np.array(robots)


def derived_twice(contacts: int, robots: int, seed: int = 0) -> tuple[int, int]:
    """Return of how many random robots the two derivations differ, and how many were tried."""
    rng = np.random.default_rng([seed, contacts])
    primitives, limits = parallel_robots(rng, contacts, robots), limits_for(1.0)
    gravity_dir = directions(rng, robots, 40)
    status, angle = ask(primitives, limits, gravity_dir, RAILS)
    other, other_angle = ask(primitives, limits, gravity_dir, ROLLING)
    clear = np.minimum(np.abs(angle), np.abs(other_angle)) > CLEAR
    return int((((status == TIPS) != (other == TIPS)) & clear).any(axis=1).sum()), robots


def enlarged(robots: int, seed: int = 0) -> tuple[int, int]:
    """Return in how many cases a stricter limit made a robot stand that tipped, and of how many.

    A larger `rest_width`, and a smaller `rock_angle`, by random factors.
    """
    rng = np.random.default_rng([seed, 99])
    primitives = parallel_robots(rng, 6, robots)
    gravity_dir = directions(rng, robots, 60)
    wrong = 0
    for strict in range(2):
        for _ in range(4):
            width, rock = 10.0 ** rng.uniform(-3.0, -0.5), rng.uniform(2.0, 60.0)
            wide = limits_for(1.0, rock=rock, width=width)
            factor = rng.uniform(1.1, 3.0)
            narrow = limits_for(
                1.0,
                rock=rock / (factor if strict == 0 else 1.0),
                width=width * (factor if strict == 1 else 1.0),
            )
            before, angle = ask(primitives, wide, gravity_dir)
            after, other = ask(primitives, narrow, gravity_dir)
            clear = np.minimum(np.abs(angle), np.abs(other)) > CLEAR
            wrong += int(((before == TIPS) & (after != TIPS) & clear).any(axis=1).sum())
    return wrong, 8 * robots


def _allowed(one: Compared) -> int:
    """Return of how many robots in a thousand a direction may change."""
    return max(BRANCHING.get(one.kind, 0), NEAR if one.noise >= COARSE else 0)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the three comparisons."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--all", action="store_true", help="run the long counts")
    long = parser.parse_args(arguments).all
    robots = 1250 if long else 60
    rows = [compared(kind, noise, robots) for noise in NOISES for kind in KINDS]
    print(f"Robots of {robots} that noise makes falsely safe / falsely tip\n\n{table(rows)}\n")
    faults = [one for one in rows if max(one.safe, one.tips) * 1000 > _allowed(one) * one.robots]
    twice = [derived_twice(contacts, 16_667 if long else 500) for contacts in COUNTS]
    differ, tried = sum(one[0] for one in twice), sum(one[1] for one in twice)
    print(f"Derived twice: {differ} of {tried} random robots with parallel axes differ")
    wrong, cases = enlarged(1250 if long else 125)
    print(f"Stricter limits: the region is larger in {wrong} of {cases} cases")
    for fault in faults:
        print(f"missed: {fault}", file=sys.stderr)
    return 1 if faults or differ or wrong else 0


if __name__ == "__main__":
    sys.exit(main())

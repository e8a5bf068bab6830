"""What must hold of the verdict whatever the engine says: steady under noise, derived twice.

python -m proofs.physics.steady [--all] [--update]

Prints robots with noise against robots without, the closed form for parallel axes against the
search that rolls, and regions with stricter limits against wider ones.  Exits with 1 where one is
wrong.  `--all` takes 10,000 robots for each noise, 100,000 random ones and 10,000 stricter limits;
`--update` writes what is printed into docs/measured/steady.md.
"""

import argparse
import json
import sys
from collections.abc import Sequence

import numpy as np

import lutgen
from lutgen.support import DISC, pack
from lutgen.support.region import TIPS
from lutgen.vector import Floats
from proofs.physics.asked import RAILS, ROLLING, ask, directions, limits_for
from proofs.physics.doubts import let_go
from proofs.physics.noise import KINDS, NOISES, Compared, compared, listed, table
from proofs.physics.page import MEASURED, page

PAGE, STORED = MEASURED / "steady.md", MEASURED / "steady.json"
COUNTS = (3, 4, 5, 6, 8, 12)
# rad; nearer to the boundary than this rounding may say either.
CLEAR = 1e-6
# From this noise on it is no longer small beside the 4 cm between two rims, or the millimetre by
# which one wheel is larger than another: so many robots in a thousand falsely tip, and of those
# whose flippers roll over four rails so many in a thousand have a direction that is falsely safe,
# of which the engine has to say that none falls.
COARSE, ROUGH, PARTED = 1e-4, 24, 2
# With both rims of each flipper so many in a thousand falsely tip at any noise: where three of four
# rims on an axle carry for a moment is rounding.
BRANCHING = {"absolem, both rims": 2}
# So many in a thousand may be left out, being near a threshold.
LEFT = 10


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


def missed(one: Compared) -> bool:
    """Tell whether more robots of a kind change than may; where any may, one more of a few."""
    coarse = one.noise >= COARSE
    rates = (
        (one.tips, ROUGH if coarse else BRANCHING.get(one.kind, 0)),
        (one.safe, PARTED if coarse and one.kind.startswith("absolem") else 0),
        (sum(one.near), LEFT if coarse or one.kind in BRANCHING else 0),
    )
    return any(
        1000 * found > (1000 + rate * one.robots if rate > 0 else 0) for found, rate in rates
    )


def write(tables: dict[str, str]) -> None:
    """Write tables and what they were made with into the page."""
    text = PAGE.read_text(encoding="utf-8")
    for name, content in tables.items():
        text = page(text, name, content)
    PAGE.write_text(text, encoding="utf-8")
    STORED.write_text(json.dumps(tables, indent=1) + "\n", encoding="utf-8")


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the three comparisons."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--all", action="store_true", help="run the long counts")
    parser.add_argument("--update", action="store_true", help=f"write {PAGE.name}, {STORED.name}")
    options = parser.parse_args(arguments)
    long = options.all
    robots = 1250 if long else 60
    rows = [compared(kind, noise, robots) for noise in NOISES for kind in KINDS]
    twice = [derived_twice(contacts, 16_667 if long else 500) for contacts in COUNTS]
    differ, tried = sum(one[0] for one in twice), sum(one[1] for one in twice)
    wrong, cases = enlarged(1250 if long else 125)
    fates = [let_go(*suspect) for one in rows for suspect in one.suspects]
    gone, fell = sum(one[0] for one in fates), sum(one[1] for one in fates)
    tables = {
        "run": f"Measured with lutgen {lutgen.__version__}, {'long' if long else 'short'} counts: "
        f"{robots:,} robots of each kind and noise.\n",
        "noise": table(rows),
        "near": listed(rows),
        "doubts": f"{fell:,} of {gone:,} fell.\n",
        "twice": f"{differ:,} of {tried:,} random robots differ.\n",
        "stricter": f"The region is larger in {wrong:,} of {cases:,} cases.\n",
    }
    for name, content in tables.items():
        print(f"{name}\n{content}")
    if options.update:
        write(tables)
    faults = [one for one in rows if missed(one)]
    for fault in faults:
        print(f"missed: {fault[:-1]}", file=sys.stderr)
    return 1 if faults or fell or differ or wrong else 0


if __name__ == "__main__":
    sys.exit(main())

"""Random robots, points, balls and discs of many sizes: C never says more than the definition."""

from functools import partial

import numpy as np
import pytest

from lutgen.recipe import load_recipe
from tests.fixtures.drawn_robots import car_with_flippers, rocker_bogie
from tests.fixtures.many_library import Library, compared, near_and_far, postures_of
from tests.fixtures.odd_robots import boxed_tracks, odd_rails, odd_robot, six_feet, two_rims
from tests.fixtures.recipes import quadruped

# Each was once told a larger angle than the definition has, or safe where it tips: sides of gaps
# beside a ball of another size (32, 71), between rims that turn at different paces or that another
# gap cuts (7, 80, 110, 748), whose roll was too coarse (438, 466), wheels that lie on their faces
# (24, 447, 725), corners of which both walls are behind by rounding (1737), a ball between a wheel
# and another ball that all but touch one plane (1392).  Of 9012 the definition found no facet.
ONCE_WRONG = (7, 24, 32, 71, 80, 110, 438, 447, 466, 725, 748, 1392, 1737, 9012)
# On parallel axles: a roll that was summed over the contact that goes the longer way (1045), gaps
# whose far end a com just above its facets sees on the hither side (3271).
ONCE_WRONG_RAILS = (1045, 3271)
# Any other robot: the first ones.
ROBOTS = [(odd_robot, seed) for seed in sorted({*ONCE_WRONG, *range(2)})]
ROBOTS += [(odd_rails, seed) for seed in sorted({*ONCE_WRONG_RAILS, *range(2)})]
# Rolls of the C are parabolas, and its sides of gaps are brought in by products that are not
# normalised: seed 80 is told this much more (rad), all others nothing.
MORE = 3e-5


@pytest.mark.parametrize(("make", "seed"), ROBOTS)
def test_no_robot_is_told_more_than_the_definition_says(make, seed):
    recipe, rng = make(seed), np.random.default_rng(seed + 1000)
    params = postures_of(recipe, rng, 100 if recipe.parameters else 1)
    robot = Library(recipe)
    assert (len(robot.export.tables.many.first) > 1) == (make is odd_rails)
    found = compared(robot, params, near_and_far(recipe, params, rng, 40, 40), MORE)
    # Random robots give some gaps and facets up, those with a wheel on its face some rests.
    lying = seed in (24, 447, 725)
    assert (found.safe & found.stands).sum() > (0.0 if lying else 0.6) * found.stands.sum()


# Wheels and balls whose centres are nearly on one line: their radii tell how the planes below them
# lean.  A search that began with the plane of the centres lost whole rests.
IN_A_ROW = ((5003, 1.917837), (5161, -2.356194), (5225, 2.356194), (5577, -1.904113))
# Coordinates with six digits: a foot is within rounding of one plane and not of the next, and of
# what stood 12 to 46 % was called unsafe where facets of some feet hid that of all.
NEARLY_LEVEL = (("ball", 0), ("disc", 5), ("point", 7))
LOST = {f"in a row {seed}": (partial(odd_robot, seed), [angle]) for seed, angle in IN_A_ROW}
LOST |= {f"{shape} feet": (partial(six_feet, shape, seed), [0.03]) for shape, seed in NEARLY_LEVEL}
# One edge lets it go over two parts of the line, and what is between them holds longer than what is
# left beyond.
LOST |= {"gap of two parts": (partial(odd_robot, 5105), [2.432524])}
# Two pairs of flippers alike: pieces of the exact definition lost more there than the guard.
ALIKE = [2.8382704, 2.8382704, -2.8382704, -2.8382704]
LOST |= {"flippers alike": (partial(load_recipe, "recipe:marv"), ALIKE)}

# The plane turns by more than a right angle from the first facet before it faces up.
STEEP = np.radians(
    [
        [-28.5, 79.9, -123.3, 4.9, -13.8, -41.9, -29.0, 48.8, -55.6, -12.2, -19.2, -136.3],
        [-29.8, 38.7, -139.0, 30.0, 47.4, -53.8, -19.4, 21.5, -139.5, -10.1, 45.3, -68.8],
        [-11.6, 11.1, -129.0, 10.0, 40.1, -43.7, -26.2, -13.8, -128.5, -10.1, -6.5, -59.5],
    ]
)
LOST |= {"steep": (quadruped, STEEP)}


@pytest.mark.parametrize("name", LOST)
def test_what_was_once_lost_is_told_safe_and_no_more(name):
    make, place = LOST[name]
    params = np.repeat(np.atleast_2d(place), 40, axis=0).astype(np.float32)
    recipe, rng = make(), np.random.default_rng(1)
    found = compared(Library(recipe), params, near_and_far(recipe, params, rng, 30, 60), MORE)
    assert found.clear.mean() > 0.1
    assert found.safe[found.clear].mean() > (0.9 if name == "gap of two parts" else 0.99)


@pytest.mark.parametrize(
    ("seed", "params", "gravity"),
    [
        # Rolls over two edges in a row: each rounds by how much the com rises.
        (4009, (0.17325874,), (-0.68448699, -0.17543611, -0.70760137)),
        # A wheel that leans goes along its rim at an uneven pace: halfway is not in the middle.
        (4029, (2.22512722, -1.87216735, -2.90233254), (0.18634935, 0.68403447, -0.7052452)),
    ],
)
def test_directions_that_were_once_told_more_on_rails(seed, params, gravity):
    compared(Library(odd_rails(seed)), np.float32([params]), np.float32([[gravity]]), MORE)


# On the rims of wheels corners that a sliver between two facets once made a rest of, 12 deg above
# the truth; and those of few digits, of which 2 to 44 % of what stood was called unsafe.
BOXED = [(0, 0.0), (28, 0.0), (109, 0.0), (0, 1e-6), (115, 1e-6), (22, 1e-5), (50, 3e-5)]
DRAWN = {f"boxed {one}": (partial(boxed_tracks, *one), 0.998 if one[1] else 0.98) for one in BOXED}
DRAWN |= {"car": (car_with_flippers, 0.98), "rocker": (rocker_bogie, 0.98)}


@pytest.mark.parametrize("name", DRAWN)
def test_robots_as_designers_draw_them_lose_little_and_gain_nothing(name):
    make, least = DRAWN[name]
    recipe, rng = make(), np.random.default_rng(1003)
    params = postures_of(recipe, rng, 60)
    found = compared(Library(recipe), params, near_and_far(recipe, params, rng, 30, 60))
    assert found.safe[found.clear].mean() > least
    # The guard alone is 0.0057 deg; where a wheel's two rims come between two rests less is held.
    off = np.degrees(found.true - found.told)[found.stands & found.safe]
    assert np.quantile(off, 0.75) < 0.02


def test_of_a_wheel_of_two_rims_either_may_be_the_corner_of_a_rest():
    # Flippers that are nearly straight down put four pairs of rims next to one plane.  Rounding
    # tells which rim of a pair is a facet's corner, and over the side between both nobody was
    # asked to go: a gap was held 0.07 deg too far.
    recipe, rng = two_rims(), np.random.default_rng(8)
    down = np.where(rng.random((150, 4)) < 0.5, -1.0, 1.0) * np.pi / 2.0
    off = rng.choice([0.0, 0.005, 0.02], (150, 4)) * rng.random((150, 4))
    params = (down * (1.0 - off)).astype(np.float32)
    # The guard is 1e-4; which of two facets a wedge between rims is of may alter as much again.
    found = compared(Library(recipe), params, near_and_far(recipe, params, rng, 40, 1), 1e-4)
    assert found.safe[found.stands & (found.true > 1e-3)].mean() > 0.98

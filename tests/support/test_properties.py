"""Claims that hold for every robot, searched for counterexamples by hypothesis.

Robots are feet at real places, which are generic, or at whole numbers: coplanar, collinear and
repeated contacts and a com in the plane of the contacts turn up by themselves.
"""

from itertools import combinations
from math import nan, pi, radians

import numpy as np
import pytest
from hypothesis import Phase, assume, given, settings
from hypothesis import strategies as st

import lutgen
from lutgen.errors import InputError
from lutgen.quantities import CHANNELS
from tests.fixtures.recipes import contact, feet, rigid
from tests.oracles.primitives import norm, unit
from tests.support.postures import assert_one_verdict

LENGTHS = ("sdg", "height", "margin", "energy_margin")
LIMITS = (radians(90.0), radians(30.0))
DOWN = np.array([[0.0, 0.0, -1.0]])

# The same examples on every run; shrinking a counterexample takes minutes: add Phase.shrink.
bounded = settings(
    deadline=None,
    derandomize=True,
    database=None,
    max_examples=60,
    report_multiple_bugs=False,
    phases=(Phase.explicit, Phase.generate),
)
seeds = st.integers(0, 2**32 - 1)
whole = st.integers(-2, 2).map(float)
whole_robots = st.lists(st.tuples(whole, whole, whole), min_size=3, max_size=7).map(np.array)
real = st.floats(-1.0, 1.0, allow_subnormal=False).map(lambda x: round(x, 6))
real_robots = st.lists(
    st.tuples(real, real, st.floats(-1.0, -0.1).map(lambda x: round(x, 6))), min_size=3, max_size=8
).map(np.array)


def directions(seed, count):
    """Return unit directions: half of them anywhere, half of them within 60 deg of -z."""
    rng = np.random.default_rng(seed)
    g = rng.normal(size=(count, 3))
    g[::2] = np.c_[rng.uniform(-1.0, 1.0, (len(g[::2]), 2)), -np.ones(len(g[::2]))]
    return unit(g)


def judged(contacts, gravity, limits=LIMITS):
    """Return all channels (g,) of one posture (n, 3)."""
    got = lutgen.stability(contacts[None], gravity, CHANNELS, *(limits or (None, None)))
    return {name: got[name][0] for name in CHANNELS}


def assume_steady(contacts, gravity):
    """Leave out robots whose facets hang on rounding, and directions on an edge."""
    size = float(norm(contacts).max())
    for three in combinations(range(len(contacts)), 3):
        a, b, c = contacts[list(three)]
        across = np.cross(b - a, c - a)
        assume(float(norm(across)) > 1e-3 * size**2)
        off = np.abs((contacts - a) @ unit(across))
        assume((np.delete(off, three) > 1e-4 * size).all())
        assume(abs(float(a @ unit(across))) > 1e-4 * size)
    i, j = np.triu_indices(len(contacts), 1)
    clear = np.abs(gravity @ unit(np.cross(contacts[i], contacts[j])).T).min(axis=1) > 1e-6
    assume(bool(clear.any()))
    return np.asarray(gravity[clear])


def assert_same(got, want, scale=1.0):
    """Compare up to rounding; lengths are `scale` times as long, and the facet has its own number.

    1e-16 times how badly conditioned the robots drawn here are.
    """
    for name in LENGTHS:
        # Margins divide by the sine between gravity and an edge; near it they are large.
        finite = ~(np.abs(want[name]) > 1e3)
        expected = pytest.approx(
            scale * want[name][finite], rel=1e-7, abs=1e-9 * scale, nan_ok=True
        )
        assert got[name][finite] == expected
    # asin near +-pi/2 turns 1e-16 into 1e-8.
    assert got["tip_angle"] == pytest.approx(want["tip_angle"], abs=1e-7)
    assert (got["status"] == want["status"]).all()


@bounded
@given(real_robots, seeds)
def test_turning_mirroring_scaling_and_numbering_change_nothing_but_the_lengths(contacts, seed):
    gravity = assume_steady(contacts, directions(seed, 12))
    rng = np.random.default_rng(seed)
    free, limited = judged(contacts, gravity, None), judged(contacts, gravity)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    assert_same(judged(contacts @ turn.T, gravity @ turn.T, None), free)
    # With limits the vertical stays what it is.
    c, s = np.cos(rng.uniform(0.0, 2.0 * pi) + np.array([0.0, pi / 2.0]))
    about = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    assert_same(judged(contacts @ about.T, gravity @ about.T), limited)
    mirror = np.array([-1.0, 1.0, 1.0])
    assert_same(judged(contacts * mirror, gravity * mirror), limited)
    factor = 10.0 ** rng.uniform(-6.0, 6.0)
    assert_same(judged(factor * contacts, gravity), limited, factor)
    assert_same(judged(rng.permutation(contacts), gravity), limited)
    # 4 is a power of two: the unit vectors are the same to the last bit.
    assert_same(judged(contacts, 4.0 * gravity), limited)


@bounded
@given(real_robots, seeds, st.floats(-8.0, 0.5), st.sampled_from(["point", "ball", "disc"]))
def test_tip_angle_changes_by_no_more_than_gravity_turns(contacts, seed, exponent, kind):
    start = directions(seed, 40)
    stop = unit(start + 10.0**exponent * np.random.default_rng(seed + 1).normal(size=start.shape))
    turned = 2.0 * np.arcsin(np.minimum(norm(start - stop) / 2.0, 1.0))
    if kind == "point":
        before, after = (judged(contacts, g)["tip_angle"] for g in (start, stop))
    else:
        axis = (0, 1, 0) if kind == "disc" else None
        text = "".join(contact(f"c{k}", at, 0.1, axis) for k, at in enumerate(contacts.tolist()))
        recipe = lutgen.parse_recipe(rigid(text))
        before, after = (
            lutgen.evaluate(recipe, [[]], g, ("tip_angle",))["tip_angle"][0] for g in (start, stop)
        )
    # 3e-8: asin within 1e-16 of +-1.
    assert (np.abs(after - before) <= turned + 3e-8).all()


@settings(bounded, max_examples=150)
@given(st.one_of(whole_robots, real_robots), seeds, st.booleans())
def test_all_channels_tell_the_same_verdict(contacts, seed, limited):
    edges = unit(contacts + np.roll(contacts, 1, axis=0) + 1e-9)
    gravity = np.concatenate((directions(seed, 12), np.eye(3), -np.eye(3), edges))
    got = judged(contacts, gravity, LIMITS if limited else None)
    tips = got["tip_angle"] < 0.0
    assert (np.abs(got["tip_angle"]) <= pi).all()
    assert_one_verdict(got)
    assert ((got["energy_margin"] < 0.0) == tips).all()
    assert not np.isnan([got["margin"], got["energy_margin"]]).any()


def test_exactly_on_a_shared_edge_it_stands_and_on_an_axis_with_tip_angle_zero():
    cube = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    ways = np.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)])
    ways = ways[norm(ways) > 0]
    assert (judged(cube / 3.0, ways, None)["tip_angle"] == pi).all()
    table = cube[cube[:, 2] < 0.0]
    rim = np.array([[1.0, t, -1.0] for t in (-1.0, -0.3, 0.0, 0.7, 1.0)])
    # The last digit of a product.
    angle = judged(table, rim)["tip_angle"]
    assert ((angle >= 0.0) & (angle < 1e-15)).all()
    assert (judged(table, rim)["status"] == 0.0).all()
    # Lying exactly on its side at an upright of 90 deg it does not.
    assert judged(cube, np.array([[1.0, 0.0, 0.0]]))["tip_angle"].item() < 0.0


@pytest.mark.parametrize("bad", [nan, np.inf])
def test_numbers_that_are_none_shapes_and_unknown_channels_are_refused(bad):
    table = np.array([[1.0, 1, -1], [-1, 1, -1], [-1, -1, -1], [1, -1, -1]])
    broken = table.copy()
    broken[1, 2] = bad
    for contacts, gravity, channels in (
        (broken, DOWN, ("sdg",)),
        (table[:2], DOWN, ("sdg",)),
        (table[:, :2], DOWN, ("sdg",)),
        (np.zeros((63, 3)), DOWN, ("sdg",)),
        (table, [[0.0, 0.0, 0.0]], ("sdg",)),
        (table, [[0.0, bad, -1.0]], ("sdg",)),
        (table, [[0.0, -1.0]], ("sdg",)),
        (table, DOWN, ("stability",)),
    ):
        with pytest.raises(InputError):
            lutgen.stability(contacts, gravity, channels)
    with pytest.raises(lutgen.RecipeError, match="3 to 62 contacts"):
        lutgen.parse_recipe(rigid(feet([(0, 0, -1)] * 63)))

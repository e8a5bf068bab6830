"""Claims that hold for every robot, searched for counterexamples by hypothesis.

Robots are feet at real places, which are generic, or at whole numbers: coplanar, collinear and
repeated contacts and a com in the plane of the contacts turn up by themselves.
"""

from math import nan, pi, radians

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import lutgen
from lutgen.errors import InputError
from lutgen.quantities import CHANNELS
from tests.fixtures.recipes import contact, feet, rigid
from tests.oracles.primitives import norm, unit
from tests.oracles.standing import Limits
from tests.support.postures import FAMILIES, assert_one_verdict, below, drawn, read

LENGTHS = ("sdg", "height", "margin", "energy_margin")
LIMITS = (radians(90.0), radians(30.0))
DOWN = np.array([[0.0, 0.0, -1.0]])

# The same examples on every run; shrinking a counterexample takes minutes: add Phase.shrink.
bounded = settings(max_examples=60, phases=(Phase.explicit, Phase.generate))
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


@pytest.mark.parametrize(
    ("family", "free"), [*((family, False) for family in FAMILIES), ("points", True)]
)
def test_turning_mirroring_scaling_and_numbering_change_nothing_but_the_lengths(family, free):
    for seed in range(40):
        rng = np.random.default_rng(seed)
        rows, g, factor = drawn(family, rng), below(rng, 12), 10.0 ** rng.uniform(-6.0, 6.0)
        # With limits the vertical stays what it is.
        turn = Rotation.from_rotvec(rng.normal(size=3) * [free, free, 1.0]).as_matrix()
        turn *= rng.choice([-1.0, 1.0], (3, 1)) if free else [-1.0, 1.0, 1.0]
        moved = rng.permutation(rows)
        moved[:, :6] = np.hstack([factor * moved[:, :3] @ turn.T, moved[:, 3:6] @ turn.T])
        moved[:, 6] *= factor
        before, after = (
            read(one, down, CHANNELS, Limits() if free else None)
            for one, down in ((rows, g), (moved, g @ turn.T))
        )
        # The facet has its own number.
        for name in set(CHANNELS) - {"facet"}:
            scale = factor if name in LENGTHS else 1.0
            np.testing.assert_allclose(after[name], scale * before[name], 1e-7, 1e-7 * scale)


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

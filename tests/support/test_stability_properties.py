"""Claims that hold for every robot, searched for counterexamples by hypothesis.

Robots come from two sources: real coordinates (generic, for invariances) and small whole
numbers (for everything that must hold on degenerate input as well: coplanar, collinear and
repeated contacts and the centre of mass in the contact plane turn up by themselves).
"""

from itertools import pairwise
from math import degrees, inf, nan, pi, radians

import numpy as np
import pytest
from hypothesis import Phase, assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

import lutgen
from lutgen.recipe.recipe import Recipe
from tests.oracles import points as oracle
from tests.oracles.points import Floats, unit

CHANNELS = ("sdg", "height", "tip_angle", "margin", "energy_margin", "facet")
LENGTHS = ("sdg", "height", "margin", "energy_margin")
LIMITS = (radians(90.0), radians(30.0))
DOWN = np.array([[0.0, 0.0, -1.0]])

# Two evaluations of one quantity by different roundings, per unit of size: 1e-16 times the
# conditioning of the robots drawn here.
SAME = 1e-9

# The same examples on every run; compiling a kernel inside the first one takes seconds, and
# shrinking a counterexample takes minutes: add Phase.shrink for a smaller one.
bounded = settings(
    deadline=None,
    derandomize=True,
    database=None,
    max_examples=60,
    report_multiple_bugs=False,
    phases=(Phase.explicit, Phase.generate),
)

seeds = st.integers(0, 2**32 - 1)
counts = st.integers(3, 8)
whole = st.integers(-2, 2).map(float)
whole_robots = st.lists(st.tuples(whole, whole, whole), min_size=3, max_size=7).map(np.array)
real = st.floats(-1.0, 1.0, allow_subnormal=False).map(lambda x: round(x, 6))
real_robots = st.lists(
    st.tuples(real, real, st.floats(-1.0, -0.1).map(lambda x: round(x, 6))), min_size=3, max_size=8
).map(np.array)


def directions(seed: int, count: int) -> Floats:
    """Gravity directions (count, 3): half of them anywhere, half of them within 60 deg of -z."""
    rng = np.random.default_rng(seed)
    around = rng.normal(size=(count, 3))
    around[::2] = np.column_stack(
        (rng.uniform(-1.0, 1.0, (len(around[::2]), 2)), -np.ones(len(around[::2])))
    )
    return unit(around)


def rotation(seed: int) -> Floats:
    """Uniformly random rotation matrix (3, 3)."""
    turned, upper = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    turned = turned * np.sign(np.diag(upper))
    return np.asarray(turned * np.sign(np.linalg.det(turned)))


def judged(
    contacts: Floats, gravity: Floats, limits: tuple[float, float] | None = None
) -> dict[str, Floats]:
    """All channels (g,) of one posture (n, 3)."""
    upright, rock_angle = limits or (None, None)
    got = lutgen.stability(contacts[None], gravity, CHANNELS, upright, rock_angle)
    return {name: got[name][0] for name in CHANNELS}


def assume_steady(contacts: Floats) -> None:
    """Leave out robots whose set of facets hangs on rounding: only invariances need that.

    Every triple's plane is well defined, and every other contact and the centre of mass are
    clear of it by far more than any documented tolerance.
    """
    size = oracle.size_of(contacts)
    rows = np.array([(i, j, k) for i in range(len(contacts)) for j in range(i) for k in range(j)])
    corner = contacts[rows]
    across = oracle.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    area = oracle.length(across)
    assume(float(area.min()) > 1e-3 * size**2)
    normal = across / area[:, None]
    level = (normal * corner[:, 0]).sum(axis=1)
    assume(float(np.abs(level).min()) > 1e-4 * size)
    off = np.abs(normal @ contacts.T - level[:, None])
    for row, triple in enumerate(rows):
        others = np.delete(off[row], triple)
        assume(not len(others) or float(others.min()) > 1e-4 * size)


def assume_clear(contacts: Floats, gravity: Floats) -> Floats:
    """Directions that are not on an edge of the robot, where a tie rule may pick the facet."""
    first, second = np.triu_indices(len(contacts), 1)
    planes = unit(oracle.cross(contacts[first], contacts[second]))
    clear = np.abs(gravity @ planes.T).min(axis=1) > 1e-6
    assume(bool(clear.any()))
    return np.asarray(gravity[clear])


def assert_same(got: dict[str, Floats], want: dict[str, Floats], size: float) -> None:
    """Compare up to rounding (facet: same verdict, its index may differ)."""
    for name in LENGTHS:
        # Margins divide by the sine between gravity and an edge; near it they are large.
        finite = np.abs(want[name]) < 1e3 * size
        assert got[name][finite] == pytest.approx(want[name][finite], rel=1e-7, abs=SAME * size)
        assert (np.isnan(got[name]) == np.isnan(want[name])).all()
    # asin near +-pi/2 turns 1e-16 into 1e-8.
    assert got["tip_angle"] == pytest.approx(want["tip_angle"], abs=1e-7)
    assert ((got["facet"] >= 0) == (want["facet"] >= 0)).all()


@bounded
@given(real_robots, seeds)
def test_rotating_robot_and_gravity_together_leaves_every_channel_unchanged(
    contacts: Floats, seed: int
) -> None:
    assume_steady(contacts)
    gravity = assume_clear(contacts, directions(seed, 12))
    turn = rotation(seed)
    want = judged(contacts, gravity)
    got = judged(contacts @ turn.T, gravity @ turn.T)
    assert_same(got, want, oracle.size_of(contacts))


@bounded
@given(real_robots, seeds, st.floats(0.0, 360.0))
def test_turning_about_the_vertical_keeps_every_channel_with_limits_on(
    contacts: Floats, seed: int, heading: float
) -> None:
    assume_steady(contacts)
    gravity = assume_clear(contacts, directions(seed, 12))
    cosine, sine = np.cos(radians(heading)), np.sin(radians(heading))
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    want = judged(contacts, gravity, LIMITS)
    got = judged(contacts @ turn.T, gravity @ turn.T, LIMITS)
    assert_same(got, want, oracle.size_of(contacts))


@bounded
@given(real_robots, seeds, st.floats(-6.0, 6.0))
def test_scaling_the_robot_scales_lengths_and_keeps_angles(
    contacts: Floats, seed: int, exponent: float
) -> None:
    assume_steady(contacts)
    gravity = assume_clear(contacts, directions(seed, 12))
    factor = 10.0**exponent
    want = judged(contacts, gravity, LIMITS)
    got = judged(factor * contacts, gravity, LIMITS)
    for name in LENGTHS:
        want[name] = factor * want[name]
    assert_same(got, want, factor * oracle.size_of(contacts))


@bounded
@given(real_robots, seeds, st.sampled_from([0, 1]))
def test_a_mirrored_robot_under_mirrored_gravity_is_as_stable(
    contacts: Floats, seed: int, across: int
) -> None:
    assume_steady(contacts)
    gravity = assume_clear(contacts, directions(seed, 12))
    mirror = np.ones(3)
    mirror[across] = -1.0
    want = judged(contacts, gravity, LIMITS)
    got = judged(contacts * mirror, gravity * mirror, LIMITS)
    assert_same(got, want, oracle.size_of(contacts))


@bounded
@given(real_robots, seeds)
def test_the_order_of_the_contacts_does_not_matter(contacts: Floats, seed: int) -> None:
    assume_steady(contacts)
    gravity = assume_clear(contacts, directions(seed, 12))
    order = np.random.default_rng(seed).permutation(len(contacts))
    assert_same(
        judged(contacts[order], gravity, LIMITS),
        judged(contacts, gravity, LIMITS),
        oracle.size_of(contacts),
    )


@bounded
@given(whole_robots, seeds)
def test_the_order_of_coplanar_and_repeated_contacts_does_not_matter_to_the_verdict(
    contacts: Floats, seed: int
) -> None:
    gravity = directions(seed, 12)
    order = np.random.default_rng(seed).permutation(len(contacts))
    want = judged(contacts, gravity)
    got = judged(contacts[order], gravity)
    # The contacts are whole numbers: facets are exact but for the last bits of their normals.
    assert got["tip_angle"] == pytest.approx(want["tip_angle"], abs=1e-7)
    clear = np.abs(want["tip_angle"]) > 1e-7
    assert (np.isnan(got["sdg"]) == np.isnan(want["sdg"]))[clear].all()
    assert got["height"][clear] == pytest.approx(want["height"][clear], rel=1e-9, nan_ok=True)


@bounded
@given(whole_robots, seeds, st.integers(0, 6))
def test_a_repeated_contact_changes_nothing(contacts: Floats, seed: int, which: int) -> None:
    gravity = directions(seed, 12)
    again = np.concatenate((contacts, contacts[[which % len(contacts)]]))
    for limits in (None, LIMITS):
        want, got = judged(contacts, gravity, limits), judged(again, gravity, limits)
        assert_same(got, want, max(1.0, oracle.size_of(contacts)))


@bounded
@given(real_robots, seeds)
def test_a_contact_inside_the_hull_changes_nothing(contacts: Floats, seed: int) -> None:
    assume_steady(contacts)
    gravity = assume_clear(contacts, directions(seed, 12))
    inside = contacts.mean(axis=0)
    facets = oracle.support_facets(contacts)
    # Three contacts span no hull; a flat hull has no inside.
    assume(all(facet.height - facet.normal @ inside > 1e-3 for facet in facets))
    for limits in (None, LIMITS):
        assert_same(
            judged(np.concatenate((contacts, inside[None])), gravity, limits),
            judged(contacts, gravity, limits),
            oracle.size_of(contacts),
        )


@bounded
@given(seeds, st.floats(0.01, 0.5))
def test_a_contact_hovering_above_a_table_changes_nothing(seed: int, lift: float) -> None:
    rng = np.random.default_rng(seed)
    table = np.array([[1.0, 0.8, -0.9], [-1.0, 0.8, -0.9], [-1.0, -0.8, -0.9], [1.0, -0.8, -0.9]])
    hovering = np.array([[*rng.uniform(-0.3, 0.3, 2), -0.9 + lift]])
    gravity = directions(seed, 12)
    upright_only = (radians(90.0), 0.0)
    assert_same(
        judged(np.concatenate((table, hovering)), gravity, upright_only),
        judged(table, gravity, upright_only),
        1.7,
    )


@bounded
@given(real_robots, seeds, st.floats(-8.0, 0.5), st.booleans())
def test_tip_angle_changes_by_no_more_than_gravity_turns(
    contacts: Floats, seed: int, exponent: float, limited: bool
) -> None:
    start = directions(seed, 40)
    step = np.random.default_rng(seed + 1).normal(size=start.shape)
    stop = unit(start + 10.0**exponent * step)
    limits = LIMITS if limited else None
    before = judged(contacts, start, limits)["tip_angle"]
    after = judged(contacts, stop, limits)["tip_angle"]
    turned = [oracle.angle_between(a, b) for a, b in zip(start, stop, strict=True)]
    # 3e-8: asin within 1e-16 of +-1.
    assert (np.abs(after - before) <= np.array(turned) + 3e-8).all()


@bounded
@given(seeds, st.booleans())
def test_tip_angle_is_one_lipschitz_along_a_great_circle_round_a_robot_that_rocks(
    seed: int, limited: bool
) -> None:
    # Table with two feet shortened: two facets that meet in a diagonal, side facets beyond 30 deg.
    rng = np.random.default_rng(seed)
    warp = rng.uniform(0.02, 0.6)
    feet = np.array(
        [[1, 0.8, -0.9], [-1, 0.8, -0.9 + warp], [-1, -0.8, -0.9], [1, -0.8, -0.9 + warp]]
    )
    first, second = unit(np.array([0.1, 0.2, -1.0])), rotation(seed)[0]
    second = unit(second - (second @ first) * first)
    turn = np.linspace(0.0, 2.0 * pi, 721)[:, None]
    gravity = np.cos(turn) * first + np.sin(turn) * second
    tip_angle = judged(feet, gravity, LIMITS if limited else None)["tip_angle"]
    assert max(abs(b - a) for a, b in pairwise(tip_angle)) <= turn[1, 0] * (1.0 + 1e-9) + 1e-12
    # Neither constant nor a mere verdict: it rises and falls at the full rate somewhere.
    assert max(abs(b - a) for a, b in pairwise(tip_angle)) > 0.2 * turn[1, 0]
    assert tip_angle.min() < 0.0 < tip_angle.max()


def assert_consistent(got: dict[str, Floats]) -> None:
    """Check that the verdict is `tip_angle < 0` and that every channel tells the same one."""
    assert not np.isnan(got["tip_angle"]).any()
    assert (np.abs(got["tip_angle"]) <= pi).all()
    tips = got["tip_angle"] < 0.0
    assert (np.isnan(got["sdg"]) == tips).all()
    assert (np.isnan(got["height"]) == tips).all()
    assert ((got["facet"] == -1.0) == tips).all()
    assert (got["facet"][~tips] >= 0.0).all()
    for name in ("margin", "energy_margin"):
        assert not np.isnan(got[name]).any()
        assert (got[name][tips] <= 0.0).all()
        assert (got[name][~tips] >= 0.0).all()
    assert (got["sdg"][~tips] >= 0.0).all()
    assert (got["height"][~tips] > 0.0).all()


@settings(bounded, max_examples=300)
@given(whole_robots, seeds, st.booleans())
def test_all_channels_tell_the_same_verdict_on_degenerate_robots(
    contacts: Floats, seed: int, limited: bool
) -> None:
    edges = unit(contacts + np.roll(contacts, 1, axis=0) + 1e-9)
    gravity = np.concatenate((directions(seed, 12), np.eye(3), -np.eye(3), edges))
    assert_consistent(judged(contacts, gravity, LIMITS if limited else None))


@bounded
@given(real_robots, seeds, st.booleans())
def test_all_channels_tell_the_same_verdict_on_generic_robots(
    contacts: Floats, seed: int, limited: bool
) -> None:
    targets = contacts + np.roll(contacts, 1, axis=0)
    gravity = np.concatenate((directions(seed, 30), unit(contacts), unit(targets)))
    assert_consistent(judged(contacts, gravity, LIMITS if limited else None))


BALLS = """
[robot]
name = "four_balls"
length_unit = "m"
upright = 90.0
rock_angle = 30.0
[[robot.parameter]]
name = "lift"
min = -0.1
max = 0.1
unit = "m"
[[robot.link]]
name = "leg"
parent = "body"
joint = { type = "prismatic", axis = [0, 0, 1], parameter = "lift" }
"""
BALLS_END = """
[sweep]
samples = { lift = 5 }
channels = ["tip_angle"]
[sweep.gravity]
chart = "cone"
max_tilt = 60.0
nodes = 5
"""


def ball_robot(shape: str) -> Recipe:
    """Four round feet, of which the first goes up and down with `lift`."""
    feet = "".join(
        f'[[robot.contact]]\nname = "foot{number}"\nlink = "{"body" if number else "leg"}"\n'
        f"position = [{0.3 * x}, {0.2 * y}, -0.25]\nradius = 0.08\n{shape}\n"
        for number, (x, y) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1)))
    )
    return lutgen.parse_recipe(BALLS + feet + BALLS_END)


@pytest.mark.parametrize("shape", ["", "axis = [0, 1, 0]", "axis = [0.6, 0.8, 0]"])
def test_round_feet_rock_across_the_gap_between_two_facets(shape: str) -> None:
    recipe = ball_robot(shape)
    lifts = np.linspace(-0.06, 0.06, 13)[:, None]
    gravity = directions(20240614, 400)
    got = lutgen.evaluate(recipe, lifts, gravity, channels=CHANNELS)
    for row in range(len(lifts)):
        assert_consistent({name: got[name][row] for name in CHANNELS})
    # Upright and level it always stands: between the two facets as well as on one of them.
    turn = np.linspace(0.0, 2.0 * pi, 400)
    small = unit(np.column_stack((0.15 * np.cos(turn), 0.15 * np.sin(turn), -np.ones(400))))
    level = lutgen.evaluate(recipe, lifts, small, channels=CHANNELS)
    assert (level["tip_angle"] > 0.0).all()
    # A lifted foot makes two facets: both are visited.
    assert all(len(set(facets)) >= 2 for facets in level["facet"][[0, 1, -2, -1]])


@pytest.mark.parametrize("shape", ["", "axis = [0, 1, 0]", "axis = [0.6, 0.8, 0]"])
def test_tip_angle_of_round_feet_is_one_lipschitz_in_gravity(shape: str) -> None:
    recipe = ball_robot(shape)
    lifts = np.linspace(-0.06, 0.06, 7)[:, None]
    turn = np.linspace(0.0, 2.0 * pi, 2001)
    for seed in range(6):
        first, second, _ = rotation(seed)
        gravity = np.cos(turn)[:, None] * first + np.sin(turn)[:, None] * second
        got = lutgen.evaluate(recipe, lifts, gravity, channels=("tip_angle",))["tip_angle"]
        assert (np.abs(np.diff(got, axis=1)) <= turn[1] * (1.0 + 1e-9) + 3e-8).all()
        assert got.min() < -0.1


def test_a_ball_robot_tips_at_the_same_tilts_as_its_lowest_points() -> None:
    # On level ground four equal balls touch one radius below their centres.
    recipe = ball_robot("")
    gravity = directions(7, 200)
    feet = np.array(
        [[0.3, 0.2, -0.33], [-0.3, 0.2, -0.33], [-0.3, -0.2, -0.33], [0.3, -0.2, -0.33]]
    )
    balls = lutgen.evaluate(recipe, [[0.0]], gravity, channels=CHANNELS)
    points = judged(feet, gravity, LIMITS)
    assert_same({name: balls[name][0] for name in CHANNELS}, points, 0.5)


@bounded
@given(real_robots)
def test_a_ray_exactly_at_a_shared_edge_or_corner_stands(contacts: Floats) -> None:
    contacts = contacts + np.array([0.0, 0.0, 0.45])
    facets = oracle.support_facets(oracle.distinct(contacts))
    closed = oracle.tip_over_axes(facets, None)
    assume(facets and not closed)  # the centre of mass is inside the hull
    corners = np.concatenate([facet.points for facet in facets])
    nexts = np.concatenate([np.roll(facet.points, -1, axis=0) for facet in facets])
    shares = np.linspace(0.0, 1.0, 9)[:, None, None]
    gravity = unit((shares * corners + (1.0 - shares) * nexts).reshape(-1, 3))
    got = judged(contacts, gravity)
    assert (got["tip_angle"] == pi).all()
    assert np.isfinite(got["sdg"]).all()
    assert np.isfinite(got["height"]).all()
    assert (got["facet"] >= 0.0).all()
    assert (got["margin"] > 0.0).all()
    assert (got["energy_margin"] > 0.0).all()


@bounded
@given(seeds, st.floats(-0.1, 0.1))
def test_a_ray_along_the_diagonal_on_which_a_warped_table_rocks_stands(
    seed: int, warp: float
) -> None:
    rng = np.random.default_rng(seed)
    feet = np.array(
        [[1, 0.8, -0.9], [-1, 0.8, -0.9 + warp], [-1, -0.8, -0.9], [1, -0.8, -0.9 + warp]]
    )
    feet = feet + np.array([*rng.uniform(-0.2, 0.2, 2), 0.0])
    shares = np.linspace(0.01, 0.99, 99)[:, None]
    low = (0, 2) if warp >= 0.0 else (1, 3)
    gravity = unit(shares * feet[low[0]] + (1.0 - shares) * feet[low[1]])
    for limits in (None, LIMITS):
        got = judged(feet, gravity, limits)
        assert (got["tip_angle"] > 0.0).all()
        assert np.isfinite(got["sdg"]).all()


def test_a_ray_exactly_on_a_tip_over_axis_has_tip_angle_zero() -> None:
    table = np.array([[1.0, 1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, -1.0], [1.0, -1.0, -1.0]])
    gravity = unit(
        np.array([[1.0, 0.0, -1.0], [0.0, -1.0, -1.0], [1.0, 1.0, -1.0], [1.0, 0.3, -1.0]])
    )
    for limits in (None, LIMITS):
        assert judged(table, gravity, limits)["tip_angle"] == pytest.approx(0.0, abs=1e-15)


@bounded
@given(real_robots, seeds, st.floats(-3.0, 3.0))
def test_the_length_of_gravity_does_not_matter(
    contacts: Floats, seed: int, exponent: float
) -> None:
    assume_steady(contacts)
    gravity = assume_clear(contacts, directions(seed, 12))
    want = judged(contacts, gravity, LIMITS)
    got = judged(contacts, 10.0**exponent * gravity, LIMITS)
    assert_same(got, want, oracle.size_of(contacts))


def test_a_batch_gives_the_same_bits_as_its_postures_and_directions_one_by_one() -> None:
    rng = np.random.default_rng(20240615)
    contacts = rng.uniform(-1.0, 1.0, (20, 5, 3)) - [0.0, 0.0, 0.6]
    gravity = directions(20240615, 30)
    batch = lutgen.stability(contacts, gravity, CHANNELS, *LIMITS)
    for row in range(20):
        for column in range(30):
            single = judged(contacts[row], gravity[[column]], LIMITS)
            for name in CHANNELS:
                assert np.array_equal(batch[name][row, column], single[name][0], equal_nan=True)
    assert all(values.shape == (20, 30) for values in batch.values())
    assert all(values.dtype == np.float64 for values in batch.values())
    assert tuple(batch) == CHANNELS


def test_channels_asked_for_alone_are_those_asked_for_together() -> None:
    rng = np.random.default_rng(20240616)
    contacts = rng.uniform(-1.0, 1.0, (30, 6, 3)) - [0.0, 0.0, 0.6]
    gravity = directions(20240616, 30)
    together = lutgen.stability(contacts, gravity, CHANNELS, *LIMITS)
    for name in CHANNELS:
        alone = lutgen.stability(contacts, gravity, (name,), *LIMITS)
        assert list(alone) == [name]
        assert np.array_equal(alone[name], together[name], equal_nan=True)
    default = lutgen.stability(contacts, gravity)
    assert list(default) == ["sdg", "tip_angle"]


def test_one_posture_or_one_direction_alone_is_a_batch_of_one() -> None:
    want = lutgen.stability(TABLE[None], DOWN, CHANNELS)
    for contacts, gravity in ((TABLE, DOWN), (TABLE[None], DOWN[0]), (TABLE, DOWN[0])):
        got = lutgen.stability(contacts, gravity, CHANNELS)
        for name in CHANNELS:
            assert got[name].shape == (1, 1)
            assert got[name] == want[name]


TABLE = np.array([[1.0, 1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, -1.0], [1.0, -1.0, -1.0]])


@pytest.mark.parametrize("bad", [nan, inf, -inf])
def test_a_contact_that_is_not_finite_is_refused(bad: float) -> None:
    contacts = TABLE.copy()
    contacts[2, 1] = bad
    with pytest.raises(lutgen.InputError):
        lutgen.stability(contacts[None], DOWN)


@pytest.mark.parametrize(
    "bad", [[nan, 0, -1], [0, inf, 0], [0, 0, 0]], ids=["NaN", "infinite", "zero"]
)
def test_a_gravity_direction_that_is_none_is_refused(bad: list[float]) -> None:
    with pytest.raises(lutgen.InputError):
        lutgen.stability(TABLE[None], [bad])


@pytest.mark.parametrize(
    ("contacts", "gravity", "channels"),
    [
        (TABLE[None, :2], DOWN, ("sdg",)),
        (TABLE[None, :, :2], DOWN, ("sdg",)),
        (TABLE[None], DOWN[:, :2], ("sdg",)),
        (TABLE[None], DOWN, ("sgd",)),
    ],
    ids=["two contacts", "flat", "flat direction", "misspelt"],
)
def test_arrays_of_another_shape_and_unknown_channels_are_refused(
    contacts: Floats, gravity: Floats, channels: tuple[str, ...]
) -> None:
    with pytest.raises(lutgen.InputError):
        lutgen.stability(contacts, gravity, channels)


NO_SUPPORT = {
    "collinear": [[x, 0.5 * x, -1.0] for x in (-1.0, 0.0, 0.5, 1.0)],
    "collinear through the com": [[x, x, x] for x in (-1.0, 1.0, 2.0)],
    "all one point": [[0.3, 0.2, -1.0]] * 4,
    "two points repeated": [[0.3, 0.2, -1.0], [0.3, 0.2, -1.0], [-0.3, 0.2, -1.0]],
    "com in the contact plane": [[1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0]],
    "com is a contact": [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    "all at the com": [[0.0, 0.0, 0.0]] * 3,
}


@pytest.mark.parametrize("name", NO_SUPPORT)
def test_contacts_that_give_no_support_tip_in_every_direction(name: str) -> None:
    contacts = np.array(NO_SUPPORT[name])
    gravity = np.concatenate((directions(1, 50), np.eye(3), -np.eye(3)))
    for limits in (None, LIMITS):
        got = judged(contacts, gravity, limits)
        assert (got["tip_angle"] == -pi).all()
        assert_consistent(got)


def test_contacts_above_the_com_carry_when_hung_and_tip_when_upright() -> None:
    hung = TABLE * [1.0, 1.0, -1.0]
    free = judged(hung, np.concatenate((DOWN, -DOWN)))
    assert degrees(free["tip_angle"][0]) == pytest.approx(-45.0, abs=1e-9)
    assert degrees(free["tip_angle"][1]) == pytest.approx(45.0, abs=1e-9)
    limited = judged(hung, np.concatenate((DOWN, -DOWN)), LIMITS)
    assert (limited["tip_angle"] == -pi).all()


def test_a_robot_lying_exactly_on_its_side_does_not_stand_at_an_upright_limit_of_90_deg() -> None:
    side = TABLE[:, [2, 1, 0]] * [-1.0, 1.0, 1.0]  # the four feet at x = +1
    gravity = np.array([[1.0, 0.0, 0.0]])
    assert judged(side, gravity, LIMITS)["tip_angle"][0] == -pi
    wider = lutgen.stability(side[None], gravity, ["tip_angle"], radians(90.1), radians(30.0))
    assert degrees(wider["tip_angle"][0, 0]) == pytest.approx(45.0, abs=1e-9)


def _energy_to_spare(x: float, slope: float) -> float:
    """Return what is missing to go over the end of the roof after rolling over its ridge at x."""
    ridge, g = np.array([x, 0.0, -1.0]), unit(np.array([x, 0.0, -1.0]))
    turn = Rotation.from_rotvec([radians(20.0), 0.0, 0.0])
    # The com stays on a circle about the ridge; gravity turns in the body.
    rolled = max((turn.apply(g), turn.inv().apply(g)), key=lambda seen: seen[1])
    sunk = ridge @ g - ridge @ rolled
    along = unit(np.array([0.0, 1.0, slope]))
    arm = np.array([1.0, 0.0, -1.0])
    top = np.linalg.norm(np.cross(along, arm)) * np.linalg.norm(np.cross(along, rolled))
    return float(top + (arm @ along) * (rolled @ along) - arm @ rolled - sunk)


@pytest.mark.parametrize(("limit", "rocks"), [(20.1, True), (19.9, False)])
def test_a_robot_rocks_over_an_edge_up_to_the_rock_angle_and_tips_beyond(
    limit: float, rocks: bool
) -> None:
    # A roof upside down: two feet on the ridge, two on each side, normals 20 deg apart.
    slope = np.tan(radians(10.0))
    roof = np.array([[x, y, abs(y) * slope - 1.0] for x in (-1.0, 1.0) for y in (-1.0, 0.0, 1.0)])
    got = lutgen.stability(
        roof[None],
        unit(np.array([[0.0, 0.0, -1.0], [0.0, 0.3, -1.0]])),
        CHANNELS,
        radians(60.0),
        radians(limit),
    )
    level, tilted = got["tip_angle"][0]
    if rocks:
        # Rolled from one side onto the other, 20 deg, the com has sunk; near the ends of the ridge
        # that is enough to go on over the end of the roof, so there it may tip.
        furthest = brentq(lambda x: _energy_to_spare(x, slope), 0.01, 0.99, xtol=1e-13)
        # A roll is followed in steps, whose rule is right to about 1e-5 of a rise.
        assert degrees(level) == pytest.approx(degrees(np.arctan(furthest)), abs=1e-3)
        assert tilted > radians(25.0)
    else:
        assert level == pytest.approx(0.0, abs=1e-12)
        assert tilted == pytest.approx(np.arctan(0.3), abs=1e-9)

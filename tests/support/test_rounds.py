"""Spheres and discs: the support facets of lutgen against those of the support function.

`random_robot` draws mixtures of points, spheres and discs, wheels on parallel axles and
robots with equal wheels on a rectangle, whose facets touch more than three primitives.
"""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import minimize

from lutgen.channels.evaluation import measure_primitives
from lutgen.support import facets_in
from lutgen.support.primitive import pack
from lutgen.support.region import PLANE, acceptance, empty_region
from lutgen.support.search import stand
from lutgen.support.table import facet_table
from tests.fixtures.facets import Facet, facets
from tests.fixtures.length import part
from tests.oracles import rounds as oracle
from tests.oracles.points import unit
from tests.oracles.rounds import DISC, POINT, SPHERE, Floats, Robot

TOTAL = part(2000)
# Of these robots one in so many is looked at by minimisation.
STEP = TOTAL // part(100)
SETS = ("mixture", "discs", "wheels", "rectangle")

# Rounding (1e-16) times the conditioning of the thinnest contact triangle that counts (1e4),
# with room for the stopping rule of an iteration.
NORMAL = 1e-7
# Distances are sums of a few terms of the robot's size; iterations stop at about 1e-12 of it.
ON = 1e-9
# Cosine of the default `upright`, 80 deg.
STEEP = float(np.cos(np.radians(80.0)))


def random_robot(rng: np.random.Generator, count: int) -> tuple[str, Robot]:
    """Robot of `count` primitives about 2 units wide, radii up to 0.8 (0.4 of that)."""
    kind_of_set = str(rng.choice(SETS))
    centres = rng.uniform(-1.0, 1.0, (count, 3))
    if rng.uniform() < 0.7:
        centres[:, 2] = -rng.uniform(0.1, 0.9, count)
    radius = rng.uniform(0.0, 0.8, count)
    axes = unit(rng.normal(size=(count, 3)))
    kind = np.full(count, DISC)
    if kind_of_set == "mixture":
        kind = rng.choice([POINT, SPHERE, DISC], count)
    elif kind_of_set == "wheels":
        axes[:] = [0.0, 1.0, 0.0]
    elif kind_of_set == "rectangle":
        half = rng.uniform(0.3, 1.0, 2)
        corners = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]) * half
        four = min(count, 4)
        centres[:four] = np.column_stack((corners, np.full(4, -rng.uniform(0.1, 0.6))))[:four]
        kind[:four] = rng.choice([SPHERE, DISC])
        radius[:four] = rng.uniform(0.05, 0.4)
        axes[:four] = [0.0, 1.0, 0.0]
        turned = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        centres, axes = centres @ turned.T, axes @ turned.T
    radius[kind == POINT] = 0.0
    axes[kind != DISC] = 0.0
    scale = 10.0 ** rng.uniform(-2.0, 2.0)
    return kind_of_set, Robot(scale * centres, axes, scale * radius, kind.astype(np.int64))


@cache
def robots() -> tuple[tuple[str, Robot], ...]:
    """Draw the random robots with 3 to 6 primitives, the same on every run."""
    rng = np.random.default_rng(20240612)
    return tuple(random_robot(rng, 3 + index % 4) for index in range(TOTAL))


@cache
def expected() -> tuple[tuple[oracle.Facet, ...], ...]:
    """Find the oracle's facets of every robot."""
    return tuple(tuple(oracle.support_facets(robot)) for _, robot in robots())


@cache
def returned() -> tuple[tuple[Facet, ...], ...]:
    """Ask lutgen for the facets of every robot."""
    return tuple(
        tuple(facets(robot.centres, robot.axes, robot.radius, robot.kind)) for _, robot in robots()
    )


def describe(index: int) -> str:
    """Say enough about a robot to build it again."""
    kind_of_set, robot = robots()[index]
    return (
        f"robot {index} ({kind_of_set}): centres {robot.centres.tolist()}, "
        f"axes {robot.axes.tolist()}, radius {robot.radius.tolist()}, kind {robot.kind.tolist()}"
    )


def test_oracle_finds_the_facet_where_a_ray_leaves_the_hull_by_minimisation() -> None:
    rng = np.random.default_rng(20240613)
    met = 0
    for index in range(0, TOTAL, 2 * STEP):
        robot = robots()[index][1]
        facet_list = expected()[index]
        for facet in facet_list[:2]:
            if not facet.is_clear or not facet.width > 0.05:
                continue
            weights = rng.dirichlet(np.full(len(facet.contacts), 3.0))
            ray = unit(weights @ facet.contacts)
            across = np.linalg.svd(ray[None, :])[2][1:]

            def height(
                at: Floats, robot: Robot = robot, ray: Floats = ray, u: Floats = across
            ) -> Floats:
                normal = ray + at[:2] @ u
                norm = np.sqrt(normal @ normal)
                return np.asarray(at[2] - norm * oracle.support(normal / norm, robot))

            # The ray leaves the hull at the least H(y) over all y with y.ray = 1.
            found = minimize(
                lambda at: at[2],
                np.array([0.0, 0.0, float(oracle.support(ray, robot).max())]),
                constraints={"type": "ineq", "fun": height},
                options={"ftol": 1e-15, "maxiter": 300},
            )
            normal = unit(ray + found.x[:2] @ across)
            # SLSQP stops at about the square root of its tolerance.
            assert normal == pytest.approx(facet.normal, abs=1e-5), describe(index)
            met += 1
    assert met >= 0.3 * TOTAL / STEP


def test_every_facet_of_the_support_function_is_returned() -> None:
    clear = steep = 0
    for index, (want, got) in enumerate(zip(expected(), returned(), strict=True)):
        for facet in want:
            if not facet.is_clear:
                continue
            clear += 1
            twins = [
                other
                for other in got
                if np.abs(np.asarray(other.normal) - facet.normal).max() < NORMAL
            ]
            if not twins and facet.normal[2] > -STEEP:
                steep += 1
                continue
            assert len(twins) == 1, f"{describe(index)}: {facet} has {len(twins)} twins"
            assert tuple(sorted(twins[0].touching)) == facet.touching, describe(index)
            assert twins[0].height == pytest.approx(
                facet.height, abs=ON * robots()[index][1].size
            ), describe(index)
    # Facets that no arc joins to others and that face sideways or up may escape the search, which
    # goes out from below; on those nobody stands.
    assert steep <= 0.001 * clear
    # Hardly any facet may hide behind "near-degenerate", and there must be some to find.
    assert clear > 2.5 * TOTAL
    assert clear > 0.97 * sum(len(want) for want in expected())


def test_every_returned_facet_is_one_of_the_support_function() -> None:
    unclear = 0
    for index, (want, got) in enumerate(zip(expected(), returned(), strict=True)):
        robot = robots()[index][1]
        for facet in got:
            normal = np.asarray(facet.normal)
            if any(np.abs(normal - other.normal).max() < NORMAL for other in want):
                continue
            near = [other for other in want if not other.is_clear and normal @ other.normal > 0.999]
            contacts = np.array([oracle.contact(normal, robot, i) for i in facet.touching])
            thin = oracle.altitude(contacts[:3]) < 1e-3 * robot.size
            assert near or thin, f"{describe(index)}: {facet}"
            unclear += 1
    assert unclear < 0.01 * TOTAL


def test_no_primitive_lies_beyond_a_returned_facet_and_exactly_the_touching_ones_reach_it() -> None:
    for index, got in enumerate(returned()):
        robot = robots()[index][1]
        for facet in got:
            normal = np.asarray(facet.normal)
            assert np.sqrt(normal @ normal) == pytest.approx(1.0, abs=1e-12)
            assert facet.height > 0.0
            gap = facet.height - oracle.support(normal, robot)
            assert gap.min() > -ON * robot.size, f"{describe(index)}: {facet}"
            touching = np.isin(np.arange(len(gap)), facet.touching)
            assert (gap[touching] < 1e-8 * robot.size).all(), f"{describe(index)}: {facet}"
            # The documented tolerance is relative; ten times the bound of this file is clear of it.
            assert (gap[~touching] > 1e-12 * robot.size).all(), f"{describe(index)}: {facet}"


def test_contact_points_are_on_the_primitive_and_on_the_plane() -> None:
    for index, got in enumerate(returned()):
        robot = robots()[index][1]
        for facet in got:
            for place, corner in zip(facet.polygon, np.asarray(facet.points), strict=True):
                from_centre = corner - robot.centres[place]
                distance = np.sqrt(from_centre @ from_centre)
                assert distance == pytest.approx(robot.radius[place], abs=ON * robot.size)
                assert abs(from_centre @ robot.axes[place]) < ON * robot.size
                # A point of the rim that is off by e is above the plane by about e^2 / 2r only:
                # the place along the rim is held by the next test.
                assert corner @ facet.normal == pytest.approx(facet.height, abs=1e-8 * robot.size)


def test_contact_points_are_the_lowest_points_of_their_primitives() -> None:
    for index, got in enumerate(returned()):
        robot = robots()[index][1]
        for facet in got:
            normal = np.asarray(facet.normal)
            for place, corner in zip(facet.polygon, np.asarray(facet.points), strict=True):
                if robot.kind[place] == DISC and abs(normal @ robot.axes[place]) > 0.9999:
                    continue  # nearly flat on the plane: the lowest point runs along the rim
                lowest = oracle.contact(normal, robot, place)
                assert corner == pytest.approx(lowest, abs=1e-7 * robot.size), describe(index)


def test_support_polygon_is_strictly_convex_counter_clockwise_and_holds_every_contact() -> None:
    for index, got in enumerate(returned()):
        robot = robots()[index][1]
        for facet in got:
            normal = np.asarray(facet.normal)
            corners = np.asarray(facet.points)
            assert len(facet.polygon) >= 3
            assert len(set(facet.polygon)) == len(facet.polygon)
            assert set(facet.polygon) <= set(facet.touching)
            sides = np.roll(corners, -1, axis=0) - corners
            turns = np.cross(sides, np.roll(sides, -1, axis=0)) @ normal
            assert (turns > 0.0).all(), f"{describe(index)}: {facet}"
            # Turning left at every corner, once round: not a star.
            angles = [
                np.arctan2(np.cross(first, second) @ normal, first @ second)
                for first, second in pairwise([*sides, sides[0]])
            ]
            assert sum(angles) == pytest.approx(2.0 * np.pi, abs=1e-6)
            for place in facet.touching:
                away = oracle.contact(normal, robot, place) - corners
                assert (np.cross(sides, away) @ normal > -1e-6 * robot.size**2).all()


def test_facets_come_in_ascending_order_of_the_primitives_that_they_touch() -> None:
    for got in returned():
        masks = [sum(1 << i for i in facet.touching) for facet in got]
        assert masks == sorted(masks)
        assert all(facet.touching == tuple(sorted(facet.touching)) for facet in got)


def test_equal_wheels_on_a_rectangle_give_one_facet_that_touches_all_four() -> None:
    merged = sum(
        len(facet.touching) >= 4
        for (kind_of_set, robot), got in zip(robots(), returned(), strict=True)
        if kind_of_set == "rectangle" and len(robot.radius) >= 4
        for facet in got
    )
    assert merged > TOTAL / 20


def test_a_robot_with_its_wheels_flat_on_the_ground_has_no_facet_there() -> None:
    # Three wheels with vertical axles: the plane touches their faces, not single points.
    centres = np.array([[1.0, 0.0, -0.5], [-0.5, 0.9, -0.5], [-0.5, -0.9, -0.5]])
    axes = np.tile([0.0, 0.0, 1.0], (3, 1))
    lying = facets(centres, axes, np.full(3, 0.2), np.full(3, DISC, dtype=np.int64))
    assert not [facet for facet in lying if abs(facet.normal[2]) > 0.999]


def test_a_tripod_of_balls_has_its_facet_one_radius_below_the_centres() -> None:
    centres = np.array([[1.0, 0.0, -0.5], [-0.5, 0.9, -0.5], [-0.5, -0.9, -0.5]])
    kind = np.full(3, SPHERE, dtype=np.int64)
    (standing,) = [
        facet
        for facet in facets(centres, np.zeros((3, 3)), np.full(3, 0.2), kind)
        if facet.normal[2] < 0.0
    ]
    assert standing.normal == pytest.approx([0.0, 0.0, -1.0], abs=1e-12)
    assert standing.height == pytest.approx(0.7, abs=1e-12)
    # Counter-clockwise from below is clockwise from above.
    order = standing.polygon
    assert order[(order.index(0) + 1) % 3] == 2
    assert np.asarray(standing.points) == pytest.approx(
        centres[list(order)] - [0.0, 0.0, 0.2], abs=1e-12
    )


def test_three_balls_in_a_row_tip_beyond_the_outer_ones() -> None:
    # Two facets, mirror images of one another, touch all three balls and share all three edges.
    # Over the middle ball it tips sideways.  Straight down it balances on the middle ball alone,
    # which is no gap: a gap has two contacts.
    centres = np.array([[0.2, 0.0, -0.3], [-0.2, 0.0, -0.3], [0.0, 0.0, -0.25]])
    radius = np.array([0.05, 0.05, 0.0985])
    # n . c + r of the middle ball and of the others agree where (r - R) = 0.05 cosine.
    cosine = (0.0985 - 0.05) / 0.05
    sine = np.sqrt(1.0 - cosine**2)
    limit = np.arctan(0.0985 * sine / (0.25 + 0.0985 * cosine))
    assert np.degrees(limit) == pytest.approx(3.965, abs=1e-3)
    tilts = np.array([-limit - 1e-4, -limit + 1e-4, limit - 1e-4, limit + 1e-4, 0.5, 1.5, 3.0])
    gravity = np.column_stack([0.0 * tilts, np.sin(tilts), -np.cos(tilts)])
    kind = np.full(3, SPHERE, dtype=np.int64)
    primitives = pack(centres[None], np.zeros((1, 3, 3)), radius, kind)
    values = measure_primitives(
        primitives, gravity, ("tip_angle",), acceptance(np.pi / 2, np.pi / 6)
    )["tip_angle"][0]
    assert (values >= 0.0).tolist() == [False, True, True, False, False, False, False]


def test_a_rail_bends_once_where_one_wheel_is_exactly_above_another() -> None:
    """Two wheels on each corner, at one x: which carries changes at one pitch, for good."""
    corner = [(x, y) for x in (0.3, -0.3) for y in (0.2, -0.2)]
    centres = np.array([(x, y, z) for x, y in corner for z in (-0.3, 0.1)])
    radius = np.tile([0.05, 0.15], 4)
    axes = np.tile([0.0, 1.0, 0.0], (8, 1))
    primitives = pack(centres[None], axes[None], radius, np.full(8, DISC))[0]
    table, region = facet_table(8), empty_region(8)
    full = stand(table, region, primitives, acceptance(np.radians(80.0), np.radians(30.0)))
    assert full == 0
    # Nose down and nose up the upper wheels touch beyond the lower ones: 16.5 deg and more.
    normals = region.facet[: facets_in(region.tally), PLANE : PLANE + 3]
    assert (np.abs(normals[:, :2]).max(axis=1) < 1e-9).sum() == 1


@pytest.mark.parametrize("up", [-0.01, 0.0, 0.0026, 0.019])
def test_feet_whose_centres_are_above_the_com_carry_where_their_soles_are_below(up: float) -> None:
    """Four balls of 20 mm on a rectangle: a crouched robot, its com between centres and ground."""
    corner = [(x, y) for x in (0.2, -0.2) for y in (0.15, -0.15)]
    centres = np.array([(x, y, up) for x, y in corner])
    primitives = pack(centres[None], np.zeros((1, 4, 3)), np.full(4, 0.02), np.full(4, SPHERE))
    found = measure_primitives(
        primitives, np.array([[0.0, 0.0, -1.0]]), ("tip_angle", "height"), acceptance(1.4, 0.5)
    )
    height = 0.02 - up
    assert found["height"][0, 0] == pytest.approx(height, abs=1e-12)
    assert found["tip_angle"][0, 0] == pytest.approx(np.arctan2(0.15, height), abs=1e-12)
    # Nothing carries once the com is below the soles.
    primitives = pack(
        centres[None] + [0.0, 0.0, 0.03], np.zeros((1, 4, 3)), np.full(4, 0.02), np.full(4, SPHERE)
    )
    if up > 0.0:
        below = measure_primitives(
            primitives, np.array([[0.0, 0.0, -1.0]]), ("tip_angle",), acceptance(1.4, 0.5)
        )
        assert below["tip_angle"][0, 0] == -np.pi

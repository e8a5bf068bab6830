"""Stability under forces and with an uncertain com: hand-worked, by brute force, by balance."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

import lutgen
from lutgen.analysis import Posture, diagnose
from lutgen.channels import body_gravity
from lutgen.quantities import CHANNELS
from tests.fixtures.pulled import BOX, FREE, LEVEL, WEIGHT, pull, robot
from tests.fixtures.recipes import contact, feet
from tests.support.postures import assert_one_verdict, below


def read(recipe, gravity, *channels):
    """Return the first channel asked for, tip_angle by default, in each direction."""
    names = channels or ("tip_angle",)
    return lutgen.evaluate(recipe, np.zeros((1, 0)), gravity, names)[names[0]][0]


def around(rng, g, angle, count):
    """Directions at an angle from g, every way round."""
    across = rng.normal(size=(count, 3))
    across -= (across @ g)[:, None] * g
    across /= np.linalg.norm(across, axis=1)[:, None]
    angle = np.broadcast_to(angle, count)[:, None]
    return np.asarray(np.cos(angle) * g + np.sin(angle) * across)


def cloud(rng, kind):
    """Contacts strewn below the com."""
    places = rng.normal(size=(rng.integers(4, 8), 3)) * [0.5, 0.4, 0.1] + [0, 0, -0.45]
    if kind == "points":
        return feet(places.tolist())
    axis = (0, 1, 0) if kind == "discs" else None
    return "".join(
        contact(f"P{i}", place, float(rng.uniform(0.05, 0.2)), axis)
        for i, place in enumerate(places.tolist())
    )


def test_the_loaded_kernel_with_next_to_no_load_says_what_the_plain_one_does():
    rng = np.random.default_rng(2)
    for kind, head in (("points", FREE), ("discs", "rock_angle = 40.0"), ("spheres", "")):
        for _ in range(8):
            contacts = cloud(rng, kind)
            g = below(rng, 60)
            plain = robot(contacts, head=head)
            for loaded in (
                robot(contacts, pull((1e-12, 0, 0)), head=head),
                robot(contacts, rho=1e-15, head=head),
            ):
                for name in ("tip_angle", "margin", "sdg", "height", "facet"):
                    # 1e-12 N of 98 N, through asin near 1.
                    assert read(loaded, g, name) == pytest.approx(
                        read(plain, g, name), abs=1e-7, nan_ok=True
                    )


def test_a_drawbar_tips_a_box_where_the_lever_rule_says():
    # About the rear edge: W (a cos t - h sin t) = P z at the tilt t, nose up.
    force, height, half, high = 30.0, 0.3, 0.4, 0.5
    box = robot(feet(BOX), pull((-force, 0, 0), (-0.4, 0, height - high)))
    size = math.hypot(half, high)
    tilt = math.acos(force * height / WEIGHT / size) - math.atan2(high, half)
    found = diagnose(Posture(box, []), LEVEL)
    rear = next(axis for axis in found.tip_over_axes if set(axis.names) == {"P2", "P3"})
    assert rear.tip_angle == pytest.approx(tilt, abs=1e-12)
    assert found.channels["tip_angle"] == pytest.approx(tilt, abs=1e-12)
    just = [[-math.sin(tilt + d), 0, -math.cos(tilt + d)] for d in (-1e-9, 1e-9)]
    assert (read(box, just) >= 0).tolist() == [True, False]
    # The resultant meets the ground P z / W behind the com, and its line passes that edge at
    # (a - P z / W) cos(slope of the resultant).
    back = force * height / WEIGHT
    assert found.pierced == pytest.approx([-back, 0, -high], abs=1e-12)
    assert found.channels["sdg"] == pytest.approx(back, abs=1e-12)


@pytest.mark.parametrize(
    ("kind", "head", "moment"),
    [
        ("points", FREE, 0.0),
        ("points", FREE, 1.0),
        ("points", "upright = 60.0\nrock_angle = 15.0", 0.0),
        ("points", "upright = 60.0\nrock_angle = 15.0", 1.0),
        ("discs", "rock_angle = 40.0", 0.0),
        ("discs", "rock_angle = 40.0", 1.0),
        ("spheres", "", 1.0),
    ],
)
def test_no_direction_nearer_than_the_tip_angle_tips(kind, head, moment):
    rng = np.random.default_rng(5)
    tight = looked = 0
    for _ in range(4):
        contacts = cloud(rng, kind)
        force = pull(
            rng.normal(size=3) * 0.2 * WEIGHT,
            rng.normal(size=3) * 0.3 * moment,
            rng.normal(size=3) * 0.03 * WEIGHT * moment,
        )
        exact = robot(contacts, force, head=head)
        for rho in (0.0, 0.03):
            bound = robot(contacts, force, rho, head=head)
            g = below(rng, 40)
            angle = read(bound, g)
            a, b = rng.integers(0, 40, (2, 200))
            apart = np.arccos(np.clip((g[a] * g[b]).sum(axis=1), -1, 1))
            inside = (angle[a] >= 0) & (angle[b] >= 0)
            assert (np.abs(angle[a] - angle[b]) <= apart + 1e-7)[inside].all()
            for i in np.flatnonzero((angle > 1e-6) & (angle < 3.0))[:8]:
                near = around(rng, g[i], angle[i] * rng.uniform(0.5, 0.9999, 500), 500)
                assert (read(exact, near) >= 0).all()
                if rho == 0.0:
                    looked += 1
                    ring = around(rng, g[i], 1.01 * angle[i] + 1e-4, 3000)
                    tight += bool((read(exact, ring) < 0).any())
    # Nothing smaller would do: of a convex region a direction just beyond tips, always.
    if head == FREE:
        assert tight == looked > 20


def balanced(points, normal, resultant, moment):
    """Whether pushing normal forces and any friction balance a wrench about the com."""
    columns = []
    frame = np.linalg.svd(normal[None])[2]
    for point in points:
        for way in (-normal, frame[1], -frame[1], frame[2], -frame[2]):
            columns.append([*way, *np.cross(point, way)])
    found = linprog(
        np.zeros(len(columns)),
        A_eq=np.transpose(columns),
        b_eq=-np.concatenate([resultant, moment]),
    )
    return bool(found.status == 0)


def test_the_verdict_is_that_of_a_linear_programme_for_the_contact_forces():
    rng = np.random.default_rng(6)
    seen = set()
    for case in range(24):
        # In one plane any force will do; a cloud, many facets, takes those without a moment.
        flat = case % 2 == 0
        points = rng.normal(size=(5, 3)) * [0.5, 0.4, 0.0 if flat else 0.1] + [0, 0, -0.4]
        if flat:
            points[:, 2] += points[:, :2] @ [0.1, -0.2]
        force, place = rng.normal(size=3) * 0.2, rng.normal(size=3) * (0.3 if flat else 0.0)
        twist = rng.normal(size=3) * (0.03 if flat else 0.0)
        loaded = robot(feet(points.tolist()), pull(force * WEIGHT, place, twist * WEIGHT))
        faces = []
        if flat:
            normal = np.array([0.1, -0.2, -1.0])
            faces.append((points, normal / np.linalg.norm(normal)))
        else:
            hull = ConvexHull(points)
            for corners, (*normal_, level) in zip(hull.simplices, hull.equations, strict=True):
                if level < 0:
                    faces.append((points[corners], np.array(normal_)))
        for g in below(rng, 12):
            angle = read(loaded, g)[0]
            if abs(angle) < 1e-6:
                continue
            moment = np.cross(place, force) + twist
            carried = any(balanced(p, n, g + force, moment) for p, n in faces)
            assert carried == (angle >= 0)
            seen.add(carried)
    assert seen == {True, False}


def worst(contacts, g, rho, head, count, force=""):
    """Return the least tip angle over coms on the sphere of radius rho, by the plain kernel."""
    rng = np.random.default_rng(8)
    places = rng.normal(size=(count, 3))
    places *= rho / np.linalg.norm(places, axis=1)[:, None]
    exact = robot(contacts, force, head=head)
    moved = (replace(exact, com_offset=tuple(place)) for place in places.tolist())
    return np.asarray(np.min([read(one, g) for one in moved], axis=0))


def test_the_planes_of_a_box_turn_inward_by_the_angle_of_the_ball():
    box = robot(feet(BOX), rho=0.05)
    side = math.atan2(0.3, 0.5) - math.asin(0.05 / math.hypot(0.3, 0.5))
    assert read(box, LEVEL)[0] == pytest.approx(side, abs=1e-12)
    assert read(box, LEVEL, "margin")[0] == pytest.approx(0.25, abs=1e-12)
    assert read(box, LEVEL, "height")[0] == pytest.approx(0.5)
    # The com must be above the feet wherever it is in the ball.
    assert read(robot(feet(BOX), rho=0.4999), LEVEL, "facet")[0] == -1.0
    assert read(robot(feet(BOX), rho=0.501), LEVEL)[0] == -math.pi


@pytest.mark.parametrize(
    ("kind", "head", "pulled"),
    [
        ("points", FREE, False),
        ("points", "upright = 60.0\nrock_angle = 0.0", False),
        ("discs", "rock_angle = 40.0", False),
        ("spheres", "", False),
        ("points", FREE, True),
        ("points", "rock_angle = 15.0", True),
        ("discs", "", True),
    ],
)
def test_of_any_region_it_is_never_above_the_least_over_all_coms_and_close_to_it(
    kind, head, pulled
):
    rng, short = np.random.default_rng(10 + 3 * pulled), []
    for _ in range(4):
        contacts, rho, g = cloud(rng, kind), rng.uniform(0.01, 0.06), below(rng, 40)
        force = ""
        if pulled:
            force = pull(rng.normal(size=3) * 0.2 * WEIGHT, rng.normal(size=3) * 0.3)
        reduced = read(robot(contacts, force, rho, head=head), g)
        truth = worst(contacts, g, rho, head, 150, force)
        stands = reduced >= 0
        assert (reduced <= truth + 1e-9)[stands | (not pulled)].all()
        short += (truth - reduced)[stands].tolist()
    # With a force it is a bound, but no empty one: it gives away a degree or so.
    assert len(short) > 20
    assert np.median(short) < math.radians(1.5)
    # Without one it is that of 150 coms.
    assert pulled or max(short) < 8e-3


def test_the_signs_of_all_channels_agree_under_any_load():
    rng = np.random.default_rng(11)
    for kind, head in (("points", FREE), ("discs", "rock_angle = 40.0"), ("spheres", "")):
        for rho in (0.0, 0.02):
            force = pull(rng.normal(size=3) * 20, rng.normal(size=3) * 0.2)
            loaded = robot(cloud(rng, kind), force, rho, head=head)
            got = lutgen.evaluate(loaded, np.zeros((1, 0)), below(rng, 200), CHANNELS)
            assert_one_verdict(got)
            assert np.isnan(got["energy_margin"]).all()


def test_a_wheel_pressed_down_decides_on_which_facet_the_robot_rests():
    # A roof: level feet at x = +-1 and a ridge at x = 0 below them.
    roof = [(1, 1, -0.9), (1, -1, -0.9), (0, 1, -1), (0, -1, -1), (-1, 1, -0.9), (-1, -1, -0.9)]
    ground = [0.0, 0.0, -1.0]
    for side in (1.0, -1.0):
        loaded = robot(feet(roof), pull((0, 0, -20), (side, 0, 0)))
        down = body_gravity(loaded, np.zeros((1, 0)), ground, "plane")[0]
        assert math.copysign(1.0, down[0]) == side
        assert read(loaded, down)[0] > 0

"""Tilt limits by hand and by brute force, and what an accelerometer says of the ground."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import lutgen
from lutgen.analysis import FOUR, Posture, diagnose, even_headings, posture_limits, sweep_limits
from lutgen.analysis.ground import gravity_transform, tangent_plane
from lutgen.analysis.tilt import level_angles, level_frames, tilt_limits, tilted, worst_heading
from lutgen.channels import body_gravity, evaluate_each
from lutgen.errors import InputError
from lutgen.recipe.recipe import parse_recipe
from tests.fixtures.length import part
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import feet, rigid, rover, tripod, without_limits

AHEAD, BEHIND, LEFT, RIGHT, HEIGHT = 0.30, 0.25, 0.20, 0.15, 0.40
CORNERS = [
    (AHEAD, LEFT, -HEIGHT),
    (-BEHIND, LEFT, -HEIGHT),
    (-BEHIND, -RIGHT, -HEIGHT),
    (AHEAD, -RIGHT, -HEIGHT),
]
CUBE = [(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)]
CONVENTIONS = ("body", "plane")


def box(head="friction = 0.7", unit="m", scale=1.0):
    corners = [[scale * x for x in corner] for corner in CORNERS]
    return parse_recipe(rigid(feet(corners), head=head, unit=unit))


@pytest.mark.parametrize(
    ("convention", "unit", "scale"), [("body", "m", 1.0), ("plane", "mm", 1000.0)]
)
def test_a_box_tips_where_its_com_passes_the_edge(convention, unit, scale):
    found = posture_limits(Posture(box(unit=unit, scale=scale), []), convention)
    reaches = {
        "nose down": (AHEAD, {"P1", "P4"}),
        "left side down": (LEFT, {"P1", "P2"}),
        "nose up": (BEHIND, {"P2", "P3"}),
        "right side down": (RIGHT, {"P3", "P4"}),
    }
    for row in found.headings[:4]:
        reach, contacts = reaches[row.name]
        # Found to 1e-13 rad; some roundings of coordinates.
        assert row.tilt == pytest.approx(math.atan(reach / HEIGHT), abs=1e-12)
        assert row.heading == FOUR[row.name]
        assert set(row.contacts) == contacts
        # It slides from atan(0.7) on, which lies between the limits of both ends.
        assert row.slides is (reach / HEIGHT > 0.7)
    assert found.worst.heading == pytest.approx(-math.pi / 2.0, abs=1e-6)
    assert found.worst.tilt == pytest.approx(math.atan(RIGHT / HEIGHT), abs=1e-12)
    assert found.guaranteed == pytest.approx(math.atan(RIGHT / HEIGHT), abs=1e-12)
    assert found.worst.slides is False


def test_the_worst_heading_points_at_the_nearest_edge_or_of_equal_ones_nearest_the_nose():
    def worst(corners):
        return worst_heading(Posture(parse_recipe(rigid(feet(corners))), []))

    # The circle of headings is divided until its pieces are 1e-6 rad.
    for turn in (0.7, -2.9):
        cos, sin = math.cos(turn), math.sin(turn)
        expected = math.remainder(turn - math.pi / 2.0, 2.0 * math.pi)
        corners = [(cos * x - sin * y, sin * x + cos * y, z) for x, y, z in CORNERS]
        assert worst(corners) == pytest.approx(expected, abs=1e-6)
    square = [(0.3, 0.3, -0.5), (-0.3, 0.3, -0.5), (-0.3, -0.3, -0.5), (0.3, -0.3, -0.5)]
    assert worst(square) == pytest.approx(0.0, abs=1e-6)
    # On the left first.
    diamond = [(0.4, 0.0, -0.5), (0.0, 0.4, -0.5), (-0.4, 0.0, -0.5), (0.0, -0.4, -0.5)]
    assert worst(diamond) == pytest.approx(math.pi / 4.0, abs=1e-6)


def test_what_cannot_fall_has_no_limit_and_no_axis():
    free = without_limits(rigid(feet(CUBE), head="friction = 0.7"))
    found = posture_limits(Posture(free, []))
    assert found.guaranteed == math.pi
    assert {(row.tilt, row.contacts, row.slides) for row in found.headings} == {(math.pi, (), None)}
    assert math.isnan(found.worst.heading)


def test_no_heading_of_a_fine_grid_is_worse_than_guaranteed():
    random, fine, standing = np.random.default_rng(11), np.linspace(-math.pi, math.pi, 481), 0
    robots = (parse_recipe(rover()), lutgen.load_recipe(MAPS / "absolem.toml"))
    for robot, convention in zip(robots, CONVENTIONS, strict=True):
        low, high = ([getattr(p, end) for p in robot.parameters] for end in ("minimum", "maximum"))
        for posture in random.uniform(low, high, (part(8, 2), len(low))):
            found = posture_limits(Posture(robot, posture), convention)
            tilts = tilt_limits(robot, posture, fine, convention)
            # The walk itself knows its limits to 1e-13 rad.
            assert tilts.min() >= found.guaranteed - 1e-12
            assert found.worst.tilt - found.guaranteed < math.radians(1e-3)
            assert found.worst.tilt <= tilts.min() + 1e-9
            standing += found.guaranteed > 0.05
    assert standing >= 3


def test_the_ground_is_tilted_from_where_the_posture_stands_on_it():
    one = lutgen.load_recipe(MAPS / "paper_one.toml")
    posture = np.array([0.75])
    facet = diagnose(Posture(one, posture), [0.0, 0.0, -1.0]).facet
    (frame,) = level_frames(one, posture[None], "plane")
    np.testing.assert_allclose(frame, gravity_transform(-facet.normal), atol=1e-12)
    heading = 0.4
    limit = tilt_limits(one, posture, [heading], "plane")[0]
    for tilt, stands in ((limit - 1e-9, True), (limit + 1e-9, False)):
        down = (frame @ tilted(tilt, heading))[None]
        angle = evaluate_each(one, posture[None], down, ("tip_angle",))["tip_angle"][0]
        assert (angle >= 0.0) is np.bool_(stands)
    # Its nose is 8 deg up on level ground, so the ground may fall by that much more than the body.
    both = [tilt_limits(one, posture, [0.0], which)[0] for which in CONVENTIONS]
    assert both[1] - both[0] == pytest.approx(math.acos(frame[2, 2]), abs=1e-12)
    assert both[1] - both[0] > 0.1


@pytest.mark.parametrize("text", [tripod("reach = 3, swing = 2"), rover()], ids=["points", "discs"])
def test_limits_over_all_postures_are_those_of_a_double_loop(text):
    robot, headings = parse_recipe(text), even_headings(4)
    rows = robot.grid.params(np.arange(robot.grid.size))
    found = sweep_limits(robot, rows, headings)
    every = np.array(
        [[tilt_limits(robot, row, [psi], "plane")[0] for psi in headings] for row in rows]
    )
    np.testing.assert_array_equal(tilt_limits(robot, rows, headings, "plane"), every)
    np.testing.assert_allclose(found.least, every.min(axis=0), atol=1e-12)
    np.testing.assert_allclose(found.most, every.max(axis=0), atol=1e-12)
    across = np.arange(4)
    np.testing.assert_allclose(every[found.least_at, across], found.least, atol=1e-12)
    np.testing.assert_allclose(every[found.most_at, across], found.most, atol=1e-12)
    assert (found.most - found.least).max() > 0.02
    alone = [posture_limits(Posture(robot, row)).guaranteed for row in rows]
    expected = np.maximum(level_angles(robot, rows, "plane"), 0.0).tolist()
    assert found.guaranteed.tolist() == alone == expected


UP = np.array([0.0, 0.0, 1.0])
# A product of two rotations of unit vectors.
ROUNDING = 1e-14


def test_the_transform_takes_the_z_axis_to_normals_that_point_straight_down_or_almost():
    assert gravity_transform([0, 0, 2]).tolist() == np.eye(3).tolist()
    assert gravity_transform([0, 0, -1]).tolist() == np.diag([1.0, -1.0, -1.0]).tolist()
    for normal in ([6e-9, 8e-9, -math.sqrt(1.0 - 1e-16)], [6e-4, 8e-4, -math.sqrt(1.0 - 1e-6)]):
        turn = gravity_transform(normal)
        assert turn @ UP == pytest.approx(normal, abs=ROUNDING)
        assert turn @ turn.T == pytest.approx(np.eye(3), abs=ROUNDING)
        # About the line in which the two planes meet.
        hinge = np.cross(UP, normal)
        assert turn @ hinge == pytest.approx(hinge, abs=ROUNDING)


def test_a_robot_put_on_a_known_slope_finds_slope_downhill_roll_and_pitch_again():
    recipe = lutgen.parse_recipe(tripod())
    random = np.random.default_rng(8)
    for _ in range(60):
        params = random.uniform([0.0, -0.7], [0.6, 0.8])
        slope, downhill = random.uniform(0.0, 0.3), random.uniform(-math.pi, math.pi)
        (contacts,), _ = lutgen.postures(recipe, [params])
        normal = np.cross(contacts[1] - contacts[0], contacts[2] - contacts[0])
        normal /= np.linalg.norm(normal)
        # The plane's frame: its z axis is the normal, and it is turned least from the body's: SciPy
        # picks the rotation of least angle for one pair of vectors.
        body_from_plane = Rotation.align_vectors([normal], [UP])[0].as_matrix()
        gravity = tilted(slope, downhill)
        up_dir = -9.81 * body_from_plane @ gravity
        ground = tangent_plane(Posture(recipe, params), up_dir)
        assert ground.slope == pytest.approx(slope, abs=1e-12)
        # atan2 of a tilt of at least 1e-3 or so.
        assert ground.downhill == pytest.approx(downhill, abs=1e-11)
        assert ground.normal == pytest.approx(normal, abs=1e-13)
        assert ground.gravity == pytest.approx(gravity, abs=1e-13)
        assert ground.height == pytest.approx(-normal @ contacts[0], abs=1e-13)
        # The body's z axis and x axis in a frame with z upward.
        up = up_dir / np.linalg.norm(up_dir)
        turned = Rotation.from_euler("xyz", [ground.roll, ground.pitch, 0.0]).inv()
        assert turned.apply(UP) == pytest.approx(up, abs=1e-13)
        # And T_g of convention P leads back to the body.
        back = body_gravity(recipe, [params], ground.gravity, "plane")[0]
        assert back == pytest.approx(-up, abs=1e-13)


def test_the_accelerometer_of_a_level_robot_says_where_the_slope_falls():
    # Gravity pulls towards what is low, the accelerometer reads the opposite.
    table = Posture(box(), [])
    for reading, heading in (((-0.3, 0.0, 1.0), 0.0), ((0.0, 0.3, 1.0), -90.0)):
        ground, tilt = tangent_plane(table, reading), math.atan(0.3)
        turned = [0.0, tilt] if heading == 0.0 else [tilt, 0.0]
        assert [ground.roll, ground.pitch] == pytest.approx(turned, abs=1e-12)
        assert math.degrees(ground.downhill) == pytest.approx(heading, abs=1e-12)
        assert math.tan(ground.slope) == pytest.approx(0.3, abs=1e-12)
        assert (ground.height, ground.standing) == (pytest.approx(HEIGHT, abs=1e-15), True)
    # Nothing is known of the ground where gravity pierces no facet.
    with pytest.raises(InputError, match=r"lies on no support facet \(got up_dir = \[0.0, 0.0, -1"):
        tangent_plane(table, [0, 0, -1])

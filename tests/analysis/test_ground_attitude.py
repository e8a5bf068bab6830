"""What an accelerometer says of body and ground, and the least rotation between them."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import lutgen
from lutgen.analysis.ground import gravity_transform, roll_pitch, tangent_plane
from lutgen.analysis.posture import Posture
from lutgen.analysis.tilt import tilted
from lutgen.channels.resting import body_gravity
from lutgen.errors import InputError
from tests.fixtures.recipes import feet, rigid, tripod

UP = np.array([0.0, 0.0, 1.0])
# A product of two rotations of unit vectors.
ROUNDING = 1e-14


TABLE = [(0.5, 0.4, -0.5), (-0.5, 0.4, -0.5), (-0.5, -0.4, -0.5), (0.5, -0.4, -0.5)]


def attitude(roll, pitch):
    """Return the rotation from the body's frame to a frame with z upward."""
    return np.asarray(Rotation.from_euler("xyz", [roll, pitch, 0.0]).as_matrix())


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
        turned = attitude(ground.roll, ground.pitch).T @ UP
        assert turned == pytest.approx(up, abs=1e-13)
        # And T_g of convention P leads back to the body.
        back = body_gravity(recipe, [params], ground.gravity, "plane")[0]
        assert back == pytest.approx(-up, abs=1e-13)


def test_the_accelerometer_of_a_level_robot_says_where_the_slope_falls():
    # Gravity pulls towards what is low, the accelerometer reads the opposite.
    assert np.degrees(roll_pitch((-0.5, 0.0, math.sqrt(0.75)))) == pytest.approx([0.0, 30.0])
    assert np.degrees(roll_pitch((0.0, 0.5, math.sqrt(0.75)))) == pytest.approx([30.0, 0.0])
    table = Posture(lutgen.parse_recipe(rigid(feet(TABLE))), [])
    for reading, heading in (((-0.3, 0.0, 1.0), 0.0), ((0.0, 0.3, 1.0), -90.0)):
        ground = tangent_plane(table, reading)
        assert math.degrees(ground.downhill) == pytest.approx(heading, abs=1e-12)
        assert math.tan(ground.slope) == pytest.approx(0.3, abs=1e-12)
        assert (ground.height, ground.standing) == (pytest.approx(0.5, abs=1e-15), True)


def test_nothing_is_known_of_the_ground_where_gravity_pierces_no_facet():
    recipe = lutgen.parse_recipe(rigid(feet(TABLE)))
    with pytest.raises(InputError, match=r"lies on no support facet \(got up_dir = \[0.0, 0.0, -1"):
        tangent_plane(Posture(recipe, []), [0, 0, -1])

"""Charts: round trips, seams, solid angles, the sign of gravity; rotations, and nodes in order."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from lutgen.chart import STANDARD_GRAVITY, Chart, gravito_inertial, gravity_from_up, unit_directions
from lutgen.errors import InputError
from lutgen.grid import Axis, Grid
from lutgen.vector import angles, rotation

SPHERE = Chart("sphere", 9)
CONE = Chart("cone", 9, math.radians(60.0))
COMPONENT = st.floats(-1.0, 1.0)
VECTORS = st.tuples(COMPONENT, COMPONENT, COMPONENT)


def rebuilt(face, u, v):
    """Return the unit direction of a place on a face, from the face table in words."""
    x, y, z = {
        0: (u, v, -1.0),
        1: (1.0, u, v),
        2: (-1.0, u, v),
        3: (u, 1.0, v),
        4: (u, -1.0, v),
        5: (u, v, 1.0),
    }[face]
    return np.array([x, y, z]) / math.sqrt(x * x + y * y + z * z)


@given(VECTORS, st.floats(1e-200, 1e200))
def test_every_direction_of_any_length_comes_back_from_the_sphere(vector, length):
    assume(max(abs(c) for c in vector) > 1e-100)
    down = unit_directions(vector)
    face, u, v, inside = SPHERE.locate([down * length])
    assert inside[0]
    assert abs(u[0]) <= 1.0
    assert abs(v[0]) <= 1.0
    # Two normalisations and one division: a few units in the last place of numbers <= 1.
    np.testing.assert_allclose(rebuilt(face[0], u[0], v[0]), down, rtol=0, atol=1e-15)


@given(VECTORS)
def test_the_cone_covers_exactly_the_square_of_its_face(vector):
    x, y, z = vector
    assume(z < -1e-6)
    limit = math.tan(math.radians(60.0))
    # Directions within rounding of the rim may fall on either side.
    assume(abs(max(abs(x), abs(y)) / -z - limit) > 1e-9)
    face, u, v, inside = CONE.locate([vector])
    assert face[0] == 0
    assert inside[0] == (max(abs(x), abs(y)) / -z < limit)
    # One normalisation and one division of numbers up to 1e6.
    np.testing.assert_allclose([u[0], v[0]], [x / -z, y / -z], rtol=1e-14, atol=1e-300)


@pytest.mark.parametrize("chart", [SPHERE, CONE, Chart("cone", 32, 0.3), Chart("sphere", 2)])
def test_every_node_is_inside_and_finds_its_own_coordinates(chart):
    # Antisymmetric to the last bit, even but for rounding, and out to the rim.
    np.testing.assert_array_equal(chart.coords, -chart.coords[::-1])
    np.testing.assert_allclose(chart.coords, np.linspace(-1.0, 1.0, chart.nodes) * chart.coords[-1])
    directions = chart.directions()
    assert directions.shape == (*chart.shape, 3)
    face, u, v, inside = chart.locate(directions.reshape(-1, 3))
    assert inside.all()
    wanted_face, wanted_v, wanted_u = np.meshgrid(
        np.arange(chart.faces), chart.coords, chart.coords, indexing="ij"
    )
    own = face == wanted_face.reshape(-1)
    # Only nodes on a seam may be claimed by a neighbour, and then by a lower number.
    assert (face <= wanted_face.reshape(-1)).all()
    rim = np.maximum(np.abs(wanted_u), np.abs(wanted_v)).reshape(-1)
    assert own[rim < chart.limit * 0.999].all()
    # One square root and two divisions, magnitudes up to tan 60 deg.
    np.testing.assert_allclose(u[own], wanted_u.reshape(-1)[own], rtol=0, atol=1e-15 * 4)
    np.testing.assert_allclose(v[own], wanted_v.reshape(-1)[own], rtol=0, atol=1e-15 * 4)


def test_a_seam_belongs_to_the_lower_face_number():
    seams = {
        *(((0, 0, -1), 0), ((1, 0, 0), 1), ((-1, 0, 0), 2), ((0, 1, 0), 3), ((0, -1, 0), 4)),
        *(((0, 0, 1), 5), ((1, 0, -1), 0), ((1, 1, 0), 1), ((-1, 1, 1), 2), ((0, -1, 1), 4)),
    }
    for vector, face in seams:
        assert SPHERE.locate([vector])[0].tolist() == [face]


def test_solid_angles_sum_to_the_sphere_and_to_the_square_patch_of_a_cone():
    for nodes in (2, 33):
        weights = Chart("sphere", nodes).solid_angle()
        assert (weights > 0.0).all()
        # 6 * 33^2 differences of arctangents, each good to about 1e-16.
        assert weights.sum() == pytest.approx(4.0 * math.pi, abs=1e-12)
    for tilt in np.radians([5.0, 85.0]):
        # A pyramid of half angle t over a square: 4 asin(sin^2 t), by spherical geometry.
        patch = 4.0 * math.asin(math.sin(tilt) ** 2)
        assert Chart("cone", 17, tilt).solid_angle().sum() == pytest.approx(patch, rel=1e-12)


def test_one_node_means_straight_down_and_nothing_else():
    chart = Chart("cone", 1, 1.0)
    assert chart.coords.tolist() == [0.0]
    assert chart.directions().tolist() == [[[[0.0, 0.0, -1.0]]]]
    assert chart.solid_angle().tolist() == [[[1.0]]]
    assert chart.locate([[0, 0, -3], [0.01, 0, -1]])[3].tolist() == [True, False]


def test_nose_down_tilts_the_reading_backward_and_gravity_forward():
    np.testing.assert_array_equal(gravity_from_up([0.0, 0.0, 9.81]), [0.0, 0.0, -1.0])
    assert not CONE.locate([[0, 0, 1], [1, 0, 0], [0.3, 0.2, 1e-300]])[3].any()
    up = [-math.sin(0.2), 0.0, math.cos(0.2)]
    # One normalisation.
    np.testing.assert_allclose(
        gravity_from_up(up), [math.sin(0.2), 0.0, -math.cos(0.2)], rtol=0, atol=1e-15
    )


def test_braking_leans_gravity_forward_by_the_acceleration_over_g():
    felt = gravito_inertial([0.0, 0.0, -1.0], [0, -3.0, 0])
    assert felt[1] / -felt[2] == pytest.approx(3.0 / STANDARD_GRAVITY)
    with pytest.raises(InputError, match="free fall"):
        gravito_inertial([0.0, 0.0, -1.0], [0, 0, -STANDARD_GRAVITY])


def test_what_is_no_direction_is_refused_with_what_was_asked():
    for bad in ([0.0, 0.0, 0.0], [np.nan, 0, 1], [np.inf, 0, 1]):
        for function in (unit_directions, gravity_from_up, SPHERE.locate):
            with pytest.raises(InputError, match=r"longer than 0 \(got \[.*\]\); leave out"):
                function([[0.0, 0.0, -1.0], bad])
    with pytest.raises(InputError, match=r"needs 3 components \(got .*\); pass x, y, z"):
        unit_directions([0.0, 1.0])
    with pytest.raises(InputError, match=r"shape \(m, 3\) \(got \(3,\)\); pass rows"):
        SPHERE.locate([0.0, 0.0, -1.0])


def test_the_angles_of_a_rotation_give_it_back_also_where_two_axes_fall_together():
    rng = np.random.default_rng(5)
    cases = [*rng.uniform(-math.pi, math.pi, (200, 3)).tolist()]
    cases += [[a, p, b] for p in (math.pi / 2, -math.pi / 2) for a, b in rng.normal(size=(20, 2))]
    for roll, pitch, yaw in cases:
        matrix = rotation((roll, pitch, yaw))
        # 1e-8: within 1e-9 of the pole the rest of the pitch is dropped.
        assert np.allclose(rotation(angles(matrix)), matrix, rtol=0, atol=1e-8)


KNOTS = [-1.0, 0.0, 0.25, 3.0]


def test_nodes_are_numbered_in_c_order_with_the_last_axis_fastest():
    grid = Grid((Axis("a", "rad", [0, 1]), Axis("b", "m", [10, 20, 30]), Axis("c", "m", [5, 6])))
    assert (grid.shape, grid.size) == ((2, 3, 2), 12)
    by_hand = [[a, b, c] for a in (0, 1) for b in (10, 20, 30) for c in (5, 6)]
    assert grid.params(np.arange(12)).tolist() == by_hand
    assert grid.params([11, 0, 7]).tolist() == [by_hand[11], by_hand[0], by_hand[7]]
    assert (Grid(()).shape, Grid(()).size, Grid(()).params([0, 0]).shape) == ((), 1, (2, 0))


def test_axes_are_equal_when_name_unit_and_knots_are_and_nobody_can_change_them():
    axis = Axis("alpha", "rad", KNOTS)
    assert axis == Axis("alpha", "rad", list(KNOTS))
    for other in (("beta", "rad", KNOTS), ("alpha", "m", KNOTS), ("alpha", "rad", [-1.0, 0.0])):
        assert axis != Axis(*other)
    with pytest.raises(ValueError, match="read-only"):
        axis.knots[0] = 9.0

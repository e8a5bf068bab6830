"""Charts: round trips, seams, solid angles and the sign of gravity."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from lutgen.chart import Chart, gravity_from_up, unit_directions
from lutgen.errors import InputError

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


@pytest.mark.parametrize("vector", [[0, 0, 1], [1, 0, 0], [0.3, 0.2, 1e-300], [1, 0, -1e-320]])
def test_directions_that_do_not_point_down_are_off_the_cone(vector):
    assert not CONE.locate([vector])[3][0]


@pytest.mark.parametrize("chart", [SPHERE, CONE, Chart("cone", 1, 1.0), Chart("sphere", 2)])
def test_every_node_is_inside_and_finds_its_own_coordinates(chart):
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


@pytest.mark.parametrize(
    ("vector", "face"),
    [
        ([0, 0, -1], 0),
        ([1, 0, 0], 1),
        ([-1, 0, 0], 2),
        ([0, 1, 0], 3),
        ([0, -1, 0], 4),
        ([0, 0, 1], 5),
        ([1, 0, -1], 0),
        ([-1, -1, -1], 0),
        ([1, 1, 0], 1),
        ([-1, 1, 1], 2),
        ([0, 1, 1], 3),
        ([0, -1, 1], 4),
    ],
)
def test_a_seam_belongs_to_the_lower_face_number(vector, face):
    assert SPHERE.locate([vector])[0].tolist() == [face]


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("other", range(3))
def test_directions_just_across_a_seam_stay_close_to_each_other(other, sign):
    along = [0.3, 0.3, 0.3]
    along[other], along[(other + 1) % 3] = 1.0, sign
    beside = np.array([along, along])
    beside[1, other] += 1e-12
    first, second = (
        rebuilt(face, u, v) for face, u, v in zip(*SPHERE.locate(beside)[:3], strict=True)
    )
    # The two inputs are 1e-12 apart, and a chart that jumps at the seam is off by 0.1 or more.
    np.testing.assert_allclose(first, second, rtol=0, atol=2e-12)


def test_coordinates_are_antisymmetric_to_the_last_bit_and_end_at_the_rim():
    for chart in (SPHERE, CONE, Chart("sphere", 25), Chart("cone", 32, 0.3)):
        np.testing.assert_array_equal(chart.coords, -chart.coords[::-1])
        assert chart.coords[-1] == chart.limit
        # linspace and its mirror differ by rounding only.
        np.testing.assert_allclose(np.diff(chart.coords), np.ptp(chart.coords) / (chart.nodes - 1))


@pytest.mark.parametrize("nodes", [2, 3, 8, 33])
def test_the_solid_angles_of_the_sphere_sum_to_four_pi(nodes):
    weights = Chart("sphere", nodes).solid_angle()
    assert weights.shape == (6, nodes, nodes)
    assert (weights > 0.0).all()
    # 6 * 33^2 differences of arctangents, each good to about 1e-16.
    assert weights.sum() == pytest.approx(4.0 * math.pi, abs=1e-12)


@pytest.mark.parametrize("tilt", [5.0, 45.0, 60.0, 85.0])
def test_the_solid_angles_of_the_cone_sum_to_its_square_patch(tilt):
    weights = Chart("cone", 17, math.radians(tilt)).solid_angle()
    # A pyramid of half angle t over a square: 4 asin(sin^2 t), by spherical geometry.
    patch = 4.0 * math.asin(math.sin(math.radians(tilt)) ** 2)
    assert weights.sum() == pytest.approx(patch, rel=1e-12)


def test_the_solid_angle_of_a_node_is_the_share_of_random_directions_nearest_to_it():
    chart = Chart("sphere", 4)
    rng = np.random.default_rng(5)
    face, u, v, _ = chart.locate(rng.normal(size=(200_000, 3)))
    near = [np.abs(chart.coords[:, None] - c).argmin(axis=0) for c in (v, u)]
    count = np.zeros(chart.shape)
    np.add.at(count, (face, *near), 1.0)
    # A share p of 2e5 draws has the deviation sqrt(p / 2e5) < 4e-4; five of them.
    np.testing.assert_allclose(
        count / 200_000, chart.solid_angle() / (4.0 * math.pi), rtol=0, atol=2e-3
    )


def test_one_node_means_straight_down_and_nothing_else():
    chart = Chart("cone", 1, 1.0)
    assert chart.coords.tolist() == [0.0]
    assert chart.directions().tolist() == [[[[0.0, 0.0, -1.0]]]]
    assert chart.solid_angle().tolist() == [[[1.0]]]
    assert chart.locate([[0, 0, -3], [0.01, 0, -1]])[3].tolist() == [True, False]


def test_on_level_ground_the_accelerometer_reads_up_and_gravity_points_down():
    np.testing.assert_array_equal(gravity_from_up([0.0, 0.0, 9.81]), [0.0, 0.0, -1.0])


def test_nose_down_tilts_the_reading_backward_and_gravity_forward():
    up = [-math.sin(0.2), 0.0, math.cos(0.2)]
    # One normalisation.
    np.testing.assert_allclose(
        gravity_from_up(up), [math.sin(0.2), 0.0, -math.cos(0.2)], rtol=0, atol=1e-15
    )


def test_directions_of_extreme_length_are_normalised_without_overflow():
    units = unit_directions([[3e200, 4e200, 0.0], [0.0, -3e-200, 4e-200]])
    # One division, one square root, one division.
    np.testing.assert_allclose(units, [[0.6, 0.8, 0.0], [0.0, -0.6, 0.8]], rtol=0, atol=1e-15)


@pytest.mark.parametrize("bad", [[0.0, 0.0, 0.0], [np.nan, 0, 1], [np.inf, 0, 1]])
@pytest.mark.parametrize("function", [unit_directions, gravity_from_up, SPHERE.locate])
def test_zero_nan_and_infinity_are_refused_with_the_vector(bad, function):
    with pytest.raises(InputError, match=r"finite and longer than 0 \(got \[.*\]\); leave out"):
        function([[0.0, 0.0, -1.0], bad])


@pytest.mark.parametrize("bad", [1.0, [0.0, 1.0]])
def test_a_direction_without_three_components_is_refused(bad):
    with pytest.raises(InputError, match=r"needs 3 components \(got .*\); pass x, y, z"):
        unit_directions(bad)


def test_locate_refuses_a_single_vector_without_rows():
    with pytest.raises(InputError, match=r"shape \(m, 3\) \(got \(3,\)\); pass rows"):
        SPHERE.locate([0.0, 0.0, -1.0])


@pytest.mark.parametrize(
    ("arguments", "got"),
    [
        (("disc", 9), "'disc'"),
        (("sphere", 1), "1"),
        (("cone", 0, 1.0), "0"),
        (("cone", 9, 1.6), "1.6"),
        (("cone", 9, math.nan), "nan"),
    ],
)
def test_a_chart_that_cannot_exist_is_refused_with_what_was_asked(arguments, got):
    with pytest.raises(InputError, match=rf"\(got {got}\); .+\."):
        Chart(*arguments)

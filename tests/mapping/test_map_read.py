"""What `StabilityMap.read` interpolates, and figures about a whole map."""

import math

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

import lutgen
from lutgen.errors import InputError
from lutgen.mapping import channel_range, share_that_tips
from lutgen.mapping.stability_map import interpolate, locate
from lutgen.quantities import CHANNELS
from tests.fixtures.recipes import feet, rigid, rocker, tripod, without_limits

TETRAHEDRON = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
SQUARE = [(1, 1, -1), (-1, 1, -1), (-1, -1, -1), (1, -1, -1)]
STANDS, ROCKS, TIPS = 0, 1, 2


@pytest.fixture
def cone(swept):
    return lutgen.load_map(swept / "cone.h5")


@pytest.fixture(scope="module")
def rocks(tmp_path_factory):
    text = rocker(channels=CHANNELS, nodes=35, max_tilt=62.0)
    return lutgen.sweep(lutgen.parse_recipe(text), tmp_path_factory.mktemp("status") / "a.h5")


def queries(count, tilt=1.0):
    """Random parameters of the tripod, and directions within about 50 deg of straight down."""
    rng = np.random.default_rng(17)
    params = np.column_stack(
        [rng.uniform(0.0, 0.6, count), np.radians(rng.uniform(-40.0, 50.0, count))]
    )
    slope = rng.uniform(-tilt, tilt, (count, 2))
    return params, np.column_stack([slope, np.full(count, -1.0)])


def test_reading_between_the_nodes_of_a_fine_map_is_near_the_exact_value(tmp_path):
    recipe = lutgen.parse_recipe(tripod("reach = 13, swing = 25", nodes=33, max_tilt=60.0))
    params, gravity = queries(200)
    got = lutgen.sweep(recipe, tmp_path / "fine.h5").read(params, gravity)["tip_angle"]
    each = zip(params, gravity, strict=True)
    want = np.array([lutgen.evaluate(recipe, [q], g)["tip_angle"][0, 0] for q, g in each])
    # The angle changes no faster than gravity turns, but has a kink where another axis becomes the
    # nearest: in a cell of 6 deg of tilt that costs at most half of the cell.
    assert np.abs(got - want).max() < np.radians(3.0)
    assert np.abs(got - want).mean() < np.radians(0.2)


def test_one_posture_or_one_direction_stands_for_all(cone):
    params, gravity = queries(5)
    for one in (params[:1], params[0], params[0].tolist()):
        want = cone.read(np.tile(params[0], (5, 1)), gravity)
        np.testing.assert_array_equal(cone.read(one, gravity)["sdg"], want["sdg"])
    for down in (gravity[:1], gravity[0] * 9.81):
        want = cone.read(params, np.tile(gravity[0], (5, 1)))
        np.testing.assert_allclose(cone.read(params, down)["sdg"], want["sdg"], rtol=1e-9)
    assert cone.read(params[0], gravity[0])["tip_angle"].shape == (1,)
    assert cone.read(np.empty((0, 2)), gravity[:1])["tip_angle"].shape == (0,)


@pytest.mark.parametrize(
    ("params", "gravity"),
    [
        ([[0.1]], [[0, 0, -1]]),
        ([[0.1, 0.2, 0.3]], [[0, 0, -1]]),
        ([[[0.1, 0.2]]], [[0, 0, -1]]),
        ([[0.1, 0.2]] * 2, [[0, 0, -1]] * 3),
        ([[0.1, 0.2]], [[0, 0]]),
        ([[0.1, 0.2]], [[0, 0, 0]]),
        ([[0.1, 0.2]], [[0, 0, np.nan]]),
        ([[0.1, np.nan]], [[0, 0, -1]]),
        ([[0.7, 0.2]], [[0, 0, -1]]),
        ([[0.1, 0.2], [-0.001, 0.2]], [[0, 0, -1]]),
        ([[0.1, np.inf]], [[0, 0, -1]]),
    ],
)
def test_wrong_arguments_of_read_are_refused(cone, params, gravity):
    with pytest.raises(InputError, match=r"\(got "):
        cone.read(params, gravity)
    with pytest.raises(InputError, match="no channel 'bogus'"):
        cone.read([[0.1, 0.2]], [0, 0, -1], ["bogus"])


def test_a_parameter_in_deg_is_refused_with_both_units_and_directions_off_the_chart_read_nan(cone):
    with pytest.raises(InputError, match=r"swing must lie in -40 to 50 deg .*= 30 rad"):
        cone.read([[0.1, 30.0]], [0, 0, -1])
    # What is beyond the end by a rounding is at the end.
    last = [axis.knots[-1] for axis in cone.axes]
    beyond = cone.read(np.nextafter(last, 9.0), [0, 0, -1])["sdg"]
    assert beyond == cone.read(last, [0, 0, -1])["sdg"]
    params, _ = queries(3)
    got = cone.read(params, [[0, 0, 1], [1, 0, 0], [1.8, 0, -1]])  # tan 60 deg is 1.73
    for name in cone.channels:
        assert np.isnan(got[name]).all(), name


def test_facet_is_that_of_the_nearest_node(cone):
    params, gravity = queries(500, 1.6)
    index = [
        np.abs(axis.knots[None] - params[:, k, None]).argmin(axis=1)
        for k, axis in enumerate(cone.axes)
    ]
    u, v = (np.abs(cone.chart.coords[None] - gravity[:, k, None]).argmin(axis=1) for k in (0, 1))
    want = cone["facet"][index[0], index[1], 0, v, u]
    assert {-1.0, 0.0} <= set(want.tolist())
    np.testing.assert_array_equal(cone.read(params, gravity)["facet"], want)


def test_a_status_is_the_worst_of_the_nodes_around_and_that_of_a_node_itself(rocks):
    rng = np.random.default_rng(4)
    u, v = rng.uniform(-1.8, 1.8, (2, 4000))
    got = rocks.read([], np.c_[u, v, -np.ones(4000)], ["status"])["status"]
    nodes, coords = rocks["status"][0], rocks.chart.coords
    column, row = (np.searchsorted(coords, place, "right") - 1 for place in (u, v))
    corners = [nodes[row + i, column + j] for i in (0, 1) for j in (0, 1)]
    np.testing.assert_array_equal(got, np.max(corners, axis=0))
    assert set(got) == {STANDS, ROCKS, TIPS}
    assert (np.min(corners, axis=0) != got).any()
    # Though a direction comes back from its unit vector a hair beside the node.
    at_nodes = rocks.read([], rocks.chart.directions().reshape(-1, 3), ["status"])["status"]
    np.testing.assert_array_equal(at_nodes, nodes.ravel())


def test_factor_and_height_are_nan_exactly_where_the_angle_says_that_it_tips(cone, swept):
    params, gravity = queries(2000, 0.8)
    got = cone.read(params, gravity)
    tips = got["tip_angle"] < 0.0
    assert 0.1 < tips.mean() < 0.9
    np.testing.assert_array_equal(np.isnan(got["sdg"]), tips)
    np.testing.assert_array_equal(np.isnan(got["height"]), tips)
    # The rule holds for a factor that is read alone, too.
    np.testing.assert_array_equal(cone.read(params, gravity, ["sdg"])["sdg"], got["sdg"])
    # Without the angle it is NaN where most of the cell tips: the same but within half a cell.
    without = lutgen.load_map(swept / "alone.h5").read(params, gravity)["sdg"]
    assert (np.isnan(without) == tips).mean() > 0.9


def test_seams_of_the_sphere_are_crossed_without_a_jump(swept):
    sphere = lutgen.load_map(swept / "sphere.h5")
    rng = np.random.default_rng(8)
    on_seam = np.column_stack([np.ones(200), rng.uniform(-0.9, 0.9, 200), -np.ones(200)])
    either = [on_seam * (1.0 + step, 1.0, 1.0) for step in (-1e-9, 1e-9)]
    one, other = (sphere.read([0.2, 0.1], side, ["tip_angle"])["tip_angle"] for side in either)
    # The chart's slope is about 1 rad per unit: 1e-8 is ten times the step.
    np.testing.assert_allclose(one, other, atol=1e-8)


@pytest.mark.parametrize("channels", [("tip_angle",), ("sdg",), ("status",), ("facet",)])
def test_the_share_that_tips_weighs_nodes_by_their_solid_angle(tmp_path, channels, cut):
    # The cone of 60 deg; the stool stands where |u|, |v| < 1, which is 1/6 of the sphere.
    text = rigid(feet(SQUARE), nodes=201, max_tilt=60.0, channels=channels)
    # Blocks of a part of the posture.
    cut(9_000)
    stool = lutgen.sweep(lutgen.parse_recipe(text), tmp_path / "a.h5")
    t = math.tan(math.radians(60.0))
    whole = 4.0 * math.atan(t * t / math.sqrt(1.0 + 2.0 * t * t))
    want = 1.0 - (4.0 * math.pi / 6.0) / whole
    share = share_that_tips(stool)
    if channels == ("facet",):
        assert share is None
        return
    # The boundary is off by at most half a cell, 0.0087 of u, along four sides of length 2.
    assert share == pytest.approx(want, abs=0.5 * 4 * 2 * 0.0087 / whole)
    # A mere count of nodes would say 0.67.
    assert want < 0.4


def test_a_robot_that_cannot_tip_has_the_share_zero_and_ranges_leave_out_what_is_not_finite(
    cone, tmp_path
):
    recipe = without_limits(rigid(feet(TETRAHEDRON), chart="sphere", nodes=5))
    assert share_that_tips(lutgen.sweep(recipe, tmp_path / "a.h5")) == 0.0
    assert np.isnan(cone["sdg"]).any()
    low, high = channel_range(cone, "sdg")
    assert (low, high) == (np.nanmin(cone["sdg"]), np.nanmax(cone["sdg"]))
    assert low < high


def located(axes, points):
    return [locate(knots, points[:, d]) for d, knots in enumerate(axes)]


def test_a_value_has_the_cell_of_the_knot_below_it_and_what_is_beyond_an_end_is_at_it():
    knots = np.array([-1.0, 0.0, 0.25, 3.0])
    index, frac = locate(knots, np.array([*knots, -0.25, 0.125, 1.625, -1.1, np.inf]))
    assert index.tolist() == [0, 1, 2, 2, 0, 1, 2, 0, 2]
    assert frac.tolist() == [0.0, 0.0, 0.0, 1.0, 0.75, 0.5, 0.5, 0.0, 1.0]
    assert locate(knots[:1], knots)[1].tolist() == [0.0] * 4


@pytest.mark.parametrize("dimensions", [1, 2, 3, 4, 5])
def test_values_are_interpolated_as_scipy_does_and_nodes_are_returned_bit_for_bit(dimensions):
    rng = np.random.default_rng(10 + dimensions)
    axes = [np.cumsum(rng.uniform(0.2, 1.5, rng.integers(2, 6))) for _ in range(dimensions)]
    values = rng.normal(size=[a.size for a in axes]).astype(np.float32)
    points = np.stack([rng.uniform(knots[0], knots[-1], 200) for knots in axes], axis=1)
    got, _ = interpolate(values, located(axes, points))
    want = RegularGridInterpolator(axes, values.astype(np.float64))(points)
    np.testing.assert_allclose(got, want, atol=1e-13)  # sums of 32 numbers of about 1
    # A node, whatever is around it.
    values[rng.random(values.shape) < 0.3] = np.nan
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    got, present = interpolate(values, located(axes, nodes.reshape(-1, dimensions)))
    np.testing.assert_array_equal(got, values.ravel().astype(np.float64))
    np.testing.assert_array_equal(present, ~np.isnan(values.ravel()))


def test_corners_that_are_nan_are_left_out_of_the_mean():
    axes = [np.array([0.0, 1.0])] * 2
    values = np.array([[1.0, 2.0], [np.nan, 4.0]])
    got, present = interpolate(values, located(axes, np.array([[0.25, 0.5], [1.0, 0.25]])))
    # Weights 3/8, 3/8, (1/8), 1/8 at the first point; only the corner 4 counts at the second.
    assert got[0] == pytest.approx((3 * 1.0 + 3 * 2.0 + 1 * 4.0) / 7, rel=1e-15)
    assert got[1] == 4.0
    assert present.tolist() == pytest.approx([7 / 8, 0.25], rel=1e-15)

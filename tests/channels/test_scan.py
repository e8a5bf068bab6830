"""The float32 rows of a sweep against `measure_postures`, node by node."""

import math
from itertools import pairwise

import numpy as np
import pytest

from lutgen.channels.evaluation import measure_postures
from lutgen.channels.exact import Setting, wanted_channels
from lutgen.channels.rows import nodes_of
from lutgen.channels.scan import scan_part
from lutgen.chart import Chart
from lutgen.quantities import CHANNELS
from lutgen.support import TIPS, acceptance, pack

FAST = ("sdg", "height", "tip_angle", "facet", "status")
LIMITS = {
    "none": (None, None),
    "default": (np.radians(90.0), np.radians(30.0)),
    "no rocking": (np.radians(180.0), 0.0),
}
CHARTS = {
    "cone": Chart("cone", 33, np.radians(60.0)),
    "steep cone": Chart("cone", 19, np.radians(84.0)),
    "sphere": Chart("sphere", 13),
}


class Robots:
    """Postures (m, n, ...) of one kind of robot, as `measure_postures` takes them."""

    def __init__(self, centre, radius=0.0, kind=0):
        m, n = centre.shape[:2]
        self.centre = centre
        self.axis = np.zeros((m, n, 3))
        self.radius = np.full(n, radius)
        self.kind = np.full(n, kind, np.int64)
        if kind == 2:
            self.axis[:] = (0.0, 1.0, 0.0)


def random_feet(seed, m, n):
    """Feet around and below the com, some of them above it."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(m, n, 3)) * [1.0, 0.8, 0.4]
    points[..., 2] -= 0.7
    return Robots(points)


def random_wheels(seed, m, n):
    """Discs on parallel axles, roughly on one plane: their facets have gaps between them."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(-1.0, 1.0, size=(m, n, 3))
    points[..., 2] = rng.uniform(-0.75, -0.55, size=(m, n))
    return Robots(points, 0.3, 2)


def rows(robots, chart, bounds=(None, None), channels=FAST):
    """Scan all rows of every posture, in three parts; return (m, rows, nodes) per channel."""
    shape = (len(robots.centre), chart.faces * chart.nodes, chart.nodes)
    lines, out = shape[0] * shape[1], np.full((len(CHANNELS), math.prod(shape)), 9e9, np.float32)
    for begin, end in pairwise(part * lines // 3 for part in range(4)):
        scan_part(
            *(begin, end, pack(robots.centre, robots.axis, robots.radius, robots.kind)),
            *(Setting(acceptance(*bounds), wanted_channels(channels)), nodes_of(chart)),
            *((0, shape[1]), out),
        )
    return {name: out[CHANNELS.index(name)].reshape(shape) for name in channels}


def exact(robots, chart, bounds, channels=FAST):
    """Return what `measure_postures` says, in the same shape."""
    primitives = pack(robots.centre, robots.axis, robots.radius, robots.kind)
    got = measure_postures(
        primitives, chart.directions().reshape(1, -1, 3), channels, acceptance(*bounds)
    )
    shape = (len(robots.centre), chart.faces * chart.nodes, chart.nodes)
    return {name: value.reshape(shape) for name, value in got.items()}


def assert_equal_within_float32(got, want):
    """Compare every node that is not within rounding of a tip-over axis."""
    # Both paths place a boundary to about 1e-15 rad; nearer than 1e-9 either verdict is right.
    clear = np.abs(want["tip_angle"]) > 1e-9
    assert clear.mean() > 0.99
    for name, value in got.items():
        # float32 rounds to 6e-8; |SD_g| is a square root and a quotient of rounded numbers and the
        # arcsine is good to 3e-7.  What cancels does so in float64.
        np.testing.assert_allclose(
            value[clear], want[name][clear], rtol=5e-7, atol=1e-12, equal_nan=True, err_msg=name
        )


def assert_one_verdict(got):
    """All fast channels must agree at every node, at the boundary too."""
    tips = got["tip_angle"] < 0.0
    np.testing.assert_array_equal(np.isnan(got["sdg"]), tips)
    np.testing.assert_array_equal(np.isnan(got["height"]), tips)
    np.testing.assert_array_equal(got["facet"] == -1.0, tips)
    np.testing.assert_array_equal(got["status"] == TIPS, tips)
    assert not np.isnan(got["tip_angle"]).any()


@pytest.mark.parametrize("bounds", LIMITS.values(), ids=LIMITS)
@pytest.mark.parametrize("chart", CHARTS.values(), ids=CHARTS)
def test_rows_of_feet_and_of_wheels_with_gaps_equal_the_exact_channels_within_float32(
    chart, bounds
):
    robots = [random_feet(100 + n, 12, n) for n in range(3, 9)]
    robots += [random_wheels(200 + n, 6, n) for n in (3, 4, 6)]
    tips = []
    for kind in robots:
        got = rows(kind, chart, bounds)
        assert_equal_within_float32(got, exact(kind, chart, bounds))
        assert_one_verdict(got)
        tips.append((got["tip_angle"] < 0.0).mean())
    # Both verdicts must occur, or the comparison would say little.
    assert 0.05 < np.mean(tips) < 0.99


def test_rows_with_margins_equal_the_exact_channels_within_float32():
    chart, bounds = CHARTS["cone"], LIMITS["default"]
    for robots in (random_feet(303, 6, 3), random_feet(305, 6, 5)):
        got = rows(robots, chart, bounds, CHANNELS)
        assert_equal_within_float32(got, exact(robots, chart, bounds, CHANNELS))
        assert_one_verdict(got)
        for name in ("margin", "energy_margin"):
            np.testing.assert_array_equal(got[name] < 0.0, got["tip_angle"] < 0.0)


CUBE = [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
OCTAHEDRON = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
TETRAHEDRON = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]
PRISM = [[2, 0, z] for z in (-1, 1)] + [[-1, y, z] for y in (-1, 1) for z in (-1, 1)]
CLOSED = {"cube": CUBE, "octahedron": OCTAHEDRON, "tetrahedron": TETRAHEDRON, "prism": PRISM}


@pytest.mark.parametrize("solid", CLOSED.values(), ids=CLOSED)
def test_nodes_on_shared_edges_of_closed_solids_always_stand(solid):
    # The edges of these solids run through nodes: u = 0, u = v, and the seams u = 1.  Scaled by
    # thirds the planes are not exact any more, and rounding decides.
    for factor in (1.0, 1.0 / 3.0, 0.1):
        robots = Robots(np.array([solid], dtype=np.float64) * factor)
        for chart in (Chart("sphere", 9), Chart("sphere", 16), Chart("cone", 17, np.pi / 4)):
            got = rows(robots, chart)
            assert not np.isnan(got["sdg"]).any()
            assert (got["tip_angle"] == np.float32(np.pi)).all()
            # Of facets that meet at a node the lower number has it, as in `measure_postures`.
            np.testing.assert_array_equal(got["facet"], exact(robots, chart, (None, None))["facet"])

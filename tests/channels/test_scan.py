"""The float32 rows of a sweep against the exact channels, at every node."""

from itertools import pairwise

import numpy as np
import pytest

import lutgen
from lutgen.channels.exact import Setting
from lutgen.channels.measuring import measure_postures
from lutgen.channels.rows import nodes_of
from lutgen.channels.scan import Scanner, scan_part, scratch_for
from lutgen.chart import Chart
from lutgen.quantities import CHANNELS, wanted
from lutgen.recipe import start_recipe
from lutgen.support import acceptance, pack
from tests.fixtures.commands import data, stdout
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import feet, rigid
from tests.support.postures import EXACT, assert_one_verdict, rows_of
from tests.support.postures import exact as in_plane

FAST = ("sdg", "height", "tip_angle", "facet", "status")
VERDICT = ("sdg", "tip_angle")
TIP = CHANNELS.index("tip_angle")
LIMITS = {
    "none": (None, None),
    "default": (np.radians(80.0), np.radians(30.0)),
    "no rocking": (np.radians(180.0), 0.0),
}
CHARTS = {
    "cone": Chart("cone", 33, np.radians(60.0)),
    "steep cone": Chart("cone", 19, np.radians(84.0)),
    "sphere": Chart("sphere", 13),
}
ALL = pytest.mark.parametrize("limits", LIMITS.values(), ids=LIMITS)


def points(places):
    return pack(places, np.zeros_like(places), 0.0, 0)


def random_feet(seed, m, n):
    """Feet around and below the com, some of them above it."""
    return points(
        np.random.default_rng(seed).normal(size=(m, n, 3)) * [1.0, 0.8, 0.4] - [0, 0, 0.7]
    )


def random_wheels(seed, m, n):
    """Discs on parallel axles, roughly on one plane: their facets have gaps between them."""
    places = np.random.default_rng(seed).uniform([-1, -1, -0.75], [1, 1, -0.55], (m, n, 3))
    return pack(places, np.broadcast_to([0.0, 1.0, 0.0], places.shape), 0.3, 2)


def rows(primitives, chart, limits, channels=FAST):
    """Scan all rows of every posture, in three parts; return (m, nodes) per channel."""
    m, per_posture = len(primitives), chart.faces * chart.nodes
    lines = m * per_posture
    out = np.full((len(CHANNELS), lines * chart.nodes), 9e9, np.float32)
    setting = Setting(acceptance(*limits), np.array(wanted(channels)))
    for begin, end in pairwise(part * lines // 3 for part in range(4)):
        memory = scratch_for(nodes_of(chart))
        scan_part((begin, end), memory, primitives, setting, nodes_of(chart), out)
    return {name: out[CHANNELS.index(name)].reshape(m, -1) for name in channels}


def exact(primitives, chart, limits, channels=FAST):
    directions = chart.directions().reshape(1, -1, 3)
    return measure_postures(primitives, directions, channels, acceptance(*limits))


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


@ALL
@pytest.mark.parametrize("chart", CHARTS.values(), ids=CHARTS)
def test_rows_of_feet_and_of_wheels_with_gaps_equal_the_exact_channels_within_float32(
    chart, limits
):
    robots = [random_feet(100 + n, 12, n) for n in range(3, 9)]
    robots += [random_wheels(200 + n, 6, n) for n in (3, 4, 6)]
    tips = []
    for robot in robots:
        got = rows(robot, chart, limits)
        assert_equal_within_float32(got, exact(robot, chart, limits))
        assert_one_verdict(got)
        assert not np.isnan(got["tip_angle"]).any()
        tips.append((got["tip_angle"] < 0.0).mean())
    # Both verdicts must occur, or the comparison would say little.
    assert 0.05 < np.mean(tips) < 0.99


CLOSED = {
    "cube": [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)],
    "octahedron": [*np.eye(3).tolist(), *(-np.eye(3)).tolist()],
    "tetrahedron": [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]],
    "prism": [[x, y, z] for x, y in ((2, 0), (-1, -1), (-1, 1)) for z in (-1, 1)],
}


@pytest.mark.parametrize("solid", CLOSED.values(), ids=CLOSED)
def test_nodes_on_shared_edges_of_closed_solids_always_stand(solid):
    # The edges of these solids run through nodes: u = 0, u = v, and the seams u = 1.  Scaled by
    # thirds the planes are not exact any more, and rounding decides.
    for factor in (1.0, 1.0 / 3.0, 0.1):
        robot = points(np.array([solid], dtype=np.float64) * factor)
        for chart in (Chart("sphere", 9), Chart("sphere", 16), Chart("cone", 17, np.pi / 4)):
            got = rows(robot, chart, LIMITS["none"])
            assert not np.isnan(got["sdg"]).any()
            assert (got["tip_angle"] == np.float32(np.pi)).all()
            # A node at which facets meet belongs to the lower number.
            np.testing.assert_array_equal(
                got["facet"], exact(robot, chart, LIMITS["none"])["facet"]
            )


def on_knots(chart, count, rng):
    """Return rectangles whose sides are rows and columns of nodes.

    They are scaled by chance, so that rounding places a side on either side of its row.
    """
    scale = rng.uniform(0.1, 3.0, (count, 1))
    knots = rng.permuted(np.tile(chart.coords, (2, count, 1)), axis=2)
    sides = zip(*(np.sort(knots[..., :2]) * scale), -scale[:, 0], strict=True)
    return [rows_of(rng.permutation([(a, b, z) for a in x for b in y])) for x, y, z in sides]


@pytest.mark.parametrize("limits", [LIMITS["none"], LIMITS["default"]], ids=["none", "default"])
def test_3000_robots_on_one_plane_have_the_exact_verdict_at_every_node(limits):
    rng = np.random.default_rng(50)
    asked = on_axis = 0
    for nodes in (9, 17, 33):
        chart = Chart("cone", nodes, np.radians(60.0))
        made = on_knots(chart, 200, rng) + [in_plane(EXACT[k % 6], rng) for k in range(800)]
        for count in {len(one) for one in made}:
            robots = np.stack([one for one in made if len(one) == count])
            tips = rows(robots, chart, limits, VERDICT)["tip_angle"] < 0.0
            angle = exact(robots, chart, limits, VERDICT)["tip_angle"]
            np.testing.assert_array_equal(tips, angle < 0.0)
            assert 0.05 < tips.mean() < 0.95
            asked += len(robots)
            on_axis += (np.abs(angle) < 1e-12).sum()
    assert asked == 3 * 1000
    # Nodes on a tip-over axis are what rounding can get wrong.
    assert on_axis > 5000


@pytest.mark.parametrize("path", sorted(MAPS.glob("*.toml")), ids=lambda path: path.stem)
def test_every_node_of_a_gallery_map_has_the_exact_verdict(path):
    recipe = lutgen.load_recipe(path)
    params = recipe.grid.params(np.arange(recipe.grid.size))
    scanner = Scanner(recipe, recipe.chart, VERDICT)
    directions = recipe.chart.directions().reshape(-1, 3)
    for some in np.array_split(params, 1 + len(params) // 500):
        out = np.empty((len(CHANNELS), len(some) * len(directions)), np.float32)
        scanner.fill(some, out)
        angle = lutgen.evaluate(recipe, some, directions, channels=("tip_angle",))["tip_angle"]
        np.testing.assert_array_equal(out[TIP].reshape(angle.shape) < 0.0, angle < 0.0)


@pytest.mark.parametrize(
    ("x", "y", "height", "nodes"),
    [
        ((-0.23954196431732422, 0.3205070860690768), 0.24655697993049897, 0.3309982257650182, 17),
        ((-200.06, 199.94), 150.0, 11.1, 33),
    ],
    ids=["a table", "a statue of millimetres"],
)
def test_a_robot_stands_at_the_nodes_that_are_between_its_feet(x, y, height, nodes):
    chart = Chart("cone", nodes, np.radians(60.0))
    table = points(np.array([[[a, b, -height] for a in x for b in (-y, y)]]))
    stands = rows(table, chart, LIMITS["default"], VERDICT)["tip_angle"] >= 0.0
    u = chart.coords * height
    inside = (np.abs(u)[:, None] <= y) & (x[0] <= u) & (u <= x[1])
    np.testing.assert_array_equal(stands[0], inside.ravel())


BODY = '[[robot.link]]\nname = "body"\nmass = 1.0\ncom = [0.02, -0.01, 0.85]\n'
FEET = feet([(x, y, -0.1) for x in (-0.35, 0.35) for y in (-0.1, 0.1)])
BOX = rigid(BODY + FEET, nodes=9, max_tilt=60.0)
EDGE = BOX.replace("com = [0.02, -0.01, 0.85]", "com = [0.0, 0.1, 0.3]")
ARM = ["-p", "swing=-120", "-p", "shoulder=15", "-p", "elbow=-20"]


@pytest.mark.parametrize(
    ("text", "posture", "gravity", "tip"),
    [
        (BOX, [], "0,0.4330127018922192,-1", -16.8),
        (start_recipe("arm"), ARM, "0,-0.541265877365,-1", -2.88),
        # Its com is exactly above an edge.
        (EDGE, [], "0,0,-1", 0.0),
    ],
    ids=["box", "arm", "edge"],
)
def test_a_map_says_whether_a_robot_tips_as_its_recipe_does(tmp_path, text, posture, gravity, tip):
    recipe, stability_map = tmp_path / "robot.toml", tmp_path / "robot.h5"
    recipe.write_text(text)
    lutgen.sweep(lutgen.load_recipe(recipe), stability_map)
    for source in (recipe, stability_map):
        found = data("eval", source, *posture, "-g", gravity, code=3 if tip else 0)
        assert found["tip_angle_deg"] == pytest.approx(tip, abs=0.1 if tip else 1e-6)
    if not tip:
        assert "tips over on level ground" not in stdout("limits", recipe)

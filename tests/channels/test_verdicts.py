"""Verdicts of a sweep against `evaluate`, at every node."""

import numpy as np
import pytest

import lutgen
from lutgen.channels.evaluation import measure_postures
from lutgen.channels.exact import Setting, wanted_channels
from lutgen.channels.rows import nodes_of
from lutgen.channels.scan import Scanner, scan
from lutgen.chart import Chart
from lutgen.quantities import CHANNELS
from lutgen.recipe import start_recipe
from lutgen.support import acceptance, pack
from tests.fixtures.commands import data, stdout
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import feet, rigid

GALLERY = sorted(MAPS.glob("*.toml"))
LIMITS = {"none": (None, None), "default": (np.radians(80.0), np.radians(30.0))}
TIP = CHANNELS.index("tip_angle")


def in_steps(low, high, size, rng):
    """Return numbers in steps of 5 cm, as people give positions of feet."""
    return np.round(rng.uniform(low, high, size) / 0.05) * 0.05


def rectangles(count, rng):
    x, y = in_steps(-0.6, 0.6, (2, count, 2), rng)
    return np.stack([np.stack([x[:, i], y[:, j]], -1) for i in (0, 1) for j in (0, 1)], 1)


def polygons(count, corners, rng):
    turn = np.arange(corners) * 2.0 * np.pi / corners
    ring = np.stack([np.cos(turn), np.sin(turn)], -1)
    return rng.uniform(0.1, 1.0, (count, 1, 1)) * ring + in_steps(-0.2, 0.2, (count, 1, 2), rng)


def two_rows(count, length, rng):
    x, y = in_steps(-0.6, 0.6, (count, length), rng), in_steps(0.05, 0.6, (count, 1), rng)
    sides = [np.stack([x, np.broadcast_to(side, x.shape)], -1) for side in (y, -y)]
    return np.concatenate(sides, 1)


def on_node_lines(count, chart, rng):
    """Return rectangles at z = -1 whose sides are rows and columns of nodes."""
    x, y = np.sort(rng.permuted(np.tile(chart.coords, (2, count, 1)), axis=2)[..., :2])
    return np.stack([np.stack([x[:, i], y[:, j]], -1) for i in (0, 1) for j in (0, 1)], 1)


def on_level_ground(corners, height, rng):
    """Return points (m, n, 3) that far below the com, each robot's in an order of chance."""
    points = np.concatenate([corners, np.broadcast_to(-height, (*corners.shape[:2], 1))], -1)
    return np.stack([rng.permutation(robot) for robot in points])


def tips_of_rows_and_exact(points, chart, limits):
    """Return whether each node tips by the rows of a sweep, and its exact tip angle."""
    m, n = points.shape[:2]
    primitives = pack(points, np.zeros((m, n, 3)), np.zeros(n), np.zeros(n, np.int64))
    rows = chart.faces * chart.nodes
    out = np.empty((len(CHANNELS), m * rows * chart.nodes), np.float32)
    setting = Setting(acceptance(*limits), wanted_channels(("sdg", "tip_angle")))
    scan(primitives, setting, nodes_of(chart), (0, rows), out)
    directions = chart.directions().reshape(-1, 3)
    exact = measure_postures(primitives, directions[None], ("tip_angle",), acceptance(*limits))
    return out[TIP].reshape(m, -1) < 0.0, exact["tip_angle"]


@pytest.mark.parametrize("limits", LIMITS.values(), ids=LIMITS)
def test_10000_level_robots_in_any_order_of_contacts_have_the_exact_verdict_at_every_node(limits):
    rng = np.random.default_rng(50)
    robots = on_axis = 0
    for nodes in (9, 17, 33):
        chart = Chart("cone", nodes, np.radians(60.0))
        shapes = [rectangles(1500, rng), *(polygons(300, n, rng) for n in (4, 5, 6, 8))]
        shapes += [two_rows(300, n, rng) for n in (3, 4)]
        heights = [rng.uniform(0.1, 0.9, (len(s), 1, 1)) for s in shapes]
        heights[0] = in_steps(0.1, 0.9, heights[0].shape, rng)
        # Scaled by chance, rounding places a side on either side of its row of nodes.
        scale = rng.uniform(0.1, 3.0, (200, 1, 1))
        shapes.append(on_node_lines(200, chart, rng) * scale)
        heights.append(scale)
        for corners, height in zip(shapes, heights, strict=True):
            points = on_level_ground(corners, height, rng)
            tips, exact = tips_of_rows_and_exact(points, chart, limits)
            np.testing.assert_array_equal(tips, exact < 0.0)
            assert 0.05 < tips.mean() < 0.95
            robots += len(points)
            on_axis += (np.abs(exact) < 1e-12).sum()
    assert robots == 3 * 3500
    # Nodes on a tip-over axis are what rounding can get wrong.
    assert on_axis > 5000


@pytest.mark.parametrize("path", GALLERY, ids=lambda path: path.stem)
def test_every_node_of_a_gallery_map_has_the_exact_verdict(path):
    recipe = lutgen.load_recipe(path)
    chart = recipe.chart
    params = recipe.grid.params(np.arange(recipe.grid.size))
    rows = chart.faces * chart.nodes
    scanner = Scanner(recipe, chart, ("sdg", "tip_angle"))
    directions = chart.directions().reshape(-1, 3)
    for some in np.array_split(params, 1 + len(params) // 500):
        out = np.empty((len(CHANNELS), len(some) * rows * chart.nodes), np.float32)
        scanner.fill(some, 0, rows, out)
        exact = lutgen.evaluate(recipe, some, directions, channels=("tip_angle",))["tip_angle"]
        np.testing.assert_array_equal(out[TIP].reshape(exact.shape) < 0.0, exact < 0.0)


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
    places = np.array([[[a, b, -height] for a in x for b in (-y, y)]])
    tips, _ = tips_of_rows_and_exact(places, chart, LIMITS["default"])
    u = chart.coords * height
    inside = (np.abs(u)[:, None] <= y) & (x[0] <= u) & (u <= x[1])
    np.testing.assert_array_equal(~tips[0], inside.ravel())


BODY = '[[robot.link]]\nname = "body"\nmass = 1.0\ncom = [0.02, -0.01, 0.85]\n'
FEET = feet([(x, y, -0.1) for x in (-0.35, 0.35) for y in (-0.1, 0.1)])
BOX = rigid(BODY + FEET, nodes=9, max_tilt=60.0)


@pytest.mark.parametrize(
    ("text", "posture", "gravity", "tip"),
    [
        (BOX, [], "0,0.4330127018922192,-1", -16.8),
        (
            start_recipe("arm"),
            ["-p", "swing=-120", "-p", "shoulder=15", "-p", "elbow=-20"],
            "0,-0.541265877365,-1",
            -2.88,
        ),
    ],
    ids=["box", "arm"],
)
def test_a_map_says_that_a_robot_tips_as_its_recipe_does(tmp_path, text, posture, gravity, tip):
    recipe, stability_map = tmp_path / "robot.toml", tmp_path / "robot.h5"
    recipe.write_text(text)
    lutgen.sweep(lutgen.load_recipe(recipe), stability_map)
    for source in (recipe, stability_map):
        found = data("eval", source, *posture, "-g", gravity, code=3)
        assert found["tip_angle_deg"] == pytest.approx(tip, abs=0.1)


EDGE = BOX.replace("com = [0.02, -0.01, 0.85]", "com = [0.0, 0.1, 0.3]")


def test_a_com_exactly_above_an_edge_stands_in_every_command(tmp_path):
    recipe, stability_map = tmp_path / "robot.toml", tmp_path / "robot.h5"
    recipe.write_text(EDGE)
    lutgen.sweep(lutgen.load_recipe(recipe), stability_map)
    for source in (recipe, stability_map):
        found = data("eval", source, "-g", "0,0,-1")
        assert found["tip_angle_deg"] == pytest.approx(0.0, abs=1e-6)
    assert "tips over on level ground" not in stdout("limits", recipe)

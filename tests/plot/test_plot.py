"""The figures show what they say: data, units, marks, hatching; and files repeat to the byte."""

import dataclasses
import math
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure

import lutgen
from lutgen import plot
from lutgen.analysis.posture import Posture
from lutgen.analysis.tilt import tilt_limits, tilted
from lutgen.analysis.tilt_table import posture_limits
from lutgen.errors import InputError
from lutgen.mapping import StabilityMap
from lutgen.quantities import RANKED
from lutgen.recipe.recipe import Recipe
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import without_limits

DOWN = (0.0, 0.0, -1.0)
# It has its com in the middle, and falls from no facet onto none.
TETRAHEDRON = """
[robot]
name = "tetrahedron"
length_unit = "m"
upright = 180.0
[[robot.link]]
name = "body"
[[robot.contact]]
name = "a"
link = "body"
position = [1.0, 1.0, 1.0]
[[robot.contact]]
name = "b"
link = "body"
position = [1.0, -1.0, -1.0]
[[robot.contact]]
name = "c"
link = "body"
position = [-1.0, 1.0, -1.0]
[[robot.contact]]
name = "d"
link = "body"
position = [-1.0, -1.0, 1.0]
[sweep]
[sweep.gravity]
chart = "sphere"
nodes = 9
channels = ["sdg", "tip_angle"]
"""
# Half of the hatched figures: the paper's robot with its nose up, where some postures tip over.
NOSE_UP = (-0.9, 0.0, -1.0)

# A fixed rectangle: edges 0.30 ahead, 0.25 behind, 0.20 left, 0.15 right of the com, 0.4 below.
AHEAD, BEHIND, LEFT, RIGHT, HEIGHT = 0.30, 0.25, 0.20, 0.15, 0.40
TABLE = f"""
[robot]
name = "table"
length_unit = "m"
[[robot.contact]]
name = "a"
link = "body"
position = [{AHEAD}, {LEFT}, -{HEIGHT}]
[[robot.contact]]
name = "b"
link = "body"
position = [-{BEHIND}, {LEFT}, -{HEIGHT}]
[[robot.contact]]
name = "c"
link = "body"
position = [-{BEHIND}, -{RIGHT}, -{HEIGHT}]
[[robot.contact]]
name = "d"
link = "body"
position = [{AHEAD}, -{RIGHT}, -{HEIGHT}]
[sweep]
[sweep.gravity]
chart = "sphere"
nodes = 41
channels = ["tip_angle"]
"""


@pytest.fixture(scope="module")
def two() -> Recipe:
    """Return the paper's robot with two parameters."""
    return lutgen.load_recipe(MAPS / "paper_two.toml")


@pytest.fixture(scope="module")
def table() -> Recipe:
    """Return the fixed rectangle."""
    return lutgen.parse_recipe(TABLE)


@pytest.fixture(scope="module")
def two_map(two: Recipe, tmp_path_factory: pytest.TempPathFactory) -> StabilityMap:
    """Return a small map of the paper's robot; 30 and -0.866 are among its nodes."""
    text = two.text.replace("alpha = 50, gamma = 50", "alpha = 11, gamma = 6")
    text = text.replace("nodes = 33", "nodes = 9")
    path = tmp_path_factory.mktemp("maps") / "two.h5"
    lutgen.sweep(lutgen.parse_recipe(text), path)
    return lutgen.load_map(path)


def words(figure: Figure) -> str:
    """Return all texts of a figure: titles, labels, legends and notes."""
    figure.draw_without_rendering()
    return "\n".join(text.get_text() for text in figure.findobj(mpl.text.Text))


def star(figure: Figure) -> tuple[float, float]:
    """Return where the one star of a figure is, data coordinates."""
    found = [
        line
        for axes in figure.axes
        for line in axes.get_lines()
        if line.get_marker() == "*" and line.get_label()
    ]
    assert len(found) == 1
    (x,), (y,) = found[0].get_data()
    return float(x), float(y)


def contour_sets(figure: Figure, *, filled: bool) -> list[QuadContourSet]:
    """Return the filled or unfilled contour sets of a figure."""
    return [s for s in figure.findobj(QuadContourSet) if s.filled is filled]


def hatched(figure: Figure) -> list[QuadContourSet]:
    """Return the hatched regions of a figure."""
    return [s for s in contour_sets(figure, filled=True) if any(s.hatches)]


@pytest.mark.parametrize(
    ("kind", "labels"),
    [
        ("curve", [r"$\alpha$ (deg)", "$|SD_g|$ (\N{EN DASH})", "$|OC|$ (\N{EN DASH})"]),
        ("contour", [r"$\alpha$ (deg)", r"$\gamma$ (deg)", "$|SD_g|$ (\N{EN DASH})"]),
        ("surface", [r"$\alpha$ (deg)", r"$\gamma$ (deg)", "$|SD_g|$ (\N{EN DASH})"]),
        ("sphere", ["$|SD_g|$ (\N{EN DASH})", "nose down", "left side down", "15\N{DEGREE SIGN}"]),
        ("polar", ["body tilt", "ground tilt", "right side down", "15\N{DEGREE SIGN}"]),
        ("robot", ["x forward (\N{EN DASH})", "y left (\N{EN DASH})", "z up (\N{EN DASH})"]),
    ],
)
def test_every_figure_names_its_robot_and_the_units_of_its_axes(
    two: Recipe, kind: str, labels: list[str]
) -> None:
    text = words(plot.draw(kind, two))
    assert "paper_two" in text
    for label in labels:
        assert label in text


def test_lengths_carry_the_unit_of_the_recipe(table: Recipe) -> None:
    assert "|SD_g|$ (m)" in words(plot.draw("sphere", table))
    assert "energy stability margin (m)" in words(
        plot.draw("sphere", table, channel="energy_margin")
    )
    assert "tip-over angle (deg)" in words(plot.draw("sphere", table, channel="tip_angle"))


def test_title_tells_the_posture_and_where_gravity_points(two: Recipe) -> None:
    text = words(plot.draw("curve", two, params={"gamma": 12.5}, gravity=(0.0, 1.0, -1.0)))
    assert "12.5\N{DEGREE SIGN}" in text
    assert "tilted 45.0\N{DEGREE SIGN}, left side down" in text
    assert "body level" in words(plot.draw("curve", two))


@pytest.mark.parametrize("channel", sorted(RANKED))
def test_lines_of_a_curve_are_the_exact_values(two: Recipe, channel: str) -> None:
    figure = plot.draw("curve", two, params={"gamma": 40.0}, channel=channel, gravity=(0.2, 0, -1))
    shown = {channel: figure.axes[0].get_lines()[0]}
    if channel != "height":
        shown["height"] = figure.axes[1].get_lines()[0]
    for name, line in shown.items():
        x, y = line.get_data()
        params = np.column_stack([np.radians(x), np.full(len(x), math.radians(40.0))])
        exact = lutgen.evaluate(two, params, [[0.2, 0.0, -1.0]], (name,))[name][:, 0]
        scale = math.degrees(1.0) if name == "tip_angle" else 1.0
        # Degrees went to radians and back: two roundings.
        np.testing.assert_allclose(y, exact * scale, rtol=1e-12, atol=1e-12)
        assert len(x) > 400


def test_star_of_a_curve_is_the_best_of_its_line(two: Recipe) -> None:
    figure = plot.draw("curve", two, params={"gamma": 20.0})
    x, y = figure.axes[0].get_lines()[0].get_data()
    assert star(figure) == (x[np.argmin(y)], y.min())
    figure = plot.draw("curve", two, params={"gamma": 20.0}, channel="tip_angle")
    x, y = figure.axes[0].get_lines()[0].get_data()
    assert star(figure) == (x[np.argmax(y)], y.max())


def test_curve_finds_the_zero_of_the_papers_robot_between_its_samples(two: Recipe) -> None:
    nominal = math.degrees(math.atan(0.6))
    x, y = star(plot.draw("curve", two, params={"gamma": nominal}))
    # The samples beside the optimum are 50 / 400 / 200 deg apart, and |SD_g| rises by 0.07 per deg.
    assert x == pytest.approx(nominal, abs=7e-4)
    assert y < 5e-5


def test_dots_of_a_curve_are_the_nodes_of_the_map(two_map: StabilityMap) -> None:
    figure = plot.draw("curve", two_map, params={"gamma": 20.0})
    dots = next(line for line in figure.axes[0].get_lines() if line.get_label() == "map nodes")
    x, y = dots.get_data()
    np.testing.assert_allclose(x, np.degrees(two_map.axes[0].knots))
    # gamma = 20 deg is knot 2 of 6, straight down is node 4 of 9 both ways.
    np.testing.assert_array_equal(y, two_map.channel("sdg")[:, 2, 0, 4, 4])
    between = plot.draw("curve", two_map, params={"gamma": 21.0})
    assert "map, interpolated" in words(between)
    aside = plot.draw("curve", two_map, gravity=(0.0, 1.0, 0.0))
    assert "map" not in [line.get_label() for line in aside.axes[0].get_lines()]


def test_curve_breaks_its_line_where_another_facet_takes_over() -> None:
    absolem = lutgen.load_recipe(MAPS / "absolem.toml")
    figure = plot.draw("curve", absolem, params={"rear": 0.0})
    x, y = figure.axes[0].get_lines()[0].get_data()
    # At -10 deg the front flippers leave the ground and |SD_g| falls from 0.21 to 0.03 m.
    near = (x > -14.0) & (x < -6.0)
    assert np.isnan(y[near]).sum() == 1
    assert np.nanmax(np.abs(np.diff(y[near]))) < 0.02


@pytest.mark.parametrize("kind", ["curve", "contour", "surface"])
def test_figure_says_tips_over_only_where_something_tips(two: Recipe, kind: str) -> None:
    assert "tips over" not in words(plot.draw(kind, two))
    assert "tips over" in words(plot.draw(kind, two, gravity=(-1.2, 0.0, -1.0)))


@pytest.mark.parametrize("kind", ["curve", "contour", "surface"])
@pytest.mark.parametrize("channel", ["sdg", "energy_margin"])
def test_figure_without_a_standing_posture_has_no_optimum(
    two: Recipe, kind: str, channel: str
) -> None:
    # No posture of this robot stands with its nose straight up.
    figure = plot.draw(kind, two, gravity=(-1.0, 0.0, 0.0), channel=channel)
    assert "tips over" in words(figure)
    assert not [line for line in figure.axes[0].get_lines() if line.get_marker() == "*"]


def test_contour_lines_run_where_the_exact_value_is_their_level(two: Recipe) -> None:
    figure = plot.draw("contour", two)
    (lines,) = [s for s in contour_sets(figure, filled=False) if len(s.levels) > 1]
    checked = 0
    for level, pieces in zip(lines.levels, lines.allsegs, strict=True):
        for piece in pieces:
            exact = lutgen.evaluate(two, np.radians(piece), [DOWN], ("sdg",))["sdg"][:, 0]
            # Linear interpolation on cells of 0.5 deg where |SD_g| curves by 0.01 per deg^2.
            np.testing.assert_allclose(exact, level, atol=2e-3)
            checked += len(piece)
    assert checked > 500


def test_contour_of_a_map_is_drawn_from_its_nodes(two_map: StabilityMap) -> None:
    figure = plot.draw("contour", two_map)
    nodes = two_map.channel("sdg")[:, :, 0, 4, 4]
    fill = next(s for s in contour_sets(figure, filled=True) if not any(s.hatches))
    assert fill.zmin == pytest.approx(float(nodes.min()), rel=1e-6)  # float32
    assert fill.zmax == pytest.approx(float(nodes.max()), rel=1e-6)
    row, column = np.unravel_index(nodes.argmin(), nodes.shape)
    knots = [np.degrees(axis.knots) for axis in two_map.axes]
    assert star(figure) == (knots[0][row], knots[1][column])


@pytest.mark.parametrize("kind", ["contour", "surface"])
def test_star_of_a_plane_is_the_best_of_all_its_samples(two: Recipe, kind: str) -> None:
    figure = plot.draw(kind, two, axes=("gamma", "alpha"), gravity=NOSE_UP)
    side = np.linspace(0.0, math.radians(50.0), 101)
    gamma, alpha = np.meshgrid(side, side)
    params = np.column_stack([alpha.ravel(), gamma.ravel()])
    exact = lutgen.evaluate(two, params, [NOSE_UP], ("sdg",))["sdg"][:, 0]
    best = int(np.nanargmin(exact))
    (label,) = re.findall(r"min ([0-9.]+) at .*? = ([0-9.]+).*? = ([0-9.]+)", words(figure))[:1]
    place = math.degrees(gamma.ravel()[best]), math.degrees(alpha.ravel()[best])
    # Printed to three decimals or more of a range of some units, and two of 50 deg.
    assert [float(part) for part in label] == pytest.approx([exact[best], *place], abs=5e-3)
    if kind == "contour":
        assert star(figure) == pytest.approx(place, abs=1e-9)


def test_surface_goes_through_the_exact_values(two: Recipe) -> None:
    figure = plot.draw("surface", two)
    axes = figure.axes[0]
    surface = next(c for c in axes.collections if type(c).__name__ == "Poly3DCollection")
    corners = surface._faces.reshape(-1, 3)
    some = corners[:: len(corners) // 500]
    exact = lutgen.evaluate(two, np.radians(some[:, :2]), [DOWN], ("sdg",))["sdg"][:, 0]
    np.testing.assert_allclose(some[:, 2], exact, atol=1e-12)  # degrees and back: rounding


def test_hatching_covers_the_tip_over_region_and_nothing_else(two: Recipe) -> None:
    figure = plot.draw("contour", two, gravity=NOSE_UP)
    (region,) = hatched(figure)
    points = np.random.default_rng(3).uniform(0.5, 49.5, (2000, 2))
    tip_angle = lutgen.evaluate(two, np.radians(points), [NOSE_UP], ("tip_angle",))["tip_angle"]
    tips = tip_angle[:, 0] < 0.0
    # The boundary is interpolated on 0.5 deg: leave out what is closer to it than 0.05 deg.
    clear = np.abs(tip_angle[:, 0]) > math.radians(0.05)
    covered = region.get_paths()[0].contains_points(points)
    assert 300 < tips.sum() < 1700
    np.testing.assert_array_equal(covered[clear], tips[clear])


def test_boundary_on_a_disc_is_where_the_tip_angle_is_zero(two: Recipe) -> None:
    figure = plot.draw("sphere", two, params={"alpha": 20.0, "gamma": 35.0})
    (line,) = [s for s in contour_sets(figure, filled=False) if s.levels.tolist() == [0.0]]
    xy = np.concatenate(line.allsegs[0])
    # Back from Lambert's projection of the 60 deg cone; the nose is at the top, left at the left.
    tilt = 2.0 * np.arcsin(np.linalg.norm(xy, axis=1) * math.sin(math.radians(30.0)))
    down = tilted(tilt, np.arctan2(-xy[:, 0], xy[:, 1]))
    posture = [[math.radians(20.0), math.radians(35.0)]]
    angle = lutgen.evaluate(two, posture, down, ("tip_angle",))["tip_angle"][0]
    assert len(xy) > 200
    # Interpolated on a mesh of a third of a degree by a degree.
    assert np.abs(angle).max() < math.radians(0.02)


def test_discs_of_the_whole_sphere_are_of_equal_area(table: Recipe) -> None:
    # A table stands in no attitude of the upper half, whose disc would be hatched all over.
    figure = plot.draw("sphere", table)
    assert len(figure.axes) == 2  # one disc and the colour bar
    # A robot on three points all around stands on its back, too.
    both = plot.draw("sphere", without_limits(TETRAHEDRON))
    assert len(both.axes) == 3
    for panel in (figure.axes[0], *both.axes[:2]):
        circles = [np.hypot(*line.get_data()) for line in panel.get_lines()]
        radii = sorted(c.mean() for c in circles if len(c) == 181)
        # The cap within tilt t holds 1 - cos t of a hemisphere's 2 pi sr: its circle's area.
        shares = [1.0 - math.cos(math.radians(tilt)) for tilt in (15, 30, 45, 60, 75, 90)]
        np.testing.assert_allclose(np.square(radii), shares, rtol=1e-12)


def test_caption_gives_the_share_of_directions_that_tip_as_a_true_area(table: Recipe) -> None:
    # Closed form: the pyramid over the rectangle, one quadrant after the other.
    standing = sum(
        math.atan2(x * y, HEIGHT * math.sqrt(x * x + y * y + HEIGHT * HEIGHT))
        for x in (AHEAD, BEHIND)
        for y in (LEFT, RIGHT)
    )
    share = 100.0 * (1.0 - standing / (4.0 * math.pi))
    (found,) = re.findall(
        r"tips over \(([0-9.]+) % of all directions\)", words(plot.draw("sphere", table))
    )[:1]
    # The verdict is taken at 9600 nodes; the boundary crosses about 100 of their cells.
    assert float(found) == pytest.approx(share, abs=0.3)


def test_polar_chart_of_a_rectangle_has_the_closed_form_limits(table: Recipe) -> None:
    expected = [math.atan(reach / HEIGHT) for reach in (AHEAD, LEFT, BEHIND, RIGHT)]
    limits = tilt_limits(table, [], np.radians([0.0, 90.0, 180.0, 270.0]))
    np.testing.assert_allclose(limits, expected, atol=1e-9)  # bisected far below that
    text = words(plot.draw("polar", table))
    names = ("nose down", "left side down", "nose up", "right side down")
    for name, limit in zip(names, expected, strict=True):
        # Body and ground alike, and rounded down, so that what is printed holds.
        down = math.floor(10.0 * math.degrees(limit)) / 10.0
        assert f"{name}: {down:.1f}\N{DEGREE SIGN}" in text


def test_polar_chart_names_body_tilt_and_ground_tilt_with_a_worst_heading_of_each() -> None:
    robot = lutgen.load_recipe(MAPS / "articulated.toml")
    params = {"steer": 45.0, "roll": 15.0}
    figure = plot.draw("polar", robot, params=params)
    lines = {str(line.get_label()).split(":")[0]: line for line in figure.axes[0].get_lines()}
    posture = posture_limits(Posture(robot, np.radians([45.0, 15.0])), "body")
    worst = [line for line in figure.axes[0].get_lines() if line.get_marker() == "o"]
    bounds = (posture.guaranteed, posture.guaranteed_ground)
    for name, bound, dot in zip(("body tilt", "ground tilt"), bounds, worst, strict=True):
        heading, limit = lines[name].get_data()
        (at,), (tilt,) = dot.get_data()
        # The worst heading is searched for, and what is drawn has one every half degree, in which a
        # limit changes by 0.05 deg where the gap in an edge ends.
        assert tilt <= limit.min() + 1e-9
        assert tilt == pytest.approx(limit.min(), abs=0.05)
        near = np.abs(np.remainder(heading - at + math.pi, 2.0 * math.pi) - math.pi) < 0.02
        assert limit[near].min() == pytest.approx(tilt, abs=0.05)
        circle = np.asarray(lines[f"{name}, guaranteed"].get_ydata())
        assert circle.min() == circle.max() == pytest.approx(math.degrees(bound))
        said = str(lines[f"{name}, guaranteed"].get_label())
        (printed,) = re.findall(r"([0-9.]+)\N{DEGREE SIGN}", said)
        assert 0.0 <= math.degrees(bound) - float(printed) < 0.1
        assert said.endswith(
            "sliding included" if name == "ground tilt" else "sliding not included"
        )
    text = words(figure)
    assert "left side down: body 23.6\N{DEGREE SIGN}, ground 22.9\N{DEGREE SIGN}" in text
    free = dataclasses.replace(robot, friction=None)
    assert words(plot.draw("polar", free, params=params)).count("sliding not included") == 2


def test_tilt_limit_is_the_first_crossing_of_the_boundary() -> None:
    absolem = lutgen.load_recipe(MAPS / "absolem.toml")
    posture = np.radians([40.0, 40.0])
    headings = np.radians(np.arange(0.0, 360.0, 7.0))
    limits = tilt_limits(absolem, posture, headings)
    tilts = np.radians(np.arange(0.0, 90.0, 0.1))
    down = tilted(tilts[:, None], headings[None, :])
    angle = lutgen.evaluate(absolem, posture[None], down.reshape(-1, 3), ("tip_angle",))
    tips = (angle["tip_angle"][0] < 0.0).reshape(len(tilts), len(headings))
    first = np.where(tips.any(axis=0), tilts[tips.argmax(axis=0)], math.pi)
    assert np.all(limits <= first)
    assert np.all(first - limits <= math.radians(0.1) + 1e-12)


def test_tilt_limit_is_zero_for_what_cannot_stand_and_pi_for_what_cannot_fall(
    table: Recipe,
) -> None:
    above = TABLE.replace(f", -{HEIGHT}]", f", {HEIGHT}]")
    limits = tilt_limits(lutgen.parse_recipe(above), [], [0.0, 1.0])
    assert limits.tolist() == [0.0, 0.0]
    corners = [f"position = [{x}, {y}, {z}]" for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    contacts = "".join(
        f'[[robot.contact]]\nname = "k{i}"\nlink = "body"\n{corner}\n'
        for i, corner in enumerate(corners)
    )
    head, _, _ = TABLE.partition("[[robot.contact]]")
    tail = TABLE[TABLE.index("[sweep]") :]
    assert tilt_limits(without_limits(f"{head}{contacts}{tail}"), [], [0.3]).tolist() == [math.pi]


def test_robot_is_drawn_to_one_scale_with_its_factor_written() -> None:
    absolem = lutgen.load_recipe(MAPS / "absolem.toml")
    gravity = (0.2, 0.1, -1.0)
    params = {"front": 30.0, "rear": 20.0}
    figure = plot.draw("robot", absolem, params=params, gravity=gravity)
    axes = figure.axes[0]
    sides = [np.ptp(limits) for limits in (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())]
    box = axes._box_aspect
    np.testing.assert_allclose(box / box[0], np.array(sides) / sides[0], rtol=1e-9)
    posture = [[math.radians(30.0), math.radians(20.0)]]
    exact = lutgen.evaluate(absolem, posture, [gravity], ("sdg", "tip_angle"))
    text = words(figure)
    assert f"$|SD_g|$ = {exact['sdg'][0, 0]:.3g} m" in text
    angle = math.degrees(exact["tip_angle"][0, 0])
    assert f"stands, {angle:.1f}\N{DEGREE SIGN} from tip-over" in text
    assert "least stable" in text


def test_every_part_of_the_robot_figure_is_on_the_paper(two: Recipe) -> None:
    figure = plot.draw("robot", two, gravity=(-0.3, 0.2, -1.0))
    figure.draw_without_rendering()
    paper = figure.bbox
    (axes,), (legend,) = figure.axes, figure.legends
    labels = [axis.label for axis in (axes.xaxis, axes.yaxis, axes.zaxis)]
    found = [*figure.texts, *legend.get_texts(), *axes.texts, *labels]
    assert {"P1", "P2", "P3"} <= {text.get_text() for text in found}
    for text in found:
        (left, bottom), (right, top) = mpl.text.Text.get_window_extent(text).get_points()
        assert left >= 0.0, text.get_text()
        assert bottom >= 0.0, text.get_text()
        assert right <= paper.x1, text.get_text()
        assert top <= paper.y1, text.get_text()


def test_robot_that_tips_and_robot_without_support_are_drawn_too(two: Recipe) -> None:
    assert "tips over" in words(plot.draw("robot", two, gravity=(-1.0, 0.0, -0.5)))
    above = lutgen.parse_recipe(TABLE.replace(f", -{HEIGHT}]", f", {HEIGHT}]"))
    assert "nothing to stand on" in words(plot.draw("robot", above))


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_same_figure_is_the_same_bytes(two: Recipe, tmp_path: Path, suffix: str) -> None:
    paths = [tmp_path / f"{name}{suffix}" for name in ("one", "two", "three")]
    figure = plot.draw("contour", two, gravity=NOSE_UP)
    plot.save(figure, paths[0])
    plot.save(figure, paths[1])
    plot.save(plot.draw("contour", two, gravity=NOSE_UP), paths[2])
    first, second, third = (path.read_bytes() for path in paths)
    assert first == second == third
    assert sorted(tmp_path.iterdir()) == sorted(paths)
    assert not re.search(rb"20[0-9]{2}-[01][0-9]|CreationDate|dc:date", first)


@pytest.fixture
def odd_settings() -> Iterator[dict[str, object]]:
    """Set some of matplotlib's settings as a user might, and return all of them."""
    with mpl.rc_context({"font.size": 31.0, "axes.grid": True, "lines.linewidth": 9.0}):
        yield dict(mpl.rcParams)


def test_users_matplotlib_settings_are_neither_read_nor_changed(
    two: Recipe, tmp_path: Path, odd_settings: dict[str, object]
) -> None:
    plot.save(plot.draw("polar", two), tmp_path / "odd.svg")
    assert dict(mpl.rcParams) == odd_settings
    with mpl.rc_context():
        mpl.rcdefaults()
        plot.save(plot.draw("polar", two), tmp_path / "even.svg")
    assert (tmp_path / "odd.svg").read_bytes() == (tmp_path / "even.svg").read_bytes()


def test_pyplot_is_not_imported() -> None:
    code = "import sys, lutgen.plot; sys.exit('matplotlib.pyplot' in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize(
    ("kind", "options", "fragment"),
    [
        ("pie", {}, "did you mean 'polar'|choose from curve"),
        ("curve", {"params": {"alph": 3.0}}, "did you mean 'alpha'"),
        ("curve", {"params": {"alpha": 60.0}}, "choose from 0 to 50 deg"),
        ("curve", {"params": {"alpha": math.nan}}, "choose from 0 to 50 deg"),
        ("curve", {"params": {"alpha": 1.0, "gamma": 1.0}}, "got 0 that are free"),
        ("curve", {"axes": ("alpha", "gamma")}, "a curve needs 1"),
        ("curve", {"axes": ("beta",)}, "unknown parameter"),
        ("contour", {"axes": ("alpha", "alpha")}, "2 different axes"),
        ("contour", {"axes": ("alpha", "gamma"), "params": {"alpha": 1.0}}, "both fixed and"),
        ("polar", {"axes": ("alpha",)}, "a polar needs 0"),
        ("sphere", {"channel": "facet"}, "cannot be drawn"),
        ("sphere", {"channel": "tip_angel"}, "did you mean 'tip_angle'"),
        ("sphere", {"channels": "sdg"}, "unknown keyword .*did you mean 'channel'"),
        ("robot", {"gravity": (0.0, 0.0, 0.0)}, "longer than 0"),
        ("robot", {"gravity": [DOWN, DOWN]}, "give x, y, z"),
    ],
)
def test_wrong_option_is_refused_in_one_sentence(
    two: Recipe, kind: str, options: dict[str, object], fragment: str
) -> None:
    with pytest.raises(InputError, match=fragment) as caught:
        plot.draw(kind, two, **options)  # type: ignore[arg-type]
    assert_one_sentence(str(caught.value))


def test_options_that_the_map_cannot_answer_are_refused(two_map: StabilityMap) -> None:
    for options in ({"channel": "margin"}, {"gravity": (1.0, 0.0, -0.2)}):
        with pytest.raises(InputError, match="recipe") as caught:
            plot.draw("contour", two_map, **options)  # type: ignore[arg-type]
        assert_one_sentence(str(caught.value))


def test_map_of_a_robot_given_by_code_is_drawn_without_running_it(tmp_path: Path) -> None:
    (tmp_path / "stilts.py").write_text(
        "import numpy as np\n"
        "def stilts(q):\n"
        "    feet = np.array([[1, 1, -1], [-1, 1, -1], [-1, -1, -1], [1, -1, -1]], float)\n"
        "    contacts = np.tile(feet, (len(q), 1, 1))\n"
        "    contacts[..., 2] -= q[:, :1]\n"
        "    return contacts, np.zeros((len(q), 3))\n",
        encoding="utf-8",
    )
    text = (
        '[robot]\nname = "stilts"\nlength_unit = "m"\npython = "stilts:stilts"\n'
        '[[robot.parameter]]\nname = "rise"\nmin = 0.0\nmax = 1.0\nunit = "m"\n'
        '[sweep]\nsamples = { rise = 3 }\n[sweep.gravity]\nchart = "cone"\nmax_tilt = 60.0\n'
        'nodes = 5\nchannels = ["sdg", "height", "tip_angle"]\n'
    )
    recipe = lutgen.parse_recipe(text, str(tmp_path / "stilts.toml"), allow_python=True)
    lutgen.sweep(recipe, tmp_path / "stilts.h5")
    sealed = lutgen.load_map(tmp_path / "stilts.h5")
    x, y = plot.draw("curve", sealed, channel="height").axes[0].get_lines()[0].get_data()
    np.testing.assert_allclose(y, 1.0 + x, rtol=1e-6)  # float32 nodes, linear in between
    assert "tips over" in words(plot.draw("sphere", sealed))
    with pytest.raises(InputError, match="with its code allowed") as caught:
        plot.draw("polar", sealed)
    assert_one_sentence(str(caught.value))


def test_cone_of_one_direction_has_no_sphere(two: Recipe) -> None:
    single = lutgen.parse_recipe(two.text.replace("nodes = 33", "nodes = 1"))
    with pytest.raises(InputError, match="single gravity direction"):
        plot.draw("sphere", single)
    assert plot.draw("contour", single)


def test_file_that_cannot_be_written_is_refused(two: Recipe, tmp_path: Path) -> None:
    figure = plot.draw("polar", two)
    for path, fragment in (
        (tmp_path / "a.jpg", "end the name in"),
        (tmp_path / "a", "end the name in"),
        (tmp_path / "missing" / "a.png", "cannot be written"),
    ):
        with pytest.raises(InputError, match=fragment) as caught:
            plot.save(figure, path)
        assert_one_sentence(str(caught.value))
    assert list(tmp_path.iterdir()) == []


def assert_one_sentence(message: str) -> None:
    """Check that a message is one line that ends in its only full stop."""
    assert "\n" not in message
    assert message.endswith(".")
    assert not re.search(r"\. [A-Z]", message)


def colours_span(figure: Figure) -> tuple[float, float]:
    (filled,) = (
        c for c in figure.axes[0].collections if isinstance(c, QuadContourSet) and c.filled
    )
    steps = list(filled.levels)
    return steps[0], steps[-1]


def test_figures_of_one_scale_span_the_same_colours_and_lose_nothing(two: Recipe) -> None:
    slopes = {"level": DOWN, "slope": (-0.2, 0.0, -1.0)}
    alone = {n: colours_span(plot.draw("contour", two, gravity=g)) for n, g in slopes.items()}
    assert alone["level"] != alone["slope"]
    scale = (0.0, max(alone["slope"]))
    spans = {
        colours_span(plot.draw("contour", two, gravity=g, scale=scale)) for g in slopes.values()
    }
    assert len(spans) == 1
    # A scale too narrow hides nothing.
    assert colours_span(plot.draw("contour", two, scale=(0.5, 0.6))) == alone["level"]
    for wrong in ((1.0, 1.0), (2.0, 1.0), (math.nan, 1.0)):
        with pytest.raises(InputError, match="from a number to a larger one"):
            plot.draw("contour", two, scale=wrong)

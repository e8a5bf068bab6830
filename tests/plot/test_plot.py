"""Figures show what they say: titles, data, marks, hatching; files repeat to the byte."""

import math
import re
import subprocess
import sys

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.contour import QuadContourSet
from PIL import Image

import lutgen
from lutgen import plot
from lutgen.analysis import Posture, posture_limits, tilt_limits, tilted
from lutgen.channels import evaluate_each
from lutgen.errors import InputError
from lutgen.quantities import RANKED
from tests.fixtures.linkage import coded
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import feet, rigid

DOWN = (0.0, 0.0, -1.0)
DEG = "\N{DEGREE SIGN}"
# The paper's robot with its nose up, where half of the postures tip over.
NOSE_UP = (-0.9, 0.0, -1.0)
NOMINAL = math.degrees(math.atan(0.6))
# A fixed rectangle: edges 0.30 ahead, 0.25 behind, 0.20 left, 0.15 right of the com, 0.4 below.
AHEAD, BEHIND, LEFT, RIGHT, HEIGHT = 0.30, 0.25, 0.20, 0.15, 0.40
CORNERS = [(AHEAD, LEFT), (-BEHIND, LEFT), (-BEHIND, -RIGHT), (AHEAD, -RIGHT)]


@pytest.fixture(scope="module")
def table():
    return lutgen.parse_recipe(rigid(feet([(x, y, -HEIGHT) for x, y in CORNERS])))


@pytest.fixture(scope="module")
def absolem():
    return lutgen.load_recipe(MAPS / "absolem.toml")


@pytest.fixture(scope="module")
def contour(two):
    """Return the contours of |SD_g| where half of the postures tip over."""
    return plot.draw("contour", two, gravity=NOSE_UP, channel="sdg")


def words(figure):
    return "\n".join(text.get_text() for text in figure.findobj(mpl.text.Text))


def title(figure):
    return figure.texts[0].get_text().replace("\n", " ")


def line(figure, label):
    (found,) = (x for axes in figure.axes for x in axes.get_lines() if x.get_label() == label)
    return found.get_data()


def test_every_figure_names_its_robot_and_the_units_of_its_axes(two, table):
    for kind, expected in {
        "curve": ["\N{GREEK SMALL LETTER ALPHA}", "tip-over angle (deg)", f"40{DEG}"],
        "sphere": ["nose down", "left\nside down", f"30{DEG}", "tilt of the body"],
        "polar": ["nose up", "stands", "tips over", f"60{DEG}"],
        "robot": ["centre of mass", "gravity", "three feet", "tips over this\nedge first"],
    }.items():
        text = words(plot.draw(kind, two))
        assert "Robot of the paper with two moving wheels" in text
        assert all(label in text for label in expected), (kind, text)
    assert "|SD_g|$ (m)" in words(plot.draw("sphere", table, channel="sdg"))
    given = plot.draw("curve", two, params={"gamma": 12.5}, gravity=(0.0, 1.0, -1.0))
    assert f"12.5{DEG}, left side down by 45{DEG}" in words(given)


def test_a_curve_is_exact_for_every_channel_and_its_star_the_best(two):
    for channel in RANKED:
        figure = plot.draw(
            "curve", two, params={"gamma": 40.0}, channel=channel, gravity=(0.2, 0, -1)
        )
        x, y = figure.axes[0].get_lines()[0].get_data()
        params = np.column_stack([np.radians(x), np.full(len(x), math.radians(40.0))])
        exact = lutgen.evaluate(two, params, [[0.2, 0.0, -1.0]], (channel,))[channel][:, 0]
        exact = np.degrees(exact) if channel == "tip_angle" else exact
        # Degrees went to radians and back: two roundings.
        np.testing.assert_allclose(y, exact, rtol=1e-12, atol=1e-6 * np.ptp(exact))
        best = exact.min() if channel in ("sdg", "height") else exact.max()
        assert line(figure, "best")[1][0] == pytest.approx(best)
        assert len(x) > 400
    (x,), (y,) = line(plot.draw("curve", two, channel="sdg", params={"gamma": NOMINAL}), "best")
    # The zero lies between the samples, which are 50 / 400 / 200 deg apart beside it.
    assert (x, y) == (pytest.approx(NOMINAL, abs=7e-4), pytest.approx(0.0, abs=5e-5))


def test_a_curve_breaks_at_a_jump_and_nowhere_else(absolem, two):
    figure = plot.draw("curve", absolem, params={"rear": 0.0}, channel="sdg")
    x, _ = figure.axes[0].get_lines()[0].get_data()
    (gaps,) = np.nonzero(np.isnan(x))
    # At -10 deg the front flippers leave the ground and |SD_g| falls from 0.21 to 0.03 m.
    assert sum(-14.0 < x[gap - 1] < -6.0 for gap in gaps) == 1
    assert all(x[gap + 1] - x[gap - 1] < 0.001 for gap in gaps)
    assert np.isfinite(plot.draw("curve", two).axes[0].get_lines()[0].get_ydata()).all()


def test_lines_of_a_contour_run_where_the_exact_value_is_their_level(contour, two):
    (lines,) = (
        s
        for s in contour.axes[0].collections
        if isinstance(s, QuadContourSet) and len(s.levels) > 1 and not s.filled
    )
    checked = 0
    for level, pieces in zip(lines.levels, lines.allsegs, strict=True):
        for piece in pieces:
            exact = lutgen.evaluate(two, np.radians(piece), [NOSE_UP], ("sdg",))["sdg"][:, 0]
            near = exact[np.isfinite(exact)]
            # Linear on cells of 0.3 deg where |SD_g| curves by 0.01 per deg^2.
            np.testing.assert_allclose(near, level, atol=3e-3)
            checked += len(near)
    assert checked > 500


def test_hatching_covers_what_tips_over_and_the_star_is_the_best_of_the_rest(contour, two):
    (region,) = (
        s
        for s in contour.axes[0].collections
        if isinstance(s, QuadContourSet) and any(s.hatches or ())
    )
    points = np.random.default_rng(3).uniform(0.5, 49.5, (2000, 2))
    found = lutgen.evaluate(two, np.radians(points), [NOSE_UP], ("tip_angle", "sdg"))
    tips, sdg = found["tip_angle"][:, 0] < 0.0, found["sdg"][:, 0]
    # The boundary is known to a fifth of a cell of 0.3 deg.
    clear = np.abs(found["tip_angle"][:, 0]) > math.radians(0.1)
    covered = region.get_paths()[0].contains_points(points)
    assert 300 < tips.sum() < 1700
    np.testing.assert_array_equal(covered[clear], tips[clear])
    (x,), (y,) = line(contour, "best")
    best = lutgen.evaluate(two, np.radians([[x, y]]), [NOSE_UP], ("sdg",))["sdg"][0, 0]
    assert best <= np.nanmin(sdg) + 1e-3
    assert f"{x:.0f}{DEG}" in title(contour)


def test_a_map_of_code_that_is_not_run_has_contours_where_nothing_jumps(tmp_path):
    lutgen.sweep(coded("legs"), tmp_path / "legs.h5")
    figure = plot.draw("contour", lutgen.load_map(tmp_path / "legs.h5"))
    assert title(figure).startswith("Best with a level body: ")


def test_an_even_region_is_named_with_its_angle_and_a_ramp_is_not(absolem):
    tractor = lutgen.load_recipe(MAPS / "tractor.toml")
    assert "everywhere" not in words(plot.draw("contour", tractor, gravity=(0.0, 0.25, -1.0)))
    figure = plot.draw("contour", absolem, convention="plane")
    (said,) = (one for one in figure.axes[0].texts if "everywhere" in one.get_text())
    # Words are about 80 deg wide there.
    around = np.add(said.get_position(), [(x, y) for x in (-40, 0, 40) for y in (-10, 0, 10)])
    down = np.tile(DOWN, (len(around), 1))
    found = evaluate_each(absolem, np.radians(around), down, ("tip_angle",), "plane")
    angles = np.degrees(found["tip_angle"])
    assert said.get_text() == f"{math.floor(angles.min())}{DEG} everywhere here"
    assert np.ptp(angles) < 1.2


@pytest.mark.parametrize("kind", ["curve", "contour", "surface"])
def test_a_figure_without_a_standing_posture_has_no_optimum(two, kind):
    # No posture of this robot stands with its nose straight up.
    if kind == "surface":
        assert title(plot.draw(kind, two, channel="sdg")).count(f"31{DEG}") == 2
    for channel in ("sdg", "tip_angle"):
        figure = plot.draw(kind, two, gravity=(-1.0, 0.0, 0.0), channel=channel)
        assert title(figure) == f"Tips over in every posture, nose up by 90{DEG}"
        assert "best" not in [one.get_label() for one in figure.axes[0].get_lines()]


def test_a_disc_is_of_equal_areas_and_its_boundary_where_the_tip_angle_is_zero(two):
    figure = plot.draw("sphere", two, params={"alpha": 20.0, "gamma": 35.0})
    (edge,) = (
        s
        for s in figure.axes[0].collections
        if isinstance(s, QuadContourSet) and not s.filled and s.levels.tolist() == [0.5]
    )
    xy = np.concatenate(edge.allsegs[0])
    # Back from Lambert's projection of a hemisphere; the nose is at the top, left at the left.
    tilt = 2.0 * np.arcsin(np.linalg.norm(xy, axis=1) * math.sin(math.radians(45.0)))
    down = tilted(tilt, np.arctan2(-xy[:, 0], xy[:, 1]))
    posture = [[math.radians(20.0), math.radians(35.0)]]
    angle = lutgen.evaluate(two, posture, down, ("tip_angle",))["tip_angle"][0]
    assert len(xy) > 200
    # Half of a pixel of 0.2 deg.
    assert np.abs(angle).max() < math.radians(0.2)
    level = lutgen.evaluate(two, posture, [DOWN], ("tip_angle",))["tip_angle"][0, 0]
    assert f"Level, it is {math.floor(math.degrees(level))}{DEG} from tipping over" in title(figure)


def test_tilt_charts_of_a_rectangle_have_the_closed_form_limits_rounded_down(table):
    expected = [math.atan(reach / HEIGHT) for reach in (AHEAD, LEFT, BEHIND, RIGHT)]
    limits = tilt_limits(table, [], np.radians([0.0, 90.0, 180.0, 270.0]))
    np.testing.assert_allclose(limits, expected, atol=1e-9)  # bisected far below that
    for figure in (
        plot.draw("polar", table),
        plot.draw_limits(table, posture_limits(Posture(table, []))),
    ):
        numbers = [math.floor(math.degrees(limit)) for limit in expected]
        assert all(f"\n{number}{DEG}" in words(figure) for number in numbers)
        assert (
            title(figure)
            == f"Leans at least {min(numbers)}{DEG} in any direction before it tips over"
        )
        x, y = line(figure, "tips over")
        heading, radius = np.arctan2(-x, y), np.hypot(x, y)
        exact = np.degrees(tilt_limits(table, [], heading)) / 90.0
        # Gaps of less than 2 deg of heading are closed, which rounds dents off.
        np.testing.assert_allclose(radius, exact, atol=1e-4)


def test_a_robot_says_whether_it_stands_and_how_far_it_is_from_tipping_over(absolem, two):
    gravity, params = (0.2, 0.1, -1.0), {"front": 30.0, "rear": 20.0}
    figure = plot.draw("robot", absolem, params=params, gravity=gravity)
    posture = np.radians([[30.0, 20.0]])
    tip = lutgen.evaluate(absolem, posture, [gravity], ("tip_angle",))["tip_angle"][0, 0]
    number = math.floor(math.degrees(tip))
    assert title(figure) == f"Stands on four wheels, {number}{DEG} from tipping over"
    assert f"after {number}{DEG}" in words(figure)
    assert "too far" in title(plot.draw("robot", two, gravity=(-1.0, 0.0, -0.5)))
    above = lutgen.parse_recipe(rigid(feet([(x, y, HEIGHT) for x, y in CORNERS])))
    assert title(plot.draw("robot", above)) == "It has nothing to stand on"


def test_same_figure_is_the_same_bytes_whatever_matplotlib_is_set_to(two, tmp_path):
    for name, size in (("odd", 31.0), ("even", 10.0)):
        with mpl.rc_context({"font.size": size, "axes.grid": size > 30.0}):
            before, figure = dict(mpl.rcParams), plot.draw("polar", two)
            for suffix in ("png", "svg", "pdf"):
                plot.save(figure, tmp_path / f"{name}.{suffix}", dpi=40)
            assert dict(mpl.rcParams) == before
    for suffix in ("png", "svg", "pdf"):
        content = (tmp_path / f"odd.{suffix}").read_bytes()
        assert content == (tmp_path / f"even.{suffix}").read_bytes()
        assert not re.search(rb"20[0-9]{2}-[01][0-9]|CreationDate|dc:date", content)
    code = "import sys, lutgen.plot; sys.exit('matplotlib.pyplot' in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_large_picture_keeps_256_colours_and_white_stays_white(contour, tmp_path, monkeypatch):
    monkeypatch.setattr("lutgen.plot.style.LARGEST", 1000)
    plot.save(contour, tmp_path / "few.png", dpi=40)
    with Image.open(tmp_path / "few.png") as few:
        assert few.mode == "P"
        assert few.convert("RGB").getpixel((0, 0)) == (255, 255, 255)


def refused(source, kind, fragment, **options):
    """Demand that a figure is refused in one line that ends in its only full stop."""
    with pytest.raises(InputError, match=fragment) as caught:
        plot.draw(kind, source, **options)
    message = str(caught.value)
    assert message.endswith(".")
    assert not re.search(r"\n|\. [A-Z]", message)


@pytest.mark.parametrize(
    ("kind", "options", "fragment"),
    [
        ("pie", {}, "choose from: curve"),
        ("curve", {"params": {"alph": 3.0}}, "did you mean 'alpha'"),
        ("curve", {"params": {"alpha": 60.0}}, "must lie in 0 to 50 deg"),
        ("curve", {"params": {"alpha": 1.0, "gamma": 1.0}}, "got 0 that are free"),
        ("contour", {"axes": ("alpha", "alpha")}, "2 different axes"),
        ("contour", {"axes": ("alpha", "gamma"), "params": {"alpha": 1.0}}, "both fixed and"),
        ("contour", {"scale": (2.0, 1.0)}, "from a number to a larger one"),
        ("polar", {"convention": "plane"}, "turns gravity in the body itself"),
        ("sphere", {"channel": "tip_angel"}, "did you mean 'tip_angle'"),
        ("robot", {"gravity": (0.0, 0.0, 0.0)}, "longer than 0"),
        ("robot", {"gravity": [DOWN, DOWN]}, "give x, y, z"),
    ],
)
def test_wrong_option_is_refused_in_one_sentence(two, kind, options, fragment):
    refused(two, kind, fragment, **options)


def test_options_that_the_map_cannot_answer_are_refused(two, tmp_path):
    text = two.text.replace("alpha = 50, gamma = 50", "alpha = 11, gamma = 6")
    recipe = lutgen.parse_recipe(text.replace("nodes = 33", "nodes = 9"))
    two_map = lutgen.sweep(recipe, tmp_path / "two.h5")
    refused(two_map, "contour", "recipe", channel="margin")
    refused(two_map, "contour", "recipe", gravity=(1.0, 0.0, -0.2))
    with pytest.raises(TypeError, match="channels"):
        plot.draw("sphere", two_map, channels="sdg")

"""Figures of tilt limits, paths and feet, and films: what they draw is what was computed."""

import math
from functools import partial
from itertools import pairwise

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from matplotlib.patches import Polygon
from matplotlib.text import Annotation
from PIL import Image

from lutgen.analysis import Footing, Posture, posture_limits, sweep_limits, tilt_limits
from lutgen.plot import animate, draw_footing, draw_limits, draw_path
from lutgen.plot.path import CAMERA
from lutgen.plot.style import LIGHT
from lutgen.recipe import parse_recipe
from lutgen.search import drive, paper_path, turned
from tests.fixtures import commands
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import tripod

SHAPE = [math.atan(0.6)] * 2
# Dots.
SIZE = (640, 448)


def by_hand(two, points, **options):
    path = turned(paper_path(points), math.radians(30.0))
    return drive(two, path, params0=SHAPE, **options)


def test_the_figure_of_limits_holds_them():
    robot = parse_recipe(tripod("reach = 2, swing = 2"))
    rows = robot.grid.params(np.arange(robot.grid.size))
    found = posture_limits(Posture(robot, rows[2]))
    swept = sweep_limits(robot, rows, np.radians(np.arange(24) * 15.0))
    figure = draw_limits(robot, found, swept)
    lines = {str(line.get_label()): line for line in figure.axes[0].get_lines()}

    def polar(label):
        x, y = (np.asarray(part)[:-1] for part in lines[label].get_data())
        return np.arctan2(-x, y), 90.0 * np.hypot(x, y)

    heading, tilt = polar("tips over")
    # Gaps of less than 2 deg of heading are closed, which rounds dents off.
    expected = np.degrees(tilt_limits(robot, rows[2], heading, "plane"))
    np.testing.assert_allclose(tilt, expected, atol=0.05)
    np.testing.assert_allclose(polar("best posture")[1], np.degrees(swept.most))
    np.testing.assert_allclose(polar("worst posture")[1], np.degrees(swept.least))
    slides = polar("slides at 38\N{DEGREE SIGN}")[1]
    assert slides[np.isfinite(slides)] == pytest.approx(math.degrees(math.atan(0.8)), abs=1e-9)
    only_best = draw_limits(robot, found, swept, worst=False).axes[0].get_lines()
    assert "worst posture" not in {line.get_label() for line in only_best}


def test_red_is_where_it_tips_over_and_nowhere_else(two):
    fixed, changing = by_hand(two, 100, control=False), by_hand(two, 100)
    figure = draw_path(two, {"fixed shape": fixed, "changing shape": changing})
    for axes, drawn in zip(figure.axes[:2], (fixed, changing), strict=True):
        (red,) = (c for c in axes.collections if c.get_label() == "tips over")
        assert np.allclose(red.get_edgecolor()[0], to_rgba(LIGHT.red))
        inside = {tuple(point) for piece in red.get_segments() for point in piece}
        points = CAMERA.flat(drawn.path.position - drawn.path.position.mean(axis=0))
        assert [tuple(point) in inside for point in points] == drawn.tips.tolist()
        assert axes.get_aspect() == 1.0
    angles, geometry = figure.axes[2:]
    for line, drawn in zip(angles.lines, (fixed, changing), strict=False):
        expected = np.degrees(drawn.channels["tip_angle"])
        np.testing.assert_array_equal(line.get_ydata(), expected)
    labels = [line.get_label() for line in geometry.lines]
    assert labels == ["\N{GREEK SMALL LETTER ALPHA}", "\N{GREEK SMALL LETTER GAMMA}"]
    np.testing.assert_array_equal(geometry.lines[0].get_ydata(), np.degrees(changing.params[:, 0]))


def frames(path):
    """Return the pictures of a GIF, (height, width, 3)."""
    with Image.open(path) as film:
        result = []
        for i in range(getattr(film, "n_frames", 1)):
            film.seek(i)
            result.append(np.asarray(film.convert("RGB")))
    return result


run = partial(commands.run, "path")


def is_red(picture):
    r, g, b = picture[:40].astype(int).transpose(2, 0, 1)
    return bool(((r > 150) & (g < 110) & (b < 110)).any())


def test_the_title_is_red_where_the_robot_tips_and_nowhere_else(two, tmp_path):
    fixed = by_hand(two, 4, control=False)
    changing = by_hand(two, 4)
    animate(two, {"fixed shape": fixed, "changing shape": changing}, tmp_path / "film.gif")
    pictures = frames(tmp_path / "film.gif")
    half = SIZE[0] // 2
    for film, drawn in ((slice(None, half), fixed), (slice(half, None), changing)):
        assert [is_red(picture[:, film]) for picture in pictures] == drawn.tips.tolist()
    # Both sides show both, and not the same.
    assert 0 < changing.tips.sum() < fixed.tips.sum() < 4


def test_the_command_writes_the_film_of_the_library(two, tmp_path):
    recipe, film = MAPS / "paper_two.toml", tmp_path / "film.gif"
    angles = [f"{name}={math.degrees(SHAPE[0])!r}" for name in ("alpha", "gamma")]
    given = ("-p", angles[0], "-p", angles[1], "--turn", 30, "--points", 3)
    result = run(recipe, *given, "--animate", film)
    # With control it still tips over at one of these three points.
    assert result.exit_code == 3, result.stderr
    assert "changing shape" in result.stdout
    runs = {"fixed shape": by_hand(two, 3, control=False), "changing shape": by_hand(two, 3)}
    animate(two, runs, tmp_path / "same.gif")
    assert film.read_bytes() == (tmp_path / "same.gif").read_bytes()
    with Image.open(film) as shown:
        # 7.2 s for 3 frames would be slow: half a second each is the longest.
        found = (shown.size, shown.info["duration"], shown.info["loop"], shown.format)
    assert found == (SIZE, 500, 0, "GIF")
    assert all((one != other).any() for one, other in pairwise(frames(film)))


def test_an_mp4_gets_the_frames_that_a_film_may_have_where_there_is_ffmpeg(
    two, tmp_path, monkeypatch
):
    # It stands in for ffmpeg: what comes in goes to the file that is named last.
    program = tmp_path / "ffmpeg"
    program.write_text('#!/bin/sh\nfor last; do :; done\nexec /bin/cat > "$last"\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path / "none"))
    none = run(two.source, "--points", 2, "--animate", tmp_path / "other.mp4")
    assert (none.exit_code, "an MP4 needs the program ffmpeg" in none.stderr) == (2, True)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr("lutgen.plot.path.MOST_FRAMES", 3)
    film = tmp_path / "film.mp4"
    assert animate(two, {"fixed": by_hand(two, 90, control=False)}, film) == 3
    # Red, green, blue and opacity.
    assert film.stat().st_size == 3 * SIZE[0] * SIZE[1] * 4
    program.write_text("#!/bin/sh\nexit 1\n")
    result = run(two.source, "--points", 2, "--animate", tmp_path / "other.mp4")
    assert result.exit_code == 2
    assert "ffmpeg made no film" in result.stderr
    assert not (tmp_path / "other.mp4").exists()


FEET = Footing(
    "table",
    "cm",
    ("front", "rear_left", "rear_right"),
    points=np.array([[30.0, 0.0, 10.0], [-20.0, 20.0, 0.0], [-20.0, -20.0, 0.0]]),
    normals=np.tile([0.0, 0.0, 1.0], (3, 1)),
    friction=np.full(3, 0.5),
    com=np.array([5.0, 0.0, 40.0]),
    gravity_dir=np.array([0.0, 0.0, -1.0]),
)


def footing(**changes):
    return Footing(**(vars(FEET) | changes))


def test_the_region_is_filled_in_one_scale_with_units_and_forces_if_it_holds():
    found = FEET.equilibrium()
    figure = draw_footing(FEET, found)
    (axes,) = figure.axes
    (filled,) = (part for part in axes.patches if isinstance(part, Polygon))
    np.testing.assert_allclose(filled.get_xy()[:-1], found.region)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x (cm)", "y (cm)")
    box = axes.get_window_extent()
    scales = [box.width / np.ptp(axes.get_xlim()), box.height / np.ptp(axes.get_ylim())]
    assert scales == pytest.approx([scales[0]] * 2, rel=1e-6)
    assert figure.texts[0].get_text().startswith("Holds, margin ")
    names = [text.get_text() for text in axes.texts if isinstance(text, Annotation)]
    assert {"front", "rear left", "rear right"} <= set(names)
    assert names.count("") >= 2


def test_the_title_says_if_it_does_not_hold_and_there_are_no_forces():
    tips = footing(com=np.array([50.0, 0.0, 40.0]))
    figure = draw_footing(tips, tips.equilibrium())
    assert figure.texts[0].get_text() == "Does not hold, margin \N{MINUS SIGN}20 cm"
    assert "" not in [text.get_text() for text in figure.axes[0].texts]
    nowhere = footing(friction=np.zeros(3), gravity_dir=np.array([0.3, 0.0, -1.0]))
    assert draw_footing(nowhere, nowhere.equilibrium()).texts[0].get_text() == "Does not hold"


def test_lines_points_and_open_regions_stay_in_the_picture():
    down = {"friction": np.full(2, 0.5), "names": ("a", "b")}
    walls = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
    between = footing(points=10.0 * -walls, normals=walls, **down)
    found = between.equilibrium()
    assert found.is_open
    (axes,) = draw_footing(between, found).axes
    assert np.abs(axes.get_xlim()).max() < 100.0
    one = footing(
        points=np.zeros((1, 3)),
        normals=np.array([[0.0, 1.0, 0.0]]),
        friction=np.array([0.0]),
        names=("a",),
        com=np.zeros(3),
        gravity_dir=np.array([0.0, -1.0, 0.0]),
    )
    (axes,) = draw_footing(one, one.equilibrium()).axes
    assert axes.get_ylabel() == "left (cm)"
    assert math.isfinite(np.ptp(axes.get_ylim()))

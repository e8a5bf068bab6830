"""Figures of tilt limits and of paths: what they draw is what was computed."""

import math

import numpy as np
import pytest
from matplotlib.colors import to_rgba

from lutgen.analysis import Posture, posture_limits, sweep_limits, tilt_limits
from lutgen.plot import draw_limits, draw_path
from lutgen.plot.path import CAMERA
from lutgen.plot.style import LIGHT
from lutgen.recipe import parse_recipe
from lutgen.search import drive, paper_path, turned
from tests.fixtures.recipes import tripod


def by_hand(two, points, **options):
    path = turned(paper_path(points), math.radians(30.0))
    return drive(two, path, params0=np.radians([30.963756532073525] * 2), **options)


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
    best, worst = polar("best posture")[1], polar("worst posture")[1]
    np.testing.assert_allclose(best, np.degrees(swept.most))
    np.testing.assert_allclose(worst, np.degrees(swept.least))
    least = math.floor(math.degrees(found.worst.tilt))
    assert f"at least {least}\N{DEGREE SIGN} in any" in figure.texts[0].get_text()
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

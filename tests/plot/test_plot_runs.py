"""Figures of tilt limits and of paths: what they draw is what was computed."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.collections import Collection
from matplotlib.figure import Figure

from lutgen.analysis import Posture, posture_limits, sweep_limits, tilt_limits
from lutgen.plot import draw_limits, draw_path, save
from lutgen.plot.path import RED
from lutgen.recipe import Recipe, load_recipe, parse_recipe
from lutgen.search import Drive, drive, paper_path, turned
from lutgen.search.terrain import along
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import tripod


@pytest.fixture(scope="module")
def two() -> Recipe:
    """Return the paper's robot."""
    return load_recipe(MAPS / "paper_two.toml")


def by_hand(two: Recipe, points: int, **options: Any) -> Drive:
    path = turned(paper_path(points), math.radians(30.0))
    return drive(two, path, params0=np.radians([30.963756532073525] * 2), **options)


def test_the_figure_of_limits_holds_them() -> None:
    robot = parse_recipe(tripod())
    rows = robot.grid.params(np.arange(robot.grid.size))
    found = posture_limits(Posture(robot, rows[4]))
    swept = sweep_limits(robot, rows, np.radians(np.arange(72) * 5.0))
    figure = draw_limits(robot, found, swept)
    lines = {str(line.get_label()).split(":")[0]: line for line in figure.axes[0].get_lines()}
    heading, tilt = (np.asarray(part) for part in lines["body tilt"].get_data())
    # Radians to degrees and back.
    expected = np.degrees(tilt_limits(robot, rows[4], heading, "plane"))
    np.testing.assert_allclose(tilt, expected, atol=1e-9)
    circle = np.asarray(lines["body tilt, guaranteed"].get_ydata())
    assert circle.min() == circle.max() == pytest.approx(math.degrees(found.guaranteed))
    assert (circle.max() <= tilt + 1e-9).all()
    best = np.asarray(lines["best posture per heading"].get_ydata())
    worst = np.asarray(lines["worst posture per heading"].get_ydata())
    np.testing.assert_allclose(best[::10], np.degrees(np.append(swept.most, swept.most[0])))
    assert (best[::10] >= tilt[::10] - 1e-9).all()
    assert (worst[::10] <= tilt[::10] + 1e-9).all()
    slides = np.asarray(lines[r"slides ($\mu$ = 0.8)"].get_ydata())
    np.testing.assert_allclose(slides, math.degrees(math.atan(0.8)), atol=1e-9)
    alone = {str(line.get_label()) for line in draw_limits(robot, found).axes[0].get_lines()}
    assert not any("posture in each" in label for label in alone)
    only_best = draw_limits(robot, found, swept, worst=False).axes[0].get_lines()
    assert "worst posture per heading" not in {line.get_label() for line in only_best}


def reds(axes: Any) -> list[Any]:
    """Return the pieces of the path that are drawn red."""
    (found,) = [
        c
        for c in axes.collections
        if isinstance(c, Collection) and hasattr(c, "_segments3d") and _is_red(c)
    ]
    return list(found._segments3d)


def _is_red(collection: Collection) -> bool:
    colours = np.atleast_2d(np.asarray(collection.get_edgecolor()))
    return bool(len(colours)) and np.allclose(colours[0, :3] * 255, _rgb(RED), atol=0.6)


def _rgb(colour: str) -> list[int]:
    return [int(colour[i : i + 2], 16) for i in (1, 3, 5)]


def test_red_is_where_it_tips_over_and_nowhere_else(two: Recipe) -> None:
    fixed, changing = by_hand(two, 100, control=False), by_hand(two, 100)
    figure = draw_path(two, {"fixed shape": fixed, "changing shape": changing})
    for axes, drawn in zip(figure.axes[:2], (fixed, changing), strict=True):
        pieces = reds(axes)
        inside = {tuple(point) for piece in pieces for point in piece}
        points = [tuple(point) for point in drawn.path.position]
        assert [point in inside for point in points] == drawn.tips.tolist()
        # Equal scale: a length is as long along x as along z.
        sides = np.array(
            [np.ptp(lim) for lim in (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())]
        )
        shape = np.asarray(axes._box_aspect)
        np.testing.assert_allclose(shape / shape[0], sides / sides[0], rtol=1e-12)
    angles, geometry = figure.axes[2:]
    for line, drawn in zip(angles.lines, (fixed, changing), strict=False):
        expected = np.degrees(drawn.channels["tip_angle"])
        np.testing.assert_array_equal(line.get_ydata(), expected)
    labels = [line.get_label() for line in geometry.lines]
    assert labels == [r"$\alpha$", r"$\gamma$"]
    np.testing.assert_array_equal(geometry.lines[0].get_ydata(), np.degrees(changing.params[:, 0]))


def inside_paper(figure: Figure) -> bool:
    """Tell whether all texts of a figure are on the paper."""
    canvas: Any = figure.canvas
    renderer = canvas.get_renderer()
    texts = [text for axes in figure.axes for text in (axes.xaxis.label, axes.yaxis.label)]
    boxes = [
        text.get_window_extent(renderer) for text in [*texts, *figure.texts] if text.get_text()
    ]
    width, height = figure.get_size_inches() * figure.dpi
    return all(b.x0 >= 0 and b.y0 >= 0 and b.x1 <= width and b.y1 <= height for b in boxes)


@pytest.mark.parametrize(
    "points",
    [
        [[0, 0, 0], [1, 0, 0], [2, 0, 0]],
        [[0, 0, 0], [0, 50, 0.5], [3, 90, 0.2]],
        [[1e6, 5, 0], [1e6 + 1, 5, 2], [1e6 + 1.5, 5, 3]],
    ],
)
def test_any_path_is_drawn_within_the_paper(two: Recipe, points: Any, tmp_path: Path) -> None:
    rates = {"alpha": 0.001}
    straight = drive(two, along(points), control=False)
    free = drive(two, along(points), lag=0, headings=8, rates=rates, speed=1.0)
    for runs in ({"turning": free}, {"fixed": straight, "turning": free}, {"fixed": straight}):
        figure = draw_path(two, runs)
        assert inside_paper(figure)
        save(figure, tmp_path / "path.svg")

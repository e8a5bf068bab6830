"""`lutgen path` and its page: what it prints, writes and draws, and how it refuses."""

import csv
import json
import math
import re
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure

from lutgen.errors import InputError
from lutgen.plot import draw_path, save
from lutgen.plot.path import CAMERA
from lutgen.plot.style import LIGHT
from lutgen.recipe.recipe import Recipe, load_recipe
from lutgen.search.driving import Drive, drive
from lutgen.search.terrain import paper_path, turned
from tests.fixtures import commands
from tests.fixtures.documents import blocks
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import feet, rigid, tripod

NOMINAL = 30.963756532073525
PAPER = ("--turn", 30, "-p", f"alpha={NOMINAL}", "-p", f"gamma={NOMINAL}")


@pytest.fixture(scope="module")
def recipe() -> str:
    """Return the path of the paper's recipe."""
    return str(MAPS / "paper_two.toml")


@pytest.fixture(scope="module")
def two(recipe: str) -> Recipe:
    """Return the paper's robot."""
    return load_recipe(recipe)


run = partial(commands.run, "path")


def good(*arguments: object) -> str:
    """Return what a path prints; its exit code says whether the last run tips over anywhere."""
    result = run(*arguments)
    *_, last = result.stdout.splitlines()
    assert result.exit_code == (0 if "tips over at 0 points" in last else 3), result.stderr
    return result.stdout


def data(*arguments: object) -> dict[str, Any]:
    """Return what a path prints with --json; its exit code is the one of the same in words."""
    report = json.loads(run(*arguments, "--json").stdout)
    code = 3 if report["runs"][-1]["tips_at"] else 0
    return commands.data("path", *arguments, code=code)


def by_hand(two: Recipe, points: int, **options: Any) -> Drive:
    path = turned(paper_path(points), math.radians(30.0))
    return drive(two, path, params0=np.radians([NOMINAL, NOMINAL]), **options)


# What is printed


def test_it_prints_the_papers_percentages(recipe: str) -> None:
    head, fixed, changing = good(recipe, *PAPER).splitlines()
    assert head == "paper_two on the paper's path: 100 points, length 38.9766"
    assert re.match(r"fixed shape +tips over at 72 points \(72 %\), least tip angle -38\.41", fixed)
    assert re.match(r"changing shape +tips over at 22 points \(22 %\)", changing)
    assert "at point 0 (" in changing


def test_without_control_there_is_one_run_and_with_headings_there_are_four(recipe: str) -> None:
    short = (recipe, *PAPER, "--points", 8)
    names = [entry["name"] for entry in data(*short, "--no-control")["runs"]]
    assert names == ["fixed shape"]
    names = [entry["name"] for entry in data(*short, "--no-control", "--headings", 3)["runs"]]
    assert names == ["fixed shape", "turning"]
    report = data(*short, "--headings", 4)
    names = [entry["name"] for entry in report["runs"]]
    assert names == ["fixed shape", "turning", "changing shape", "changing shape and turning"]
    assert [any(entry["turn_deg"]) for entry in report["runs"]] == [False, True] * 2


def test_json_has_the_numbers_of_the_library(recipe: str, two: Recipe) -> None:
    options = ("--lag", 2, "--objective", "tip_angle", "--method", "nelder-mead")
    report = data(recipe, *PAPER, "--points", 9, *options, "--convention", "body")
    assert {key: report[key] for key in ("robot", "points", "lag", "method", "objective")} == {
        "robot": "paper_two",
        "points": 9,
        "lag": 2,
        "method": "nelder-mead",
        "objective": "tip_angle",
    }
    given = {"method": "nelder-mead", "objective": "tip_angle", "convention": "body"}
    expected = by_hand(two, 9, lag=2, **given)
    entry = report["runs"][1]
    assert entry["tips_at"] == np.flatnonzero(expected.tips).tolist()
    assert entry["share"] == expected.share
    assert entry["least_at"] == expected.channels["tip_angle"].argmin()
    np.testing.assert_allclose(np.radians(entry["params"]["gamma_deg"]), expected.params[:, 1])
    np.testing.assert_allclose(entry["margin"], expected.channels["margin"])
    assert [value is None for value in entry["sdg"]] == expected.tips.tolist()
    np.testing.assert_allclose(report["path"]["z"], expected.path.position[:, 2])


def test_rates_are_in_degrees_per_second(recipe: str, two: Recipe) -> None:
    limited = ("--rate", "alpha=20", "--rate", "gamma=5", "--speed", 1.5)
    report = data(recipe, *PAPER, "--points", 12, *limited)
    rates = {"alpha": math.radians(20.0), "gamma": math.radians(5.0)}
    expected = by_hand(two, 12, rates=rates, speed=1.5)
    reached = np.radians(list(report["runs"][1]["params"].values())).T
    np.testing.assert_allclose(reached, expected.params)
    assert (expected.params != expected.wanted).any()


# What is written


def test_the_csv_reads_back_as_the_same_numbers(recipe: str, two: Recipe, tmp_path: Path) -> None:
    file = tmp_path / "run.csv"
    good(recipe, *PAPER, "--points", 30, "-o", file)
    with file.open(newline="", encoding="utf-8") as text:
        rows = list(csv.DictReader(text))
    expected = by_hand(two, 30)
    assert list(rows[0]) == [
        *("x", "y", "z", "heading_deg", "alpha_deg", "gamma_deg"),
        *("gravity_x", "gravity_y", "gravity_z"),
        *("sdg", "height", "tip_angle_deg", "margin", "tips"),
    ]
    columns = {name: np.array([float(row[name] or "nan") for row in rows]) for name in rows[0]}
    np.testing.assert_array_equal(columns["z"], expected.path.position[:, 2])
    np.testing.assert_array_equal(columns["alpha_deg"], np.degrees(expected.params[:, 0]))
    np.testing.assert_array_equal(columns["gravity_y"], expected.gravity_body[:, 1])
    np.testing.assert_array_equal(columns["sdg"], expected.channels["sdg"])
    np.testing.assert_array_equal(columns["tips"] == 1, expected.tips)
    assert [path.name for path in tmp_path.iterdir()] == ["run.csv"]


def test_a_terrain_of_ones_own_is_read_and_limits_are_in_the_table(tmp_path: Path) -> None:
    (tmp_path / "tripod.toml").write_text(tripod())
    (tmp_path / "hill.csv").write_text("x,y,z\n0,0,0\n1,0,0.2\n2,0,0.6\n3,0,0.6\n")
    arguments = (tmp_path / "tripod.toml", "--terrain", tmp_path / "hill.csv")
    head, *_ = good(*arguments).splitlines()
    assert head.endswith("hill.csv: 4 points, length 3.09684 m")
    good(*arguments, "--rate", "reach=0.01", "--speed", 1, "-o", tmp_path / "run.csv")
    names = (tmp_path / "run.csv").read_text().splitlines()[0].split(",")
    assert {"reach_m", "swing_deg", "reach_wanted_m", "swing_wanted_deg"} <= set(names)


# What is drawn


def test_the_figure_has_both_runs_and_repeats_to_the_byte(recipe: str, tmp_path: Path) -> None:
    for name in ("a.png", "b.png"):
        good(recipe, *PAPER, "--points", 40, "--plot", tmp_path / name)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_red_is_where_it_tips_over_and_nowhere_else(two: Recipe) -> None:
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
    from lutgen.search.terrain import along

    rates = {"alpha": 0.001}
    straight = drive(two, along(points), control=False)
    free = drive(two, along(points), lag=0, headings=8, rates=rates, speed=1.0)
    for runs in ({"turning": free}, {"fixed": straight, "turning": free}, {"fixed": straight}):
        figure = draw_path(two, runs)
        assert inside_paper(figure)
        save(figure, tmp_path / "path.svg")


# What is refused


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--points", 1], "at least 2 points"),
        (["-p", "alpha=55"], "alpha must lie in 0 to 50 deg (got -p alpha=55)"),
        (["--terrain", "none.csv"], "none.csv: cannot be read"),
        (["--terrain", "none.csv", "--points", 5], "leave it out"),
        (["-p", "beta=1"], "no parameter 'beta'"),
        (["--rate", "alpha=1"], "need a speed"),
        (["--speed", 1], "need a speed, and a speed needs rates"),
        (["--rate", "alpha=1", "--rate", "alpha=2", "--speed", 1], "given twice"),
        (["--rate", "beta=1", "--speed", 1], "no parameter 'beta' to limit"),
        (["--no-control", "--speed", 1], "a shape that does not change has no rates"),
        (["--headings", 0], "at least one heading"),
        (["--lag", -1], "got lag -1"),
        (["--objective", "luck"], "objective 'luck'"),
        (["--points", 3, "-o", "missing/run.csv"], "cannot be written"),
        (["--points", 3, "--plot", "run.gif"], "unknown kind of picture"),
    ],
)
def test_what_is_wrong_is_said_in_one_sentence(
    recipe: str, arguments: list[object], said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = run(recipe, *arguments)
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    (line,) = result.stderr.splitlines()
    assert line.startswith("Error: ")
    assert said in line
    assert list(tmp_path.iterdir()) == []


def test_a_rigid_robot_needs_no_control(tmp_path: Path) -> None:
    file = tmp_path / "rigid.toml"
    file.write_text(rigid(feet([(1, 0, -1), (-1, 1, -1), (-1, -1, -1)])))
    assert "--no-control" in run(file).stderr
    assert "fixed shape" in good(file, "--no-control")


# The page


def test_everything_on_the_page_runs_and_prints_what_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "maps").symlink_to(MAPS)
    monkeypatch.chdir(tmp_path)
    (hill,) = blocks("docs/guide/path.md", "csv")
    Path("hill.csv").write_text(hill)
    commands, shown = blocks("docs/guide/path.md", "sh"), blocks("docs/guide/path.md", "text")
    assert len(commands) == len(shown) > 0
    for command, text in zip(commands, shown, strict=True):
        program, name, *arguments = command.replace("\\\n", " ").split()
        assert (program, name) == ("lutgen", "path")
        assert good(*arguments) == text
    assert Path("drive.csv").stat().st_size > 0
    assert Path("drive.png").read_bytes().startswith(b"\x89PNG")
    assert Path("hill.gif").read_bytes().startswith(b"GIF89a")
    (code,) = blocks("docs/guide/path.md", "python")
    printed: list[str] = []
    exec(
        compile(code, "docs/guide/path.md", "exec"),
        {"print": lambda *a: printed.append(" ".join(map(str, a)))},
    )
    assert printed == re.findall(r"^print\(.*\)  # (.*)$", code, re.MULTILINE)


def test_the_library_refuses_a_file_for_what_it_is(tmp_path: Path, recipe: str) -> None:
    (tmp_path / "odd.csv").write_text("x;y;z\n0;0;0\n")
    result = run(recipe, "--terrain", tmp_path / "odd.csv")
    assert result.exit_code == 2
    assert "line 1 names no column x (got x;y;z)" in result.stderr
    with pytest.raises(InputError, match="at least 2 points"):
        paper_path(0)


def test_a_path_tells_the_tilt_of_the_ground_from_that_of_the_body(recipe: str) -> None:
    arguments = (recipe, "--points", 9, "--no-control", "-p", "alpha=40", "-p", "gamma=5")
    report = data(*arguments)
    (run,) = report["runs"]
    assert len(report["ground_tilt_deg"]) == len(run["body_tilt_deg"]) == 9
    down = np.array(run["gravity_body"])
    # Rounding of an arc cosine near 1.
    np.testing.assert_allclose(
        np.cos(np.radians(run["body_tilt_deg"])), -down[:, 2], rtol=0.0, atol=1e-12
    )
    # A robot with one wheel low leans on the ground.
    assert np.abs(np.subtract(run["body_tilt_deg"], report["ground_tilt_deg"])).max() > 5.0
    body = data(*arguments, "--convention", "body")
    assert "ground_tilt_deg" not in body
    # The body then has the tilt that the path gives.
    np.testing.assert_allclose(body["runs"][0]["body_tilt_deg"], report["ground_tilt_deg"])

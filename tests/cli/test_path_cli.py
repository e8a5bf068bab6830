"""`lutgen path` and its page: what it prints, writes and draws, and how it refuses."""

import csv
import json
import math
from functools import partial

import numpy as np

from lutgen.search.driving import drive
from lutgen.search.terrain import paper_path, turned
from tests.fixtures import commands
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import tripod

NOMINAL = 30.963756532073525
RECIPE = MAPS / "paper_two.toml"
PAPER = ("--turn", 30, "-p", f"alpha={NOMINAL}", "-p", f"gamma={NOMINAL}")
run = partial(commands.run, "path")


def good(*arguments):
    """Return what a path prints; its exit code says whether the last run tips over anywhere."""
    result = run(*arguments)
    *_, last = result.stdout.splitlines()
    assert result.exit_code == (0 if "tips over at 0 points" in last else 3), result.stderr
    return result.stdout


def data(*arguments):
    """Return what a path prints with --json; its exit code is the one of the same in words."""
    report = json.loads(run(*arguments, "--json").stdout)
    code = 3 if report["runs"][-1]["tips_at"] else 0
    return commands.data("path", *arguments, code=code)


def by_hand(two, points, **options):
    path = turned(paper_path(points), math.radians(30.0))
    return drive(two, path, params0=np.radians([NOMINAL, NOMINAL]), **options)


# What is printed


def test_without_control_there_is_one_run_and_with_headings_there_are_four():
    report = data(RECIPE, *PAPER, "--points", 8, "--headings", 4)
    names = ["fixed shape", "turning", "changing shape", "changing shape and turning"]
    assert [entry["name"] for entry in report["runs"]] == names
    assert [any(entry["turn_deg"]) for entry in report["runs"]] == [False, True] * 2
    report = data(RECIPE, *PAPER, "--points", 8, "--headings", 3, "--no-control")
    assert [entry["name"] for entry in report["runs"]] == names[:2]


def test_rates_are_in_degrees_per_second(two):
    limited = ("--rate", "alpha=20", "--rate", "gamma=5", "--speed", 1.5)
    report = data(RECIPE, *PAPER, "--points", 12, *limited)
    rates = {"alpha": math.radians(20.0), "gamma": math.radians(5.0)}
    expected = by_hand(two, 12, rates=rates, speed=1.5)
    reached = np.radians(list(report["runs"][1]["params"].values())).T
    np.testing.assert_allclose(reached, expected.params)
    assert (expected.params != expected.wanted).any()


# What is written


def test_the_csv_reads_back_as_the_same_numbers(two, tmp_path):
    file = tmp_path / "run.csv"
    options = ("--lag", 2, "--objective", "tip_angle", "--method", "nelder-mead")
    good(RECIPE, *PAPER, "--points", 9, *options, "--convention", "body", "-o", file)
    with file.open(newline="", encoding="utf-8") as text:
        rows = list(csv.DictReader(text))
    given = {"method": "nelder-mead", "objective": "tip_angle", "convention": "body"}
    expected = by_hand(two, 9, lag=2, **given)
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


def test_a_terrain_of_ones_own_is_read_and_limits_are_in_the_table(tmp_path):
    (tmp_path / "tripod.toml").write_text(tripod())
    (tmp_path / "hill.csv").write_text("x,y,z\n0,0,0\n1,0,0.2\n2,0,0.6\n3,0,0.6\n")
    arguments = (tmp_path / "tripod.toml", "--terrain", tmp_path / "hill.csv")
    head, *_ = good(*arguments).splitlines()
    assert head.endswith("hill.csv: 4 points, length 3.09684 m")
    written = ("-o", tmp_path / "run.csv", "--plot", tmp_path / "run.svg", "--size", "120")
    good(*arguments, "--rate", "reach=0.01", "--speed", 1, *written)
    assert (tmp_path / "run.svg").read_bytes().startswith(b"<?xml")
    names = (tmp_path / "run.csv").read_text().splitlines()[0].split(",")
    assert {"reach_m", "swing_deg", "reach_wanted_m", "swing_wanted_deg"} <= set(names)


def test_a_path_tells_the_tilt_of_the_ground_from_that_of_the_body():
    arguments = (RECIPE, "--points", 9, "--no-control", "-p", "alpha=40", "-p", "gamma=5")
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

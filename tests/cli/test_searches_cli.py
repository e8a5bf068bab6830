"""`lutgen optimum` and `lutgen path`: what they print, write and draw, and their exit codes."""

import csv
import json
import math
import re
from functools import partial

import numpy as np
import pytest

from lutgen.search import drive, paper_path, turned
from tests.fixtures import commands
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import tripod

RECIPE = str(MAPS / "paper_two.toml")
optimum = partial(commands.run, "optimum")
best = partial(commands.data, "optimum")


def test_the_text_names_value_deltas_ranges_and_evaluations():
    result = optimum(RECIPE, "--limit", 0.05)
    assert result.exit_code == 0
    first, alpha, gamma = result.stdout.splitlines()
    assert first == "paper_two, search: stands, sdg 0.000485608, 150 evaluations"
    for name, line in (("alpha", alpha), ("gamma", gamma)):
        assert line == (f"  {name}  30.9568 deg  +- 0.712406 deg  acceptable 30.2364 to 31.6692")


def test_the_last_node_is_shown_beside_a_better_one_seen_before():
    lines = optimum(RECIPE, "--levels", 2).stdout.splitlines()
    assert lines[1].startswith("  alpha  30 deg")
    assert lines[-1] == "last node, worse than the best seen: alpha 32 deg, gamma 32 deg: 0.0734351"
    assert "last node" not in optimum(RECIPE).stdout
    last = best(RECIPE, "--levels", 2)["last"]
    assert last["parameters"]["alpha"]["value_deg"] == pytest.approx(32.0, abs=1e-12)
    assert last["value"] > best(RECIPE, "--levels", 2)["value"]


def test_lengths_and_angles_keep_the_units_of_the_recipe(tripod_path):
    report = best(tripod_path, "--bounds", "reach=0.1:0.5", "--bounds", "swing=-10:20")
    assert 0.1 <= report["parameters"]["reach"]["value"] <= 0.5
    assert -10 <= report["parameters"]["swing"]["value_deg"] <= 20
    assert "value_deg" not in report["parameters"]["reach"]
    text = optimum(tripod_path).stdout
    assert re.search(r"^  reach  [\d.]+ m  ", text, re.MULTILINE)
    assert re.search(r"^  swing  -?[\d.]+ deg  ", text, re.MULTILINE)


def test_a_parameter_given_a_value_keeps_it():
    report = best(RECIPE, "-p", "gamma=20", "--method", "multistart")
    assert report["parameters"]["gamma"]["value_deg"] == pytest.approx(20.0, abs=1e-12)
    assert report["parameters"]["gamma"]["kept"] is True
    assert report["parameters"]["alpha"]["kept"] is False
    assert re.search(
        r"^  gamma  20 deg       kept$", optimum(RECIPE, "-p", "gamma=20").stdout, re.MULTILINE
    )


def test_start_seed_and_ends_reach_the_methods():
    near = best(RECIPE, "--method", "nelder-mead", "--start", "alpha=31", "--start", "gamma=31")
    far = best(RECIPE, "--method", "nelder-mead", "--start", "alpha=3")
    assert near["evaluations"] != far["evaluations"]
    seeds = [best(RECIPE, "--method", "multistart", "--seed", s)["evaluations"] for s in (0, 0, 1)]
    assert seeds[0] == seeds[1] != seeds[2]
    right = best(RECIPE, "--ends", "right", "--levels", 1, "--bounds", "alpha=3:53")
    assert right["parameters"]["alpha"]["value_deg"] in [pytest.approx(x) for x in (33, 23)]


def test_an_optimum_beyond_the_limit_has_no_range_and_says_so(caplog):
    report = best(RECIPE, "--method", "map", "--limit", 1e-6)
    assert report["standing"] is True
    assert report["parameters"]["alpha"]["acceptable_deg"] == [None, None]
    assert "exceeds the limit: no range is acceptable" in caplog.text


NOMINAL = 30.963756532073525
RECIPE = MAPS / "paper_two.toml"
PAPER = ("--turn", 30, "-p", f"alpha={NOMINAL}", "-p", f"gamma={NOMINAL}")


def data(*arguments):
    """Return what a path prints with --json; its exit code says whether the last run tips over."""
    result = commands.run("path", *arguments, "--json")
    report = json.loads(result.stdout)
    assert result.exit_code == (3 if report["runs"][-1]["tips_at"] else 0), result.stderr
    return report


def by_hand(two, points, **options):
    path = turned(paper_path(points), math.radians(30.0))
    return drive(two, path, params0=np.radians([NOMINAL, NOMINAL]), **options)


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


def test_the_csv_reads_back_as_the_same_numbers(two, tmp_path):
    file = tmp_path / "run.csv"
    options = ("--lag", 2, "--objective", "tip_angle", "--method", "nelder-mead")
    data(RECIPE, *PAPER, "--points", 9, *options, "--convention", "body", "-o", file)
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
    head, *_ = commands.run("path", *arguments).stdout.splitlines()
    assert head.endswith("hill.csv: 4 points, length 3.09684 m")
    written = ("-o", tmp_path / "run.csv", "--plot", tmp_path / "run.svg", "--size", "120")
    data(*arguments, "--rate", "reach=0.01", "--speed", 1, *written)
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

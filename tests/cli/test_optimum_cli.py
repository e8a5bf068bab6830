"""`lutgen optimum`: what it prints, in which units, and its exit codes."""

import re
from functools import partial

import pytest

from tests.fixtures import commands
from tests.fixtures.places import MAPS

TWO = str(MAPS / "paper_two.toml")
run = partial(commands.run, "optimum")
data = partial(commands.data, "optimum")


def test_the_text_names_value_deltas_ranges_and_evaluations():
    result = run(TWO, "--limit", 0.05)
    assert result.exit_code == 0
    first, alpha, gamma = result.stdout.splitlines()
    assert first == "paper_two, search: stands, sdg 0.000485608, 150 evaluations"
    for name, line in (("alpha", alpha), ("gamma", gamma)):
        assert line == (f"  {name}  30.9568 deg  +- 0.712406 deg  acceptable 30.2364 to 31.6692")


def test_the_last_node_is_shown_beside_a_better_one_seen_before():
    lines = run(TWO, "--levels", 2).stdout.splitlines()
    assert lines[1].startswith("  alpha  30 deg")
    assert lines[-1] == "last node, worse than the best seen: alpha 32 deg, gamma 32 deg: 0.0734351"
    assert "last node" not in run(TWO).stdout
    last = data(TWO, "--levels", 2)["last"]
    assert last["parameters"]["alpha"]["value_deg"] == pytest.approx(32.0, abs=1e-12)
    assert last["value"] > data(TWO, "--levels", 2)["value"]


def test_lengths_and_angles_keep_the_units_of_the_recipe(tripod_path):
    report = data(tripod_path, "--bounds", "reach=0.1:0.5", "--bounds", "swing=-10:20")
    assert 0.1 <= report["parameters"]["reach"]["value"] <= 0.5
    assert -10 <= report["parameters"]["swing"]["value_deg"] <= 20
    assert "value_deg" not in report["parameters"]["reach"]
    text = run(tripod_path).stdout
    assert re.search(r"^  reach  [\d.]+ m  ", text, re.MULTILINE)
    assert re.search(r"^  swing  -?[\d.]+ deg  ", text, re.MULTILINE)


def test_a_parameter_given_a_value_keeps_it():
    report = data(TWO, "-p", "gamma=20", "--method", "multistart")
    assert report["parameters"]["gamma"]["value_deg"] == pytest.approx(20.0, abs=1e-12)
    assert report["parameters"]["gamma"]["kept"] is True
    assert report["parameters"]["alpha"]["kept"] is False
    assert re.search(
        r"^  gamma  20 deg       kept$", run(TWO, "-p", "gamma=20").stdout, re.MULTILINE
    )


def test_start_seed_and_ends_reach_the_methods():
    near = data(TWO, "--method", "nelder-mead", "--start", "alpha=31", "--start", "gamma=31")
    far = data(TWO, "--method", "nelder-mead", "--start", "alpha=3")
    assert near["evaluations"] != far["evaluations"]
    seeds = [data(TWO, "--method", "multistart", "--seed", s)["evaluations"] for s in (0, 0, 1)]
    assert seeds[0] == seeds[1] != seeds[2]
    right = data(TWO, "--ends", "right", "--levels", 1, "--bounds", "alpha=3:53")
    assert right["parameters"]["alpha"]["value_deg"] in [pytest.approx(x) for x in (33, 23)]


def test_where_nothing_stands_the_least_bad_geometry_is_printed_and_the_exit_code_is_3():
    report = data(TWO, "-g", "0,0,1", code=3)
    assert report["standing"] is False
    assert report["value"] is None
    for entry in report["parameters"].values():
        assert entry["value_deg"] is not None
        assert entry["delta_deg"] is None
        assert entry["acceptable_deg"] == [None, None]
    result = run(TWO, "-g", "0,0,1")
    assert result.exit_code == 3
    assert "tips over in every geometry tried, least in this one" in result.stdout


def test_an_optimum_beyond_the_limit_has_no_range_and_says_so(caplog):
    report = data(TWO, "--method", "map", "--limit", 1e-6)
    assert report["standing"] is True
    assert report["parameters"]["alpha"]["acceptable_deg"] == [None, None]
    assert "exceeds the limit: no range is acceptable" in caplog.text

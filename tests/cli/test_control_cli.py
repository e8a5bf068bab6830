"""`lutgen budget`, `lutgen control` and their page: what they print, write and draw, and refuse."""

import csv
import io
import json
import math
import os
import shutil
import subprocess
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from lutgen.analysis import budgets, turn_speed
from lutgen.channels import evaluate_each
from lutgen.recipe.recipe import load_recipe
from tests.fixtures import commands
from tests.fixtures.fits import untried
from tests.fixtures.needs import ROS
from tests.fixtures.places import MAPS, blocks

RECIPE = str(MAPS / "paper_two.toml")
NOMINAL = ("-p", "alpha=30.96", "-p", "gamma=30.96")
budget, control = partial(commands.data, "budget"), partial(commands.data, "control")


@pytest.fixture(scope="module")
def firmware(tmp_path_factory):
    """Run the commands of the page, on a coarser lattice of postures; return its export."""
    folder = tmp_path_factory.mktemp("page")
    with pytest.MonkeyPatch.context() as patch, untried():
        patch.chdir(folder)
        patch.setattr("firmware_export.control.maker.POSTURES", 100)
        patch.setattr("firmware_export.exporter.POINTS", 500)
        shell, *_ = blocks("docs/guide/control.md", "sh")
        for line in shell.splitlines():
            program, *arguments = line.split()
            if program == "lutgen":
                result = commands.run(*arguments)
                assert result.exit_code == 0, f"{line}: {result.output}"
            elif shutil.which("cc"):
                done = subprocess.run(line, shell=True, capture_output=True, text=True, check=True)
                assert not done.stderr
    return folder / "paper_firmware"


def ridden(firmware, *more):
    return control(firmware, "--turn", 30, *NOMINAL, *more)


def test_simulation_3_driven_by_the_exported_c_tips_at_22_points_in_place_of_72(firmware):
    found = ridden(firmware)
    assert [run["tips"] for run in found["runs"]] == [72, 22]
    told = [found[key] for key in ("cycles", "late_by_cycles", "tips_only_with_control")]
    assert told == [100, 1, 0]
    page = (MAPS.parent / "docs/guide/control.md").read_text(encoding="utf-8")
    assert "72 of 100 points" in page
    assert "22 with control" in page


def test_the_page_writes_figures_and_a_table(firmware):
    assert (firmware.parent / "ride.svg").read_bytes().startswith(b"<?xml")
    rows = list(csv.DictReader(io.StringIO((firmware.parent / "budget.csv").read_text())))
    assert float(rows[0]["braking_m_s2"]) > 16.0


@pytest.mark.skipif("ROS_DISTRO" not in os.environ, reason=ROS)
def test_the_node_compiles_where_ros_is(firmware):
    folder, ros = firmware, Path("/opt/ros") / os.environ["ROS_DISTRO"]
    includes = [f"-I{path}" for path in sorted((ros / "include").iterdir())]
    flags = ["-std=c++17", "-fsyntax-only", f"-I{folder}", f"-I{ros}/include", *includes]
    node = str(folder / "examples" / "ros2_node.cpp")
    subprocess.run(["c++", *flags, node], check=True)


def test_latency_noise_and_slow_joints_cost_what_control_gains(firmware):
    ideal = ridden(firmware)["runs"][1]["tips"]
    late = ridden(firmware, "--latency", 15)
    assert late["late_by_cycles"] == 15
    assert late["runs"][1]["tips"] > ideal
    slow = ridden(firmware, "--rate", "alpha=1", "--rate", "gamma=1")
    assert slow["runs"][1]["tips"] > ideal
    assert ideal <= ridden(firmware, "--noise", 0.5)["runs"][1]["tips"] < 30


def test_at_a_speed_the_path_is_ridden_in_cycles_of_the_policy(firmware):
    found = ridden(firmware, "--speed", 0.1)
    length = commands.data("path", RECIPE, "--no-control", code=3)["length"]
    assert found["cycles"] == math.floor(length / 0.1) + 1
    assert found["runs"][1]["tips"] < found["runs"][0]["tips"]


def test_a_log_is_ridden_again_with_control(firmware, tmp_path):
    log, cycles = tmp_path / "log.csv", 40
    tilt = np.radians(np.linspace(0.0, 60.0, cycles))
    ups = 9.81 * np.stack([np.zeros(cycles), -np.sin(tilt), np.cos(tilt)], axis=1)
    rows = [[at, *up, 31.0, 31.0] for at, up in enumerate(ups)]
    text = "time,ax,ay,az,alpha,gamma\n" + "".join(",".join(map(str, r)) + "\n" for r in rows)
    log.write_text(text)
    found = control(firmware, "--log", log)
    recorded = evaluate_each(
        load_recipe(RECIPE), np.radians([[31.0, 31.0]] * cycles), -ups, ("tip_angle",)
    )
    assert found["runs"][0]["tips"] == (recorded["tip_angle"] < 0.0).sum() > 0
    assert found["runs"][1]["tips"] < found["runs"][0]["tips"]
    for change, said in (
        (("ay", "side"), "no column ay"),
        (("\n3,", "\n1,"), "line 5 is not after"),
        (("time", "time,gx"), "no column gy"),
        (("alpha", "beta"), "no column alpha"),
    ):
        log.write_text(text.replace(*change, 1))
        refused = commands.run("control", firmware, "--log", log)
        assert refused.exit_code == 2
        assert said in refused.stderr


def test_budgets_of_a_recipe_are_where_it_tips():
    recipe, rng = load_recipe(RECIPE), np.random.default_rng(1)
    low, high = (
        np.array([getattr(p, of) for p in recipe.parameters]) for of in ("minimum", "maximum")
    )
    params = low + rng.random((200, 2)) * (high - low)
    down = np.stack([*rng.uniform(-0.5, 0.5, (2, 200)), -np.ones(200)], axis=1)
    down /= np.linalg.norm(down, axis=1, keepdims=True)
    way = np.stack([*rng.normal(size=(2, 200)), np.zeros(200)], axis=1)
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    found = budgets(recipe, params, down, way)

    def tips(acceleration):
        felt = down - way * (acceleration / 9.80665)[:, None]
        return np.asarray(evaluate_each(recipe, params, felt, ("tip_angle",))["tip_angle"] < 0.0)

    stands = ~tips(np.zeros(200))
    limited = stands & (found < 49.0)
    assert limited.sum() > 100
    assert not tips(found)[stands].any()
    assert tips(1.001 * found + 1e-3)[limited].all()
    assert (found[~stands] == 0.0).all()
    assert turn_speed(8.0, 2.0) == pytest.approx(4.0)


def test_stops_are_told_by_heading_for_recipes_that_have_metres(tmp_path):
    table = tmp_path / "stops.csv"
    more = ("--slope", "0:10:10", "--headings", 4, "--force", "-o", table)
    low, high = (
        budget("maps/excavator.toml", *more, "--bump", bump)["budgets"] for bump in (0.05, 0)
    )
    assert list(high[0]["stop_speeds_m_s"]) == ["0", "90", "180", "270"]
    for one, other in zip(low, high, strict=True):
        assert (
            one["stop_speed_m_s"] < other["stop_speed_m_s"] < min(other["stop_speeds_m_s"].values())
        )
    rows = list(csv.DictReader(table.read_text().splitlines()))
    assert float(rows[1]["stop_at_90_deg_m_s"]) == high[1]["stop_speeds_m_s"]["90"]
    assert budget(RECIPE)["budgets"][0]["stop_speed_m_s"] is None


def test_what_means_nothing_is_refused(firmware):
    for option, value in (("--noise", "-1"), ("--speed", "0"), ("--rate", "alpha=0")):
        result = commands.run("control", firmware, option, value)
        assert (result.exit_code, option in result.stderr) == (2, True)


def test_an_export_with_a_damaged_policy_is_refused(firmware, tmp_path):
    folder = tmp_path / "damaged"
    shutil.copytree(firmware, folder)
    path = folder / "paper_two_report.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"policy": {"blob": "AAAA"}}))
    result = commands.run("control", folder)
    assert (result.exit_code, "damaged" in result.stderr) == (2, True)

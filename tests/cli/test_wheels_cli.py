"""`lutgen wheels`: what it prints, and its exit codes."""

import json
import math
import re
from pathlib import Path

import pytest

import lutgen
from lutgen.analysis import Posture, wheel_speeds
from tests.fixtures.commands import data, good, run
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import feet, rigid

CART = feet([(0.1, 0.25, -0.2), (0.1, -0.25, -0.2), (-0.4, 0.0, -0.2), (0.0, 0.0, -0.1)])
AXLE = "axis = [0, 1, 0]\nradius = 0.1\n"
WHEELS = "".join(f'[[robot.wheel]]\ncontact = "{name}"\n{AXLE}' for name in ("P1", "P2", "P4"))


@pytest.fixture
def cart(tmp_path: Path) -> Path:
    """Return the recipe of a differential drive with a wheel in the air."""
    path = tmp_path / "cart.toml"
    path.write_text(rigid(CART + WHEELS, name="cart"))
    return path


# The com is 0.1 behind the axle: at 57.295779513 deg/s it moves 0.1 to the right.
POSSIBLE = ("--velocity", "0.5,-0.1", "--yaw-rate", 57.29577951308232)
IMPOSSIBLE = ("--velocity", "0.5,0", "--yaw-rate", 57.29577951308232)


def test_speeds_are_printed_per_wheel(cart: Path) -> None:
    result = good("wheels", cart, *POSSIBLE)
    assert result.stderr == ""
    head, columns, *rows = result.stdout.splitlines()
    assert head == "cart: 2 DoF, non-steered (degree of mobility 2, of steerability 0)"
    assert columns.split("  ")[0] == "wheel"
    assert columns.endswith("slip m/s")
    assert [row.split() for row in rows] == [
        ["P1", "2.5", "-", "0"],
        ["P2", "7.5", "-", "0"],
        ["P4", "lifted"],
    ]


def test_json_has_the_same_numbers_with_their_units(cart: Path) -> None:
    report = data("wheels", cart, *POSSIBLE)
    assert report["structure"] == {
        "category": "2 DoF, non-steered",
        "dof": 2,
        "steered": False,
        "degree_of_mobility": 2,
        "degree_of_steerability": 0,
    }
    first, _, lifted = report["wheels"]  # type: ignore[misc]
    assert first["speed_rad_s"] == pytest.approx(2.5)
    assert (first["contact"], first["touches"], first["steering_deg"]) == ("P1", True, None)
    empty = {"touches": False, "speed_rad_s": None, "steering_deg": None, "slip": None}
    assert lifted == {"contact": "P4", **empty}
    assert report["possible"] is True
    assert report["nearest"]["velocity"] == report["velocity"] == [0.5, -0.1]  # type: ignore[index]
    assert report["yaw_rate_deg_s"] == pytest.approx(57.29577951308232)


def test_an_impossible_motion_is_printed_in_full_and_exits_with_1(cart: Path) -> None:
    result = run("wheels", cart, *IMPOSSIBLE)
    assert result.exit_code == 1
    rows = result.stdout.splitlines()
    assert rows[2].split() == ["P1", "2.5", "-", "0.1"]
    assert rows[5].startswith("impossible: the wheels slip sideways by 0.141421 m/s in all")
    as_json = run("wheels", cart, *IMPOSSIBLE, "--json")
    assert as_json.exit_code == 1
    report = json.loads(as_json.stdout)
    assert report["possible"] is False
    assert report["slip"] == pytest.approx(0.1 * math.sqrt(2.0))
    exact = wheel_speeds(Posture(lutgen.load_recipe(cart), []), (0.5, 0.0), 1.0)
    assert report["nearest"]["velocity"] == pytest.approx(exact.nearest_velocity)


def test_the_nearest_motion_can_be_asked_for_as_it_is_printed(cart: Path) -> None:
    printed = run("wheels", cart, *IMPOSSIBLE).stdout
    found = re.search(r"^nearest possible: velocity (\S+) m/s, yaw rate (\S+) deg/s", printed, re.M)
    assert found is not None
    good("wheels", cart, "--velocity", found[1], "--yaw-rate", found[2])


def test_steering_is_printed_in_degrees_and_negative_velocities_are_read(tmp_path: Path) -> None:
    path = tmp_path / "steered.toml"
    wheel = f'[[robot.wheel]]\ncontact = "P1"\nsteered = true\n{AXLE}'
    path.write_text(rigid(CART + wheel, name="steered"))
    report = data("wheels", path, "--velocity", "-1,1")
    (one,) = report["wheels"]  # type: ignore[misc]
    assert one["steering_deg"] == pytest.approx(-45.0)
    assert one["speed_rad_s"] == pytest.approx(-10.0 * math.sqrt(2.0))
    assert "P1        -14.1421           -45" in good("wheels", path, "--velocity", "-1,1").stdout


def test_parameters_and_gravity_choose_the_posture_and_its_ground() -> None:
    recipe = MAPS / "paper_two.toml"
    report = data(
        *("wheels", recipe, "-p", "alpha=10", "-p", "gamma=40"),
        *("-g", "0.1,0,-1", "--velocity", "2,1", "--yaw-rate", "-30"),
    )
    exact = wheel_speeds(
        Posture(lutgen.load_recipe(recipe), [math.radians(10.0), math.radians(40.0)]),
        (2.0, 1.0),
        math.radians(-30.0),
        (0.1, 0.0, -1.0),
    )
    speeds = [wheel["speed_rad_s"] for wheel in report["wheels"]]  # type: ignore[attr-defined]
    assert speeds == pytest.approx([wheel.speed for wheel in exact.wheels])
    # What -p leaves out is at home, or in the middle of its range, and the answer says so.
    middle = run("wheels", recipe, "-p", "alpha=10")
    assert "gamma = 25 deg (middle of the range: gamma)" in middle.stdout
    whole = run("wheels", recipe, "-p", "alpha=10", "-p", "gamma=25").stdout
    assert [
        line for line in middle.stdout.splitlines() if "middle" not in line
    ] == whole.splitlines()


def test_without_a_motion_the_wheels_rest(cart: Path) -> None:
    report = data("wheels", cart)
    assert report["possible"] is True
    assert [w["speed_rad_s"] for w in report["wheels"]] == [0.0, 0.0, None]  # type: ignore[attr-defined]


def test_a_robot_that_tips_is_computed_with_a_warning(
    cart: Path, caplog: pytest.LogCaptureFixture
) -> None:
    report = data("wheels", cart, *POSSIBLE, "-g", "3,0,-1", code=3)
    assert report["standing"] is False
    assert "the robot tips over" in caplog.text

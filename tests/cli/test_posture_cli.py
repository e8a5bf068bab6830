"""`lutgen limits`, `wheels` and `stance`: what they print, in which units, and their exit codes."""

import math
import re
from decimal import Decimal

import pytest

import lutgen
from lutgen.analysis import Posture, posture_limits, wheel_speeds
from tests.analysis import test_rolling
from tests.cli.test_refusals_cli import DITCH
from tests.fixtures.commands import data, run, stdout
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import feet, rigid, tripod


def test_what_tips_on_level_ground_is_said_in_words(tmp_path):
    path = tmp_path / "aside.toml"
    path.write_text(rigid(feet([(1, 1, -1), (0.5, 1, -1), (0.5, -1, -1), (1, -1, -1)])))
    result = run("limits", path, "--all")
    text = result.stdout
    assert result.exit_code == 3
    assert "it tips over on level ground" in text
    assert "over 1 postures" in text
    assert "1 tip over on level ground" in text
    report = data("limits", path, code=3)
    assert report["limits"][-1]["heading_deg"] is None
    assert report["guaranteed_tilt_deg"] == 0.0
    assert report["limits"][0]["slides_first"] is None


def test_every_limit_is_printed_rounded_down(tripod_path):
    text, report = stdout("limits", tripod_path), data("limits", tripod_path)
    for name in ("body", "ground"):
        (said,) = re.findall(rf"guaranteed {name} tilt in every heading: ([\d.]+) deg", text)
        assert 0.0 <= report[f"guaranteed_{name}_tilt_deg"] - float(said) < 0.01
    for row in report["limits"][:4]:
        (line,) = (line for line in text.splitlines() if line.startswith(row["name"]))
        said = [float(number) for number in re.findall(r"([\d.]+) deg", line)]
        for value, key in zip(said, ("tilt_deg", "ground_tilt_deg"), strict=True):
            assert 0.0 <= row[key] - value < 0.01
    # JSON, too, has nothing above the library's own numbers.
    posture = posture_limits(Posture(lutgen.parse_recipe(tripod()), [0.3, math.radians(5.0)]))
    for key, value in (
        ("guaranteed_tilt_deg", posture.guaranteed),
        ("guaranteed_body_tilt_deg", posture.guaranteed),
        ("guaranteed_ground_tilt_deg", posture.guaranteed_ground),
        ("guaranteed_ground_tip_deg", posture.ground.guaranteed),
        ("worst_ground_tilt_deg", posture.ground.least),
    ):
        # Rounded down at the tenth decimal.
        assert 0.0 <= Decimal(math.degrees(value)) - Decimal(report[key]) < Decimal("1.01e-10")


def test_wheels_that_roll_are_said_not_to_be_in_what_is_guaranteed(tmp_path):
    path = tmp_path / "cart.toml"
    path.write_text(test_rolling.cart(test_rolling.FRONT, 0.5))
    assert data("limits", path)["ground_rolling_included"] is False
    assert "26.56 deg (sliding included, rolling not; tipping over alone" in stdout("limits", path)
    assert data("limits", MAPS / "articulated.toml")["ground_rolling_included"] is None


CART = feet([(0.1, 0.25, -0.2), (0.1, -0.25, -0.2), (-0.4, 0.0, -0.2), (0.0, 0.0, -0.1)])
AXLE = "axis = [0, 1, 0]\nradius = 0.1\n"
WHEELS = "".join(f'[[robot.wheel]]\ncontact = "{name}"\n{AXLE}' for name in ("P1", "P2", "P4"))
# The com is 0.1 behind the axle: at 57.295779513 deg/s it moves 0.1 to the right.
POSSIBLE = ("--velocity", "0.5,-0.1", "--yaw-rate", 57.29577951308232)


def test_a_wheel_in_the_air_has_no_speed_and_a_robot_that_tips_is_said_to(tmp_path, caplog):
    cart = tmp_path / "cart.toml"
    cart.write_text(rigid(CART + WHEELS, name="cart"))
    report = data("wheels", cart, *POSSIBLE)
    first, second, lifted = report["wheels"]
    # (v -+ w b) / r = (0.5 -+ 0.25) / 0.1
    assert [first["speed_rad_s"], second["speed_rad_s"]] == pytest.approx([2.5, 7.5])
    empty = {"touches": False, "speed_rad_s": None, "steering_deg": None, "slip": None}
    assert lifted == {"contact": "P4", **empty}
    assert report["nearest"]["velocity"] == report["velocity"] == [0.5, -0.1]
    assert caplog.text == ""
    assert data("wheels", cart, *POSSIBLE, "-g", "3,0,-1", code=3)["standing"] is False
    assert "the robot tips over" in caplog.text


def test_parameters_and_gravity_choose_the_posture_and_its_ground():
    recipe = MAPS / "paper_two.toml"
    report = data(
        *("wheels", recipe, "-p", "alpha=10", "-p", "gamma=40"),
        *("-g", "0.1,0,-1", "--velocity", "2,1", "--yaw-rate", "-30"),
    )
    posture = Posture(lutgen.load_recipe(recipe), [math.radians(10.0), math.radians(40.0)])
    exact = wheel_speeds(posture, (2.0, 1.0), math.radians(-30.0), (0.1, 0.0, -1.0))
    speeds = [wheel["speed_rad_s"] for wheel in report["wheels"]]
    assert speeds == pytest.approx([wheel.speed for wheel in exact.wheels])


@pytest.fixture
def ditch(tmp_path):
    path = tmp_path / "ditch.toml"
    path.write_text(DITCH)
    return path


@pytest.mark.parametrize(
    ("x", "said", "holds"),
    [
        ("0.8", "holds", True),
        ("0.9", "does not hold", False),
        ("0.80001", "undecided, at the limit of friction", None),
    ],
)
def test_the_exit_code_is_3_unless_it_holds(ditch, x, said, holds):
    ditch.write_text(DITCH.replace("com = [0.3", f"com = [{x}"))
    assert run("stance", ditch).stdout.splitlines()[0] == f"ditch: {said}"
    report = data("stance", ditch, code=0 if holds else 3)
    assert report["holds"] is holds
    assert (report["feet"][0]["force"] is None) is (holds is not True)


def test_gravity_comes_from_the_option_the_file_or_is_down(ditch):
    level, steep = data("stance", ditch), data("stance", ditch, "-g", "0.3,0,-1")
    assert data("stance", ditch, "-g", "0,0,-9.81")["region"] == level["region"]
    length = math.hypot(1, 0.3)
    assert steep["axes"][0] == pytest.approx([1.0 / length, 0.0, 0.3 / length])
    ditch.write_text(f"gravity = [0.6, 0, -2]\n{DITCH}")
    assert data("stance", ditch)["region"] == [
        pytest.approx(corner, abs=1e-6) for corner in steep["region"]
    ]
    assert data("stance", ditch, "-g", "0,0,-1")["region"] == level["region"]
    # Without a normal a foot stands against gravity, also in a turned frame.
    ditch.write_text(
        "com = [-1, 0.5, 0]\ngravity = [2, 0, 0]\nfriction = 0\n"
        "[[foot]]\nposition = [0, 0, 0]\n[[foot]]\nposition = [0.2, 1, 0]\n"
    )
    report = data("stance", ditch)
    assert report["axes"] == [[0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]
    assert [foot["normal_force"] for foot in report["feet"]] == pytest.approx([0.5, 0.5])
    assert [foot["friction_used"] for foot in report["feet"]] == [0.0, 0.0]


def test_a_weight_that_nothing_can_hold_has_no_region(ditch):
    text = DITCH.replace("friction = 0.5", "friction = 0").replace("[-1, 0, 1]", "[1, 0, 1]")
    ditch.write_text(text)
    said = run("stance", ditch).stdout
    assert re.search(r"^margin +-$", said, re.M)
    assert re.search(r"^region +none$", said, re.M)
    report = data("stance", ditch, code=3)
    assert (report["margin"], report["region"]) == (None, [])

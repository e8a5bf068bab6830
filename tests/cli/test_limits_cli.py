"""`lutgen limits` and its page: what it prints and draws, and how it refuses."""

import math
import re
from decimal import Decimal
from functools import partial

import numpy as np
import pytest

from lutgen.analysis.posture import Posture
from lutgen.analysis.tilt_table import posture_limits, sweep_limits
from lutgen.recipe.recipe import parse_recipe
from tests.fixtures import commands
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import contact, feet, rigid, tripod

run = partial(commands.run, "limits")
good = partial(commands.stdout, "limits")
data = partial(commands.data, "limits")


def test_json_has_the_numbers_of_the_library_and_angles_say_their_unit(tripod_path):
    robot = parse_recipe(tripod())
    report = data(tripod_path, "-p", "reach=0.2", "--all", "--best", "--headings", 8)
    assert report["posture"] == {"reach_m": 0.2, "swing_deg": pytest.approx(5.0)}
    posture = np.array([0.2, math.radians(5.0)])
    found = posture_limits(Posture(robot, posture))
    assert [row["tilt_deg"] for row in report["limits"]] == [
        pytest.approx(math.degrees(row.tilt)) for row in found.headings
    ]
    rows = robot.grid.params(np.arange(robot.grid.size))
    headings = np.radians(np.arange(8) * 45.0)
    swept = sweep_limits(robot, rows, headings)
    best = report["best_postures"]
    assert [row["heading_deg"] for row in best] == pytest.approx(np.degrees(headings))
    assert [row["tilt_deg"] for row in best] == pytest.approx(np.degrees(swept.most))
    assert best[3]["posture"]["reach_m"] == pytest.approx(rows[swept.most_at[3], 0])
    every = report["all_postures"]
    assert every["postures"] == 12
    for name, place in (("nose down", 0), ("left side down", 2), ("right side down", 6)):
        (row,) = (row for row in every["limits"] if row["name"] == name)
        assert row["least_tilt_deg"] == pytest.approx(np.degrees(swept.least[place]))
        assert row["largest_tilt_deg"] == pytest.approx(np.degrees(swept.most[place]))
    worst = every["limits"][-1]
    assert worst["name"] == "worst heading"
    assert worst["least_tilt_deg"] == pytest.approx(np.degrees(swept.guaranteed.min()))
    assert worst["largest_at"]["swing_deg"] == pytest.approx(
        np.degrees(rows[swept.guaranteed.argmax(), 1])
    )
    angles = {key for key in commands.keys(report) if re.search("tilt|heading|angle|swing", key)}
    assert all(key.endswith("_deg") for key in angles)
    assert len(angles) >= 6


def test_without_the_options_there_is_one_posture_in_the_middle(tripod_path):
    report = data(tripod_path)
    assert report["posture"] == {"reach_m": 0.3, "swing_deg": pytest.approx(5.0)}
    assert not {"all_postures", "best_postures"} & set(report)
    assert report["convention"] == "plane"
    body = data(tripod_path, "--convention", "body")
    assert body["limits"][0]["tilt_deg"] != pytest.approx(report["limits"][0]["tilt_deg"])


def test_what_tips_on_level_ground_is_said_in_words(tmp_path):
    path = tmp_path / "aside.toml"
    path.write_text(rigid(feet([(1, 1, -1), (0.5, 1, -1), (0.5, -1, -1), (1, -1, -1)])))
    result = commands.run("limits", path, "--all")
    text = result.stdout
    assert result.exit_code == 3
    assert "it tips over on level ground" in text
    assert "over 1 postures" in text
    assert "1 tip over on level ground" in text
    report = data(path, code=3)
    assert report["limits"][-1]["heading_deg"] is None
    assert report["guaranteed_tilt_deg"] == 0.0
    assert report["limits"][0]["slides_first"] is None


def test_every_limit_is_printed_rounded_down(tripod_path):
    text, report = good(tripod_path), data(tripod_path)
    for name in ("body", "ground"):
        (said,) = re.findall(rf"guaranteed {name} tilt in every heading: ([\d.]+) deg", text)
        assert 0.0 <= report[f"guaranteed_{name}_tilt_deg"] - float(said) < 0.01
    for row in report["limits"][:4]:
        (line,) = (line for line in text.splitlines() if line.startswith(row["name"]))
        said = [float(number) for number in re.findall(r"([\d.]+) deg", line)]
        for value, key in zip(said, ("tilt_deg", "ground_tilt_deg"), strict=True):
            assert 0.0 <= row[key] - value < 0.01
    # JSON, too, has nothing above the library's own numbers.
    posture = posture_limits(Posture(parse_recipe(tripod()), [0.3, math.radians(5.0)]))
    for key, value in (
        ("guaranteed_tilt_deg", posture.guaranteed),
        ("guaranteed_body_tilt_deg", posture.guaranteed),
        ("guaranteed_ground_tilt_deg", posture.guaranteed_ground),
        ("guaranteed_ground_tip_deg", posture.ground.guaranteed),
        ("worst_ground_tilt_deg", posture.ground.least),
    ):
        # Rounded down at the tenth decimal.
        assert 0.0 <= Decimal(math.degrees(value)) - Decimal(report[key]) < Decimal("1.01e-10")


def test_body_tilt_and_ground_tilt_are_two_numbers_and_say_whether_sliding_is_in_them():
    # Bent so little that it rocks on the left and is caught there.
    robot = (MAPS / "articulated.toml", "-p", "steer=10", "-p", "roll=5")
    report, text = data(*robot), good(*robot)
    rows = {row["name"]: row for row in report["limits"]}
    assert rows["left side down"]["tilt_deg"] > rows["left side down"]["ground_tilt_deg"] + 5.0
    assert rows["right side down"]["ground_contacts"] == ["front_right", "rear_right"]
    # It slides (friction 0.7) before it would tip over in the worst heading.
    assert report["ground_sliding_included"] is True
    assert report["guaranteed_ground_tilt_deg"] == pytest.approx(math.degrees(math.atan(0.7)))
    assert (
        45.0 < report["guaranteed_ground_tip_deg"] < report["worst_ground_tilt_deg"] + 1e-9 < 46.0
    )
    assert report["guaranteed_body_tilt_deg"] > report["guaranteed_ground_tip_deg"] + 0.01
    assert (
        "ground tilt in every heading: 34.99 deg (sliding included; tipping over alone 45.2" in text
    )
    assert "body tilt in every heading: 45.26 deg (tipping over; sliding not included)" in text
    assert "worst on the ground, 97.4 deg" in text
    without = good(MAPS / "paper_two.toml")
    assert without.splitlines()[-1].endswith("sliding not included, friction is not known)")


def test_wheels_that_roll_are_said_not_to_be_in_what_is_guaranteed(tmp_path):
    path = tmp_path / "cart.toml"
    wheels = [
        contact(f"w{i}", (x, y, -0.4), 0.1, (0.0, 1.0, 0.0)) + ("rolling = true\n" * (x > 0))
        for i, (x, y) in enumerate([(0.5, 0.4), (0.5, -0.4), (-0.5, 0.4), (-0.5, -0.4)])
    ]
    path.write_text(rigid("".join(wheels), head="friction = 0.5"))
    assert data(path)["ground_rolling_included"] is False
    assert "26.56 deg (sliding included, rolling not; tipping over alone" in good(path)
    assert data(MAPS / "articulated.toml")["ground_rolling_included"] is None

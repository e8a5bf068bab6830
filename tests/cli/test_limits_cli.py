"""`lutgen limits` and its page: what it prints and draws, and how it refuses."""

import math
import re
from decimal import Decimal
from functools import partial

from lutgen.analysis.posture import Posture
from lutgen.analysis.tilt_table import posture_limits
from lutgen.recipe.recipe import parse_recipe
from tests.fixtures import commands
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import contact, feet, rigid, tripod

run = partial(commands.run, "limits")
good = partial(commands.stdout, "limits")
data = partial(commands.data, "limits")


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

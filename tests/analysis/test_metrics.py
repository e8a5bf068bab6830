"""Five metrics side by side: the numbers, `lutgen metrics`, the figure and its page."""

import math

import pytest

import lutgen
from lutgen.analysis.metrics import METRICS, compare_metrics
from lutgen.analysis.posture import Posture
from lutgen.analysis.tilt import tilted
from lutgen.errors import InputError
from tests.fixtures.commands import data
from tests.fixtures.pulled import BOX, LEVEL, pull, robot
from tests.fixtures.recipes import feet, rigid

# 2 long, 1.2 wide, 1 high, its com a little off the centre.
TABLE = rigid(feet([(1, 0.6, -1), (-1, 0.6, -1), (-1, -0.6, -1), (1, -0.6, -1)]), name="table")


@pytest.fixture(scope="module")
def table():
    """Return the table."""
    return lutgen.parse_recipe(TABLE)


def test_each_is_divided_by_its_value_on_level_ground(table):
    found = compare_metrics(Posture(table, []), tilted(math.radians(20.0), [math.pi / 2.0]))
    level = math.atan(0.6)
    # To the left, across a level axis 0.6 away and 1 below.
    arm = math.hypot(1.0, 0.6)
    left = level - math.radians(20.0)
    expected = {
        "tip_angle": left / level,
        "margin": math.sin(left) * arm / 0.6,
        "energy_margin": arm * (1.0 - math.cos(left)) / (arm - 1.0),
        "force_angle": left * math.sin(left) * arm / (level * 0.6),
        # D_g has moved by tan 20 deg of the 0.6 to the nearest side.
        "sdg": 1.0 - math.tan(math.radians(20.0)) / 0.6,
    }
    assert list(found.normalised) == list(METRICS)
    for name, value in expected.items():
        assert found.normalised[name] == pytest.approx([value], abs=1e-12), name
    assert found.level["force_angle"] == pytest.approx(level * 0.6, abs=1e-12)
    # In units again they are the channels, and the measure is the product of two of them.
    down = tilted(math.radians(20.0), [math.pi / 2.0])
    exact = lutgen.evaluate(table, [[]], down, ("sdg", "tip_angle", "margin", "energy_margin"))
    for name, values in exact.items():
        assert found.values[name] == pytest.approx(values[0])
    product = exact["tip_angle"][0] * exact["margin"][0]
    assert found.values["force_angle"] == pytest.approx(product, abs=1e-14)


def test_what_does_not_stand_on_level_ground_or_knows_more_than_a_weight_is_refused():
    for one, said in (
        (
            lutgen.parse_recipe(rigid(feet([(1, 0, -1), (3, 1, -1), (3, -1, -1)]))),
            r"does not stand or cannot tip \(got a tip angle of -24.1 deg",
        ),
        (robot(feet(BOX), pull((5, 0, 0))), "counts the weight and no other force"),
        (robot(feet(BOX), rho=0.01), "metrics are those of one com"),
    ):
        with pytest.raises(InputError, match=said):
            compare_metrics(Posture(one, []), LEVEL)


# The command


def test_json_has_null_for_no_value(tmp_path):
    file = tmp_path / "table.toml"
    file.write_text(TABLE)
    report = data("metrics", file, "--tilt", 33, "--headings", 4)
    assert report["level"]["tip_angle_deg"] == pytest.approx(math.degrees(math.atan(0.6)))
    left = report["headings"][1]
    assert (left["heading_deg"], left["standing"]) == (90.0, False)
    assert left["sdg"] is left["normalised"]["sdg"] is None
    assert left["tip_angle_deg"] == pytest.approx(math.degrees(math.atan(0.6)) - 33.0)
    assert left["force_angle_rad"] < 0.0
    axes = data("eval", file)["axes"]
    side, end = 0.6 * math.atan(0.6), math.atan(1.0)
    found = sorted(axis["force_angle_rad"] for axis in axes)
    assert found == pytest.approx([side, side, end, end], abs=1e-12)

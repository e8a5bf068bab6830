"""Angles that descriptions print with few digits stand for parts of a turn."""

import math

import pytest

from lutgen.propose import import_urdf
from lutgen.urdf.read import parse_urdf
from lutgen.urdf.xml import meant
from tests.fixtures.robots import collision, joint, link, robot

QUARTER = math.pi / 2.0


@pytest.mark.parametrize(
    ("text", "angle"),
    [
        *((text, QUARTER) for text in ("1.57", "1.570", "1.571", "1.5707", "1.5708", "1.57079")),
        *((text, QUARTER) for text in ("1.5707963705062866", "+1.57", "1.570796326795e+00")),
        *((text, -math.pi) for text in ("-3.14", "-3.142", "-3.14159265359")),
        *((text, QUARTER / 2.0) for text in ("0.785", ".785398")),
        ("6.2832", 2.0 * math.pi),
        ("2.356", 1.5 * QUARTER),
        ("0.5236", math.pi / 6.0),
        ("1.0472", math.pi / 3.0),
    ],
)
def test_a_part_of_a_turn_is_known_by_its_digits(text, angle):
    assert meant(text) == pytest.approx(angle, abs=1e-15)


@pytest.mark.parametrize(
    "text",
    [
        *("0", "-0.0", "1.6", "1.5", "1.58", "1.5700001", "1.572", "1.5709", "1.569", "0.78"),
        *("0.786", "0.524", "0.26", "3.1", "3.15", "1e-4", "1.57e0", "9.42", "12.57", "-0.00001"),
    ],
)
def test_any_other_angle_is_what_it_says(text):
    assert meant(text) == float(text)


def car(quarter):
    """Return the URDF of a car on four cylinders whose axles are turned by a quarter."""
    parts = [link("base", 9.0)]
    for k, (x, y) in enumerate((x, y) for x in (-0.2, 0.2) for y in (-0.2, 0.2)):
        turn = f"-{quarter}" if y > 0.0 else quarter
        wheel = collision('cylinder radius="0.1" length="0.04"')
        axle, place = '<axis xyz="0 0 1"/>', (f"{x} {y} -0.1", f"{turn} 0 0")
        parts.append(link(f"wheel{k}", 1.0, inside=wheel))
        parts.append(joint(f"axle{k}", "continuous", "base", f"wheel{k}", axle, *place))
    return robot(*parts, name="car")


def test_wheels_whose_quarter_turns_lack_digits_make_the_same_recipe_and_it_is_said():
    exact = import_urdf(parse_urdf(car(repr(QUARTER)), "car.urdf"))
    for quarter in ("1.57", "1.5708", "1.5707"):
        short = import_urdf(parse_urdf(car(quarter), "car.urdf"))
        assert short.text == exact.text
        said = "how far printed angles are off the parts of a turn that they stand for"
        more = [line for line in short.left_out if line not in exact.left_out]
        assert more == [f"{said}: {quarter}, -{quarter}"]

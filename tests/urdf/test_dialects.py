"""What else than plain URDF 1.0 a description may have: read, refused or named, never dropped."""

import math
import re

import numpy as np
import pytest

from lutgen.analysis import Posture, posture_limits, tilt_limits
from lutgen.errors import RecipeError
from lutgen.propose import import_urdf
from lutgen.urdf.joints import read_motion, soft_limited
from lutgen.urdf.links import centre_of_mass, places
from lutgen.urdf.read import FORMAT, parse_urdf
from lutgen.urdf.xml import meant
from tests.fixtures.drawn_robots import imported_car
from tests.fixtures.places import ROOT
from tests.fixtures.robots import collision, joint, link, robot

BALL = 'sphere radius="0.05"'
CORNERS = [f"{x} {y} -0.2" for x in (0.3, -0.3) for y in (0.2, -0.2)]
FEET = "".join(collision(BALL, place) for place in CORNERS)
ARM = link("base", 10.0, "0 0 0", FEET) + link("arm", 5.0, "0.3 0 0")
RPY, QUAT = 'rpy="0 -1.5707963267948966 0"', 'quat_xyzw="0 -3 0 3"'
SHOULDER = joint("sh", "fixed", "base", "arm", "", "0 0 0.1", "0 -1.5707963267948966 0")


def test_a_quaternion_turns_as_the_angles_do():
    for turn in (RPY, 'quat_xyzw="0 -0.7071067811865476 0 0.7071067811865476"', QUAT):
        one = parse_urdf(robot(ARM, SHOULDER.replace(RPY, turn)))
        com = centre_of_mass(one, places(one, read_motion(one)))
        # By hand: the arm's 5 kg are 0.3 m above its joint at 0.1 m, of 15 kg.
        assert com.tolist() == pytest.approx([0.0, 0.0, 2.0 / 15.0])


def test_whatever_the_format_does_not_have_is_named():
    odd = "<origin xyz='1 0 0'/><extra/><extra/>"
    text = robot(ARM.replace('<link name="arm">', f'<link name="arm">{odd}'), SHOULDER)
    text = text.replace("<sphere", '<sphere rpy="1 0 0"', 1)
    left = import_urdf(parse_urdf(text)).left_out
    assert left[-1] == (
        "elements and attributes that are not understood: 1 rpy of <sphere>, 1 <origin> in "
        "<link>, 2 <extra> in <link>"
    )
    # What the format has is silent.
    told = '<inertia ixx="1"/></inertial><visual><material name="x"/></visual>'
    known = robot(ARM.replace("</inertial>", told), SHOULDER)
    assert import_urdf(parse_urdf(known)).left_out == ()


def guaranteed(text):
    """Return the tilt (deg) up to which a robot of that description does not tip."""
    recipe = import_urdf(parse_urdf(text)).recipe
    limits = posture_limits(Posture(recipe, np.array(recipe.home_params)))
    return math.degrees(limits.guaranteed)


CAPSULE = 'capsule radius="0.05" length="0.1"'
SMALL = "".join(
    collision('sphere radius="0.02"', f"{x} {y} -0.1") for x in (0.1, -0.1) for y in (0.1, -0.1)
)
PLACES = [f"{x} {y} -0.25" for x in (0.3, -0.3) for y in (0.2, -0.2)]


def on_feet(shape, xyz):
    """Return a body with small balls below it and a shape on each of four feet."""
    feet = "".join(link(f"f{i}", 0.5, inside=collision(shape, xyz)) for i in range(4))
    fixed = (joint(f"k{i}", "fixed", "base", f"f{i}", xyz=place) for i, place in enumerate(PLACES))
    return robot(link("base", 10.0, inside=SMALL), feet, *fixed)


def test_a_capsule_stands_on_the_balls_at_its_ends():
    told = guaranteed(on_feet(CAPSULE, "0 0 0"))
    assert told == pytest.approx(guaranteed(on_feet(BALL, "0 0 -0.05")))
    assert told == pytest.approx(32.97, abs=0.01)
    feet = "".join(collision(CAPSULE, place) for place in PLACES)
    assert guaranteed(robot(link("base", 10.0, inside=SMALL + feet))) == pytest.approx(29.74, 1e-3)


def test_an_unknown_shape_that_is_lowest_and_a_description_without_mass_are_refused():
    with pytest.raises(RecipeError, match="a shape of kind 'torus' is not understood"):
        import_urdf(parse_urdf(on_feet("torus", "0 0 -0.05")))
    with pytest.raises(RecipeError, match="no link has a mass"):
        import_urdf(parse_urdf(robot(link("base", inside=FEET))))


def warned(text):
    return list(import_urdf(parse_urdf(text)).warnings)


LIMIT = '<axis xyz="0 0 1"/><limit lower="{}" upper="{}"/>'


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (robot(ARM, SHOULDER), None),
        (robot(ARM, SHOULDER.replace("-1.57079", "-90.")), "joint 'sh': rpy is in rad"),
        (robot(ARM, joint("t", "revolute", "base", "arm", LIMIT.format(-90, 9))), "joint 't': lim"),
        (robot(ARM, joint("t", "revolute", "base", "arm", LIMIT.format(-10, 10))), None),
        (robot(ARM.replace("0.05", "200"), SHOULDER), "link 'base': its shapes reach 200 m"),
        (robot(ARM.replace('xyz="0 0 0"', 'xyz="0 0 9"'), SHOULDER), "link 'base': its centre of"),
    ],
)
def test_what_looks_like_a_mistake_is_a_warning_that_names_it(text, said):
    found = warned(text)
    assert [words[: len(said or "")] for words in found] == ([said] if said else [])


def tractor(effort):
    """Return a tractor whose front axle turns about a pivot 0.5 m above the ground."""
    ball = 'sphere radius="0.05"'
    rear = "".join(collision(ball, f"0 {y} 0.05") for y in (0.8, -0.8))
    front = "".join(collision(ball, f"0 {y} -0.45") for y in (0.8, -0.8))
    hinge = f'<axis xyz="1 0 0"/><limit lower="-0.2" upper="0.2" effort="{effort}"/>'
    pivot = joint("pivot", "revolute", "chassis", "axle", hinge, "2.3 0 0.5")
    return robot(link("chassis", 3000.0, "0.8 0 0.9", rear), link("axle", inside=front), pivot)


def test_an_axle_whose_joint_has_no_effort_swings_and_is_no_parameter():
    driven = import_urdf(parse_urdf(tractor(100.0)))
    assert (driven.recipe.axles, driven.warnings) == ((), ())
    assert [one.name for one in driven.recipe.parameters] == ["pivot"]
    found = import_urdf(parse_urdf(tractor(0.0)))
    (axle,), recipe = found.recipe.axles, found.recipe
    assert (axle.link, axle.pivot, axle.axis) == ("body", (2.3, 0.0, 0.5), (1.0, 0.0, 0.0))
    assert math.degrees(axle.stops or 0.0) == pytest.approx(math.degrees(0.2))
    assert (recipe.parameters, found.warnings) == ((), ())
    assert any("'pivot' swings freely" in words for words in found.guessed)
    limit = tilt_limits(recipe, np.empty((1, 0)), np.array([0.5 * math.pi]), "body")
    # By hand: the com is above the line from a rear wheel to the pivot up to atan(1.2 / 1.67).
    # The engine tips it at 37.0 deg with 1.3 to 1.6 deg of lag; with a rigid axle 41.6 are told.
    assert math.degrees(float(limit[0, 0])) == pytest.approx(35.7, abs=0.1)


def test_contacts_on_a_joint_without_effort_that_is_no_axle_are_a_warning():
    (words,) = warned(tractor(0.0).replace('axis xyz="1 0 0"', 'axis xyz="0 1 0"'))
    assert words.startswith("joint 'pivot': effort is 0")
    assert "[[robot.axle]]" in words


LOOKS = "".join(collision(BALL, place).replace("collision", "visual") for place in CORNERS)
SOLE = "".join(collision('box size="0.2 0.1 0.02"', f"0 {y} -0.9") for y in (0.1, -0.1))


@pytest.mark.parametrize(
    ("inside", "kinds", "guess"),
    [
        (LOOKS, 4 * ["sphere"], "base: a visual sphere, as there is no collision shape"),
        # The soles have 16 corners; 8 lie between others.
        (SOLE, 8 * ["point"], None),
        (SOLE.replace("collision", "visual"), 8 * ["point"], "base: a visual box, as there is no"),
        # Where it stands on balls, neither boxes nor looks count.
        (FEET + SOLE + LOOKS, 4 * ["sphere"], None),
    ],
)
def test_boxes_and_looks_are_stood_on_where_there_is_nothing_else(inside, kinds, guess):
    found = import_urdf(parse_urdf(robot(link("base", 9.0, "0 0 0", inside))))
    assert [contact.kind for contact in found.recipe.contacts] == kinds
    assert [words[: len(guess or "")] for words in found.guessed] == ([guess] if guess else [])


def test_boxes_below_all_balls_are_feet_where_they_hang_from_the_links_with_these():
    # Unitree's H1 has round shanks and flat soles; a vehicle's low box is drawn too large.
    for balls, soles, kinds in (("base", "arm", {"point"}), ("arm", "base", {"sphere"})):
        parts = {balls: FEET, soles: SOLE.replace("-0.9", "-2.9")}
        links = (link(name, 9.0, "0 0 0", inside) for name, inside in sorted(parts.items()))
        found = import_urdf(parse_urdf(robot(*links, joint("j", "fixed", "base", "arm"))))
        assert {contact.kind for contact in found.recipe.contacts} == kinds


def test_a_joint_without_limits_turns_all_the_way_and_is_named():
    endless = joint("lean", "revolute", "base", "arm", '<axis xyz="0 1 0"/>')
    found = import_urdf(parse_urdf(robot(ARM, endless)))
    assert [p.maximum for p in found.recipe.parameters] == [pytest.approx(math.pi)]
    assert "joints without limits, taken as -180 to 180 deg: lean" in found.left_out


SOFT = '<safety_controller soft_lower_limit="{}" soft_upper_limit="{}" k_velocity="1"/>'


@pytest.mark.parametrize(
    ("soft", "limits", "said"),
    [
        ((-0.3, 2.0), (-0.3, 1.0), True),
        ((-2.0, 2.0), (-0.5, 1.0), False),
        ((0, 0), (-0.5, 1.0), False),
    ],
)
def test_soft_limits_are_named_and_taken_when_asked_for(soft, limits, said):
    inside = LIMIT.format(-0.5, 1.0) + SOFT.format(*soft)
    described = parse_urdf(robot(ARM, joint("lean", "revolute", "base", "arm", inside)))
    left = import_urdf(described, joints=["lean"]).left_out
    assert any("--soft-limits): lean" in words for words in left) == said
    assert read_motion(soft_limited(described)).free == {"lean": limits}


def test_the_reference_has_every_element_and_attribute_that_is_understood():
    page = (ROOT / "docs/reference/urdf.md").read_text(encoding="utf-8")
    words = set(re.findall(r"`([a-z_]+)`", page))
    inertia = {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}
    assert {
        *FORMAT,
        *(word for part in FORMAT.values() for word in part.split()),
    } - inertia <= words


QUARTER = math.pi / 2.0
PARTS = {
    QUARTER: "1.57 1.570 1.571 1.5707 1.5708 1.57079 1.5707963705062866 +1.57 1.570796326795e+00",
    -math.pi: "-3.14 -3.142 -3.14159265359",
    QUARTER / 2.0: "0.785 .785398",
    2.0 * math.pi: "6.2832",
    1.5 * QUARTER: "2.356",
    math.pi / 6.0: "0.5236",
    math.pi / 3.0: "1.0472",
}
OTHERS = "0 -0.0 1.6 1.5 1.58 1.5700001 1.572 1.5709 1.569 0.78 0.786 0.524 0.26 3.1 3.15 1e-4 "
OTHERS += "1.57e0 9.42 12.57 -0.00001"


def test_a_part_of_a_turn_is_known_by_its_digits_and_any_other_angle_is_what_it_says():
    for angle, texts in PARTS.items():
        for text in texts.split():
            assert meant(text) == pytest.approx(angle, abs=1e-15), text
    assert [text for text in OTHERS.split() if meant(text) != float(text)] == []


def test_wheels_whose_quarter_turns_lack_digits_make_the_same_recipe_and_it_is_said():
    exact = imported_car(repr(QUARTER))
    for quarter in ("1.57", "1.5708", "1.5707"):
        short = imported_car(quarter)
        assert short.text == exact.text
        said = "how far printed angles are off the parts of a turn that they stand for"
        more = [line for line in short.left_out if line not in exact.left_out]
        assert more == [f"{said}: {quarter}, -{quarter}"]

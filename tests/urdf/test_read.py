"""Reading robot descriptions: what is read, and what is refused in one sentence."""

import math
import time

import pytest

from lutgen.errors import RecipeError
from lutgen.urdf.description import Mimic, UrdfRobot
from lutgen.urdf.read import parse_urdf
from tests.fixtures.robots import collision, joint, link, robot

PAIR = link("base", 2.0) + link("arm", 1.0)


def refusal(content):
    with pytest.raises(RecipeError) as caught:
        parse_urdf(content, "bad.urdf")
    text = str(caught.value)
    assert text.startswith("bad.urdf: ")
    assert text.endswith(".")
    return text


@pytest.mark.parametrize(
    "kind", ["fixed", "revolute", "continuous", "prismatic", "floating", "planar"]
)
def test_every_type_of_joint_is_read(kind):
    inside = '<axis xyz="0 3 4"/><limit lower="-1" upper="2" effort="1" velocity="1"/>'
    (found,) = parse_urdf(
        robot(PAIR, joint("j", kind, "base", "arm", inside, "1 2 3", "0.1 0.2 0.3"))
    ).joints
    assert (found.kind, found.parent, found.child) == (kind, "base", "arm")
    assert (found.origin, found.rpy) == ((1.0, 2.0, 3.0), (0.1, 0.2, 0.3))
    if kind not in ("fixed", "floating"):
        assert found.axis == (0.0, 0.6, 0.8)
    limited = kind in ("revolute", "prismatic")
    assert (found.lower, found.upper) == ((-1.0, 2.0) if limited else (-math.inf, math.inf))


def test_axis_limits_and_mimic_have_the_defaults_of_the_format():
    third = link("tip")
    follow = joint("k", "revolute", "arm", "tip", '<mimic joint="j"/><limit upper="1"/>')
    first, second = parse_urdf(
        robot(PAIR, third, joint("j", "revolute", "base", "arm"), follow)
    ).joints
    assert first.axis == (1.0, 0.0, 0.0)
    assert (first.lower, first.upper) == (-math.inf, math.inf)
    assert second.mimic == Mimic("j", 1.0, 0.0)
    assert (second.lower, second.upper) == (0.0, 1.0)


def test_elements_nested_in_other_blocks_and_unknown_ones_are_not_read():
    block = f"<gazebo>{link('base', 9.0)}{joint('j', 'fixed', 'a', 'b')}</gazebo>"
    other = '<transmission><joint name="j"/></transmission><colour/><colour/>'
    found = parse_urdf(robot(block, PAIR, other, joint("j", "fixed", "base", "arm")))
    assert [part.name for part in found.links] == ["base", "arm"]
    assert found.ignored == {"gazebo": 1, "transmission": 1, "colour": 2}
    assert found.root == "base"


BOMB = (
    '<?xml version="1.0"?><!DOCTYPE robot [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;">]>'
    '<robot name="&b;"/>'
)
TWO = joint("j", "fixed", "base", "arm")


def turning(inside):
    return robot(PAIR, joint("j", "revolute", "base", "arm", inside))


ZEROS = robot(PAIR, TWO)
TURNS = ('quat_xyzw="0 0 0 1" rpy="0 0 0"', 'quat_xyzw="0 0 0 0"')
FAULTS = [
    (BOMB, "has a document type declaration"),
    ("<a>" * 100_000 + "</a>" * 100_000, "is not <robot>"),
    *((text, "is not XML") for text in ("<robot", "", "\ud800", "<robot/><robot/>")),
    *((raw, "is not XML") for raw in (b"\xff\xfe\x00", bytes(range(256)) * 10)),
    # Python raises another error for each.
    *(
        (f'<?xml version="1.0" encoding="{code}"?><robot/>', "is not XML")
        for code in ("klingon", "utf-7")
    ),
    ("<sdf/>", "is not <robot>"),
    ('<x:robot xmlns:x="urn:x"/>', "is not <robot>"),
    (robot(), "needs 1 to 10000 links"),
    (
        robot("<xacro:macro/>").replace("<robot", "<robot xmlns:xacro='x'"),
        "is xacro that was not expanded (got '<xacro:macro>'); pass --xacro",
    ),
    (robot(PAIR, joint("j", "fixed", "base", "arm", xyz="${x} 0 0")), "pass --xacro"),
    (robot(link("base"), "<link/>"), "a <link>: has no name"),
    *((robot(link(name)), "has an unusable name") for name in ("a" * 201, "a&#10;b", "a&#x9b;31m")),
    (robot(link("a"), name="&#x202e;"), "has an unusable name"),
    (robot(link("base"), link("base")), "link 'base': is given more than once"),
    (robot(PAIR), "has 2 links without a parent"),
    (robot(PAIR, link("c"), TWO, joint("j", "fixed", "arm", "c")), "joint 'j': is given more"),
    (robot(PAIR, joint("j", "fixed", "bse", "arm")), "did you mean 'base'"),
    (robot(PAIR, joint("j", "fixed", "base", "")), "names no child link"),
    (robot(PAIR, joint("j", "hinge", "base", "arm")), "has an unknown type"),
    (robot(PAIR, TWO, joint("k", "fixed", "base", "arm")), "has two parents"),
    (robot(PAIR, TWO, joint("k", "fixed", "arm", "base")), "is its own ancestor"),
    (robot(link("o"), PAIR, TWO, joint("k", "fixed", "arm", "base")), "is its own ancestor"),
    (turning('<axis xyz="0 0 0"/>'), "axis without"),
    (turning('<axis xyz="0 1"/>'), "no vector"),
    (robot(PAIR, joint("j", "fixed", "base", "arm", xyz="0 nan 0")), "no vector as xyz"),
    (turning('<limit lower="2" upper="1"/>'), "lower limit above"),
    (turning('<limit lower="inf" upper="inf"/>'), "limits far from zero"),
    (turning('<mimic joint="i"/>'), "mimics what is no joint"),
    (turning('<mimic joint="j"/>'), "mimics itself"),
    (robot('<link name="a"><inertial/></link>'), "without <mass>"),
    (robot(link("a", inside="<inertial/><inertial/>")), "more than one <inertial>"),
    (robot(link("a", -1.0)), "negative mass"),
    *((robot(link("a", mass)), "no number as value") for mass in (math.inf, 1e300)),
    (robot(link("base", 1.0).replace('"1.0"', '"1_0"')), "no number as value"),
    (robot(link("base", 1.0).replace('"1.0"', f'"{"9" * 10_000}"')), "no number as value"),
    (robot(link("base", 1.0, "1e13 0 0")), "no vector as xyz"),
    (robot(link("a", inside=collision('sphere radius="-1"'))), "negative size"),
    (robot(link("a", inside=collision('box size="1 2"'))), "no vector as size"),
    *((ZEROS.replace('rpy="0 0 0"', turn), "no turn as quat_xyzw") for turn in TURNS),
    (ZEROS.replace('rpy="0 0 0"', 'quat_wxyz="1 0 0 0"'), "unknown attribute quat_wxyz"),
    (robot(PAIR, TWO).replace("<robot", '<robot version="2.0"'), "is not known (got '2.0')"),
]


@pytest.mark.parametrize(("content", "said"), FAULTS)
def test_a_fault_is_refused_in_one_sentence(content, said):
    text = refusal(content)
    assert said in text
    # What was received is quoted, but not all of it.
    assert len(text) < 400


LITTLE = robot(link("base", 2.0))


@pytest.mark.parametrize(
    "content",
    [
        LITTLE.replace('<?xml version="1.0"?>', "").encode("utf-16"),
        LITTLE.replace('"1.0"?>', '"1.0" encoding="UTF-16"?>').encode("utf-16"),
        LITTLE.replace('"1.0"?>', '"1.0" encoding="latin-1"?>').encode("latin-1"),
        "\ufeff".encode() + LITTLE.encode(),
        LITTLE.replace(
            "<link", "<![CDATA[<link name='base'/>]]><!-- <link/> --><?php <link/> ?><link"
        ),
        LITTLE.replace("<robot", '<robot xmlns="urn:x" xmlns:y="urn:y" y:name="other"').replace(
            "</robot>", '<y:link name="z"/></robot>'
        ),
    ],
    ids=["utf-16", "declared utf-16", "latin-1", "byte order mark", "cdata", "namespaces"],
)
def test_other_encodings_cdata_comments_and_namespaces_change_nothing(content):
    found = parse_urdf(content)
    assert found.name == "little"
    assert [(part.name, part.mass) for part in found.links] == [("base", 2.0)]


def test_megabytes_are_read_in_seconds_and_more_than_sixteen_are_refused():
    begin = time.process_time()
    text = robot(link("base", inside="<visual><x/></visual>" * 100_000))
    assert isinstance(parse_urdf(text), UrdfRobot)
    # Measured 1 s; a reader that is quadratic in the number takes half an hour.
    assert time.process_time() - begin < 60.0
    assert "is too long" in refusal(text + " " * 15_000_000)

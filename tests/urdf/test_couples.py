"""Joints that one parameter drives, and the groups of joints that an SRDF file names."""

import math
from xml.etree.ElementTree import fromstring

import pytest

from lutgen.errors import RecipeError
from lutgen.urdf import Couple, load_srdf, load_urdf, parse_urdf, places, read_motion
from lutgen.urdf.description import UrdfRobot
from lutgen.urdf.joints import Drive
from lutgen.urdf.srdf import joint_groups
from tests.fixtures.places import VECTORS
from tests.fixtures.robots import joint, link, robot

LIMIT = '<axis xyz="0 0 1"/><limit lower="{}" upper="{}" effort="1" velocity="1"/>'
FOLLOWER = '<axis xyz="0 0 1"/><mimic joint="b" multiplier="3" offset="0.5"/>'


def star() -> UrdfRobot:
    """Return a robot with joints of all kinds on its base."""
    kinds = {
        "a": ("revolute", LIMIT.format(-1, 2)),
        "b": ("revolute", LIMIT.format(-0.5, 0.3)),
        "turning": ("continuous", '<axis xyz="0 0 1"/>'),
        "slide": ("prismatic", LIMIT.format(0, 1)),
        "stuck": ("revolute", LIMIT.format(0.2, 0.2)),
        "free": ("floating", ""),
        "weld": ("fixed", ""),
        "follower": ("revolute", FOLLOWER),
    }
    parts = [link("base", 1.0), *(link(f"l_{name}", 1.0) for name in kinds)]
    parts += [joint(name, kind, "base", f"l_{name}", x) for name, (kind, x) in kinds.items()]
    return parse_urdf(robot(*parts), "star.urdf")


def test_joints_of_a_couple_follow_its_parameter_and_so_does_what_mimics_them() -> None:
    # a = p, b = -2 p + 0.1, follower = 3 b + 0.5 = -6 p + 0.8.
    found = read_motion(star(), (), couples=[Couple("both", {"a": (1.0, 0.0), "b": (-2.0, 0.1)})])
    assert found.drives["a"] == Drive("a", 1.0, 0.0)
    assert found.drives["b"] == Drive("a", -2.0, 0.1)
    assert found.drives["follower"] == Drive("a", -6.0, pytest.approx(0.8))
    # b within -0.5 to 0.3: p within -0.1 to 0.3; a alone would leave -1 to 2.
    assert found.free == {"a": (pytest.approx(-0.1), pytest.approx(0.3))}
    assert set(found.held) == {"turning", "slide", "stuck", "free"}


def test_a_parameter_need_not_be_any_of_its_joints() -> None:
    # a = 2 p + 1 is 1.5 at rest, so p is 0.25; the turning joint follows without limits.
    couple = Couple("p", {"a": (2.0, 1.0), "turning": (1.0, 0.0)})
    found = read_motion(star(), (), {"a": 1.5}, [couple])
    assert found.free["a"] == (-1.0, 0.5)
    assert found.rest["a"] == 0.25
    turn, _ = places(star(), found)["l_turning"]
    assert turn[1, 0] == pytest.approx(math.sin(0.25))
    turn, _ = places(star(), found)["l_a"]
    assert turn[1, 0] == pytest.approx(math.sin(1.5))


@pytest.mark.parametrize(
    ("joints", "said"),
    [
        ({"a": (1.0, 0.0), "slide": (1.0, 0.0)}, "joints that turn and joints that slide"),
        ({"a": (1.0, 0.0), "b": (1.0, 5.0)}, "leave 'p' no range"),
        ({"a": (1.0, 0.0), "stuck": (1.0, 0.0)}, "it has no room between its limits"),
        ({"stuck": (1.0, 0.0), "a": (1.0, 0.0)}, "has no room between its limits"),
        ({"a": (1.0, 0.0), "free": (1.0, 0.0)}, "it is floating"),
        ({"a": (1.0, 0.0), "weld": (1.0, 0.0)}, "it is fixed"),
        ({"a": (1.0, 0.0), "follower": (1.0, 0.0)}, "it follows 'b'"),
        ({"a": (1.0, 0.0), "nothing": (1.0, 0.0)}, "there is no such joint"),
        ({"nothing": (1.0, 0.0), "a": (1.0, 0.0)}, "there is no such joint"),
    ],
)
def test_what_cannot_go_together_is_refused(
    joints: dict[str, tuple[float, float]], said: str
) -> None:
    with pytest.raises(RecipeError, match=r"^star\.urdf: .*\.$") as caught:
        read_motion(star(), (), couples=[Couple("p", joints)])
    assert said in str(caught.value)


def test_groups_have_the_joints_of_chains_links_joints_and_other_groups() -> None:
    described = load_urdf(VECTORS / "quadruped.urdf")
    found = load_srdf(VECTORS / "quadruped.srdf", described).groups
    assert found["FL_leg"] == ("FL_hip_joint", "FL_thigh_joint", "FL_knee_joint")
    assert found["front_legs"] == (
        *("FL_hip_joint", "FL_thigh_joint", "FL_knee_joint"),
        *("FR_hip_joint", "FR_thigh_joint", "FR_knee_joint"),
    )
    assert [name[:2] for name in found["knees"]] == ["FL", "FR", "RL", "RR"]


def test_groups_in_a_circle_unknown_parts_and_broken_chains_add_nothing() -> None:
    root = fromstring(
        '<robot><group name="x"><group name="y"/><link name="l_a"/><group name="none"/></group>'
        '<group name="y"><group name="x"/><joint name="b"/><joint name="none"/>'
        '<joint name="weld"/><chain base_link="l_a" tip_link="l_slide"/></group>'
        '<group name=" "><joint name="a"/></group><group name="empty"/></robot>'
    )
    assert joint_groups(root, star()) == {"x": ("a", "b"), "y": ("a", "b"), "empty": ()}

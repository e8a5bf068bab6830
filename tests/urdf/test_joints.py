"""Which joints of a description are free, which follow, are coupled or held, and where."""

import math

import pytest

from lutgen.errors import RecipeError
from lutgen.urdf.joints import Drive, read_motion
from lutgen.urdf.links import links_of, places
from lutgen.urdf.read import parse_urdf
from tests.fixtures.robots import joint, link, robot

MIMIC = '<mimic joint="{}" multiplier="{}" offset="{}"/>'


def limit(low, high):
    return f'<limit lower="{low}" upper="{high}" effort="1" velocity="1"/>'


def row(*joints):
    """Return links in a row with joints of (name, kind, inside) along x, 1 m apart."""
    parts = [link(f"l{i}", 1.0) for i in range(len(joints) + 1)]
    parts += [
        joint(name, kind, f"l{i}", f"l{i + 1}", '<axis xyz="0 0 1"/>' + inside, "1 0 0")
        for i, (name, kind, inside) in enumerate(joints)
    ]
    return parse_urdf(robot(*parts), "row.urdf")


def test_mimics_multiply_and_add_and_the_limits_of_a_follower_bound_its_master():
    # c = 3 b + 0.5 and b = -2 a + 0.1, so c = -6 a + 0.8; c is written before its master.
    chain = [
        ("c", "continuous", MIMIC.format("b", 3, 0.5)),
        ("b", "continuous", MIMIC.format("a", -2, 0.1)),
        ("a", "revolute", limit(-0.5, 0.5)),
    ]
    found = read_motion(row(*chain))
    assert found.free == {"a": (-0.5, 0.5)}
    assert found.drives["a"] == Drive("a", 1.0, 0.0)
    assert found.drives["b"] == Drive("a", -2.0, 0.1)
    assert found.drives["c"] == Drive("a", -6.0, pytest.approx(0.8))
    assert found.held == {}
    # b = -2 a + 0.1 within -0.3 .. 0.2: a within -0.05 .. 0.2.
    chain[1] = ("b", "revolute", MIMIC.format("a", -2, 0.1) + limit(-0.3, 0.2))
    assert read_motion(row(*chain)).free["a"] == pytest.approx((-0.05, 0.2))
    endless = [("j0", "continuous", "")]
    endless += [(f"j{i}", "continuous", MIMIC.format(f"j{i - 1}", 1e12, 0)) for i in range(1, 40)]
    with pytest.raises(RecipeError, match="multiply beyond 1e"):
        read_motion(row(*endless))


def test_a_joint_that_turns_by_a_whole_turn_or_has_no_limits_has_one_turn():
    found = read_motion(
        row(
            ("a", "continuous", ""),
            ("b", "revolute", limit(-1e16, 1e16)),
            ("c", "revolute", limit(0.0, 7.0)),
            ("d", "revolute", limit(-1.0, 2.0)),
        )
    )
    turn = (-math.pi, math.pi)
    assert found.free == {"a": turn, "b": turn, "c": turn, "d": (-1.0, 2.0)}


@pytest.mark.parametrize(
    ("kind", "inside", "why"),
    [
        ("floating", "", "is floating"),
        ("planar", "", "is planar"),
        ("revolute", limit(0.3, 0.3), "no room"),
        ("prismatic", "", "has no limits"),
        ("prismatic", limit(0.0, math.inf), "has no limits"),
        ("prismatic", MIMIC.format("a", 1, 0), "follows 'a', which is revolute"),
        ("revolute", MIMIC.format("a", 0, 0.2), "follows 'a', which moves it by nothing"),
        ("revolute", MIMIC.format("weld", 1, 0.2), "follows 'weld', which is fixed"),
    ],
)
def test_a_joint_that_cannot_be_a_parameter_is_held_with_a_reason(kind, inside, why):
    found = read_motion(
        row(("a", "revolute", limit(-1, 1)), ("weld", "fixed", ""), ("b", kind, inside))
    )
    assert list(found.free) == ["a"]
    assert found.drives["b"].by is None
    assert why in found.held["b"]


def test_held_joints_stand_at_zero_or_at_their_limit_nearest_to_zero():
    described = row(
        ("a", "revolute", limit(0.5, 1.0)),
        ("b", "prismatic", limit(-3.0, -2.0)),
        ("c", "revolute", limit(-1.0, 1.0)),
        ("d", "revolute", MIMIC.format("a", 2, 0.1)),
    )
    found = read_motion(described, ())
    assert {name: drive.offset for name, drive in found.drives.items()} == {
        "a": 0.5,
        "b": -2.0,
        "c": 0.0,
        "d": pytest.approx(1.1),
    }
    # By hand: turned by 0.5 at (1, 0, 0); 1 m on, then 2 m down; 1 m on; 1 m on.
    where = places(described, found)["l4"]
    x, y = 1 + 3 * math.cos(0.5), 3 * math.sin(0.5)
    assert where[1].tolist() == pytest.approx([x, y, -2.0])
    angle = math.atan2(where[0][1, 0], where[0][0, 0])
    assert angle == pytest.approx(1.6)
    # The recipe's links hold the same placements.
    assert [part.rpy[2] for part in links_of(described, found, {})[1:]] == pytest.approx(
        [0.5, 0.0, 0.0, 1.1]
    )

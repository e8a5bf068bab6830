"""Which joints of a description are free, which follow, are coupled or held, and where."""

import math

import pytest

from lutgen.errors import RecipeError
from lutgen.urdf.joints import Couple, Drive, read_motion
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


def test_a_chosen_joint_that_cannot_be_free_is_refused():
    described = row(
        *(("a", "continuous", ""), ("b", "continuous", MIMIC.format("a", 1, 0))),
        *(("c", "fixed", ""), ("d", "planar", "")),
    )
    for name, said in {
        "aa": "there is no such joint .got 'aa'.; did you mean 'a'",
        "b": "it follows 'a'",
        "c": "is fixed",
        "d": "is planar",
    }.items():
        with pytest.raises(RecipeError, match=said):
            read_motion(described, [name])


TURNS = '<axis xyz="0 0 1"/><limit lower="{}" upper="{}" effort="1" velocity="1"/>'
FOLLOWER = '<axis xyz="0 0 1"/><mimic joint="b" multiplier="3" offset="0.5"/>'


def star():
    """Return a robot with joints of all kinds on its base."""
    kinds = {
        "a": ("revolute", TURNS.format(-1, 2)),
        "b": ("revolute", TURNS.format(-0.5, 0.3)),
        "turning": ("continuous", '<axis xyz="0 0 1"/>'),
        "slide": ("prismatic", TURNS.format(0, 1)),
        "stuck": ("revolute", TURNS.format(0.2, 0.2)),
        "free": ("floating", ""),
        "weld": ("fixed", ""),
        "follower": ("revolute", FOLLOWER),
    }
    parts = [link("base", 1.0), *(link(f"l_{name}", 1.0) for name in kinds)]
    parts += [joint(name, kind, "base", f"l_{name}", x) for name, (kind, x) in kinds.items()]
    return parse_urdf(robot(*parts), "star.urdf")


def test_joints_of_a_couple_follow_its_parameter_and_so_does_what_mimics_them():
    # a = p, b = -2 p + 0.1, follower = 3 b + 0.5 = -6 p + 0.8.
    found = read_motion(star(), (), couples=[Couple("both", {"a": (1.0, 0.0), "b": (-2.0, 0.1)})])
    assert found.drives["a"] == Drive("a", 1.0, 0.0)
    assert found.drives["b"] == Drive("a", -2.0, 0.1)
    assert found.drives["follower"] == Drive("a", -6.0, pytest.approx(0.8))
    # b within -0.5 to 0.3: p within -0.1 to 0.3; a alone would leave -1 to 2.
    assert found.free == {"a": (pytest.approx(-0.1), pytest.approx(0.3))}
    assert set(found.held) == {"turning", "slide", "stuck", "free"}


def test_a_parameter_need_not_be_any_of_its_joints():
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
def test_what_cannot_go_together_is_refused(joints, said):
    with pytest.raises(RecipeError, match=r"^star\.urdf: .*\.$") as caught:
        read_motion(star(), (), couples=[Couple("p", joints)])
    assert said in str(caught.value)

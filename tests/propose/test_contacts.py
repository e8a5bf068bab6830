"""Contacts from collision shapes, which of them count, and which joints move them."""

import math
from dataclasses import replace

import numpy as np
import pytest

import lutgen
from lutgen.errors import RecipeError
from lutgen.parts import Contact
from lutgen.propose.contacts import effects, inner_contacts, named_contacts, proposed_contacts
from lutgen.urdf.joints import read_motion
from lutgen.urdf.links import link_contacts, links_of, places
from lutgen.urdf.read import parse_urdf
from tests.fixtures.recipes import contact, rigid
from tests.fixtures.robots import collision, joint, link, robot

QUARTER = f"{math.pi / 2.0!r} 0 0"


def shaped(*shapes):
    return link_contacts(parse_urdf(robot(link("a", 1.0, inside="".join(shapes)))).links[0])


def test_a_sphere_is_a_sphere_at_its_centre_and_a_cylinder_its_two_rim_discs():
    assert shaped(collision('sphere radius="0.25"', "1 2 3")) == [
        Contact("a", "a", (1.0, 2.0, 3.0), 0.25)
    ]
    # Turned about x by 90 deg, its z axis points along -y.
    right, left = shaped(collision('cylinder radius="0.5" length="2"', "1 2 3", QUARTER))
    assert (right.name, left.name) == ("a_1", "a_2")
    assert right.position == pytest.approx((1.0, 1.0, 3.0))
    assert left.position == pytest.approx((1.0, 3.0, 3.0))
    for disc in (right, left):
        assert (disc.kind, disc.radius) == ("disc", 0.5)
        assert disc.axis == pytest.approx((0.0, -1.0, 0.0))
    # Without radius they are points, and of a mesh there is nothing.
    assert [p.kind for p in shaped(collision('cylinder radius="0" length="1"'))] == ["point"] * 2
    assert shaped(collision('mesh filename="/etc/hostname"')) == []


def test_a_box_is_its_corners_and_counts_only_without_round_shapes():
    box = collision('box size="2 4 6"', "1 0 0", f"0 0 {math.pi / 2.0!r}")
    corners = {tuple(round(x, 9) for x in part.position) for part in shaped(box)}
    assert corners == {(1.0 + x, y, z) for x in (-2, 2) for y in (-1, 1) for z in (-3, 3)}
    assert {part.kind for part in shaped(box)} == {"point"}
    assert [part.kind for part in shaped(box, collision('sphere radius="1"'))] == ["sphere"]


@pytest.mark.parametrize(
    ("extra", "sides", "middle"),
    [("", (4.0, 2.0, 6.0), (1.0, 2.0, 3.0)), (collision('sphere radius="1"'), None, None)],
)
def test_a_link_that_is_one_box_is_that_box_in_figures(extra, sides, middle):
    box = collision('box size="2 4 6"', "1 2 3", f"0 0 {math.pi / 2.0!r}")
    described = parse_urdf(robot(link("a", 1.0, "0.9 2.6 3", inside=box + extra)))
    (found,) = links_of(described, read_motion(described, None), {})
    assert (found.shape, found.shape_at) == (sides and pytest.approx(sides), middle)


def test_a_steering_joint_moves_a_wheel_and_a_slide_moves_what_it_carries():
    wheel = collision('cylinder radius="0.2" length="0"', rpy=QUARTER)
    limits = '<limit lower="-0.5" upper="0.5"/>'
    described = parse_urdf(
        robot(
            link("base", 8.0),
            link("fork", 2.0, inside=wheel),
            link("weight", 2.0),
            joint("steer", "revolute", "base", "fork", f'<axis xyz="0 0 1"/>{limits}'),
            joint("slide", "prismatic", "base", "weight", f'<axis xyz="1 0 0"/>{limits}'),
        )
    )
    motion = read_motion(described)
    found = effects(described, motion, named_contacts(described, ["fork"]))
    # The wheel stands in the steering axis: only its rim moves, by the chord of 1 rad.
    assert found["steer"] == pytest.approx((2.0 * math.sin(0.5) * 0.2, 0.0))
    assert found["slide"] == pytest.approx((0.0, 1.0 * 2.0 / 12.0))


def track(heights):
    """Return two rows of road wheels in links of their own, at heights above a plane."""
    wheel = collision('cylinder radius="0.1" length="0.06"', rpy=QUARTER)
    parts = [link("base", 10.0, "0 0 0.5")]
    for side, y in (("l", 0.4), ("r", -0.4)):
        for i, z in enumerate(heights):
            parts.append(link(f"{side}{i}", 0.1, inside=wheel))
            place = f"{0.2 * i:g} {y} {z}"
            axis = '<axis xyz="0 1 0"/>'
            parts.append(joint(f"{side}j{i}", "continuous", "base", f"{side}{i}", axis, place))
    return parse_urdf(robot(*parts))


def without_inner(described):
    """Return all discs of a robot and those that carry nothing alone, in the body's frame."""
    motion = read_motion(described, ())
    where = places(described, motion)
    found = proposed_contacts(described, where)
    inner = inner_contacts(described, motion, found, where)

    def at_rest(contact):
        turn, origin = where[contact.link]
        place = (origin + turn @ contact.position).tolist()
        return replace(contact, position=tuple(place))

    return [at_rest(c) for c in found], [at_rest(c) for c in inner]


@pytest.mark.parametrize(
    ("heights", "outer"),
    [
        # _2 is a left wheel's outer rim, _1 a right wheel's: the inner ones lie between those.
        ([0.1] * 6, "l0_2 l5_2 r0_1 r5_1"),
        ([0.1, 0.1, 0.099, 0.1], "l0_2 l2_2 l3_2 r0_1 r2_1 r3_1"),
        ([0.1, 0.101, 0.1, 0.1], "l0_2 l1_2 l3_2 r0_1 r1_1 r3_1"),
    ],
)
def test_of_wheels_in_two_lines_the_outer_rims_of_the_ends_remain_and_those_out_of_line(
    heights, outer
):
    found, inner = without_inner(track(heights))
    assert " ".join(part.name for part in found if part not in inner) == outer


def test_a_wheel_that_moves_against_the_others_stays():
    described = track([0.1] * 3)
    motion = read_motion(described, ["lj1"])
    where = places(described, motion)
    found = proposed_contacts(described, where)
    inner = inner_contacts(described, motion, found, where)
    names = {part.name for part in found} - {part.name for part in inner}
    assert names == {"l0_2", "l1_1", "l1_2", "l2_2", "r0_1", "r2_1"}


def test_no_verdict_changes_without_the_contacts_between_two_others():
    found, inner = without_inner(track([0.1, 0.14, 0.12, 0.1, 0.1]))
    assert inner

    def recipe(contacts):
        text = "".join(contact(c.name, c.position, c.radius, c.axis) for c in contacts)
        body = '[[robot.link]]\nname = "body"\nmass = 1.0\ncom = [0.3, 0.05, 0.5]\n'
        return lutgen.parse_recipe(rigid(body + text))

    rng = np.random.default_rng(3)
    gravity = rng.normal(size=(2000, 3)) - np.array([0.0, 0.0, 1.0])
    whole, part = (
        lutgen.evaluate(recipe(some), np.empty((1, 0)), gravity, ("tip_angle", "margin"))
        for some in (found, [c for c in found if c not in inner])
    )
    stands = whole["tip_angle"] > 0.0
    assert 0.1 < stands.mean() < 0.9
    for name in ("tip_angle", "margin"):
        # Heights of whole millimetres: in line or clearly out of it, to rounding.
        np.testing.assert_allclose(part[name], whole[name], atol=1e-8, err_msg=name)


def test_too_many_shapes_near_the_ground_are_refused_with_a_way_out():
    shapes = "".join(collision('sphere radius="0.1"', f"{i} 0 0") for i in range(201))
    described = parse_urdf(robot(link("a", 1.0, "0 0 1", shapes)))
    with pytest.raises(RecipeError, match="name the links that touch the ground"):
        proposed_contacts(described, places(described, read_motion(described)))


def test_links_within_a_quarter_of_the_coms_height_of_the_lowest_touch_the_ground():
    # The com is 1 m above the lowest point.
    heights = {"a": 0.0, "b": 0.0, "c": 0.0, "near": 0.24, "far": 0.26}
    described = [link("base", 10.0, "0 0 0.9")]
    for at, (name, height) in enumerate(heights.items()):
        turn = 2.0 * math.pi * at / len(heights)
        place = f"{math.cos(turn)!r} {math.sin(turn)!r} {height}"
        described.append(link(name, inside=collision('sphere radius="0.1"')))
        described.append(joint(f"{name}_j", "fixed", "base", name, xyz=place))
    read = parse_urdf(robot(*described))
    found = proposed_contacts(read, places(read, read_motion(read)))
    assert {one.link for one in found} == {"a", "b", "c", "near"}

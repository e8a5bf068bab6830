"""Contacts that another one hides in every posture are not in the tables."""

import numpy as np

from firmware_export.contacts.many import many_of, order_of, shown_contacts
from firmware_export.truth import Model
from lutgen.recipe import parse_recipe
from lutgen.support import DISC
from tests.fixtures.recipes import contact, sweep_part

HEAD = """
[robot]
name = "track"
length_unit = "m"
rock_angle = 30
upright = 80
[[robot.parameter]]
name = "flipper"
min = -90
max = 90
unit = "deg"
[[robot.link]]
name = "body"
mass = 10
[[robot.link]]
name = "arm"
parent = "body"
mass = 1
origin = [0.3, 0.0, -0.1]
joint = { type = "revolute", axis = [0.0, 1.0, 0.0], parameter = "flipper" }
"""
AXLE = (0.0, 1.0, 0.0)


def track(*more, before=""):
    """Return a robot on four wheels with two flippers, whose first wheels are on one axle."""
    wheels = [
        contact(f"wheel{k}{s}", (x, y, -0.1), 0.1, AXLE, link="body")
        for k, x in enumerate((-0.3, 0.3))
        for s, y in enumerate((-0.2, 0.2))
    ]
    flippers = [
        contact(f"flipper{k}{s}", (x, y, 0.0), r, AXLE, link="arm")
        for k, (x, r) in enumerate(((0.0, 0.1), (0.25, 0.05)))
        for s, y in enumerate((-0.2, 0.2))
    ]
    contacts = before + "".join((*wheels, *flippers, *more))
    return parse_recipe(HEAD + contacts + sweep_part("flipper = 5"))


def names(recipe, kept):
    return {recipe.contacts[at].name for at in kept}


WHEELS = {"wheel00", "wheel01", "wheel10", "wheel11"}


def test_of_two_wheels_on_one_axle_the_first_is_shown():
    recipe = track()
    assert names(recipe, shown_contacts(Model(recipe))) == WHEELS | {"flipper10", "flipper11"}


def test_corners_of_a_box_on_the_rims_are_hidden_and_those_beyond_are_not():
    on_rim = [
        contact(f"c{k}{s}", (x, y, -0.2), 0.0, None, link="body")
        for k, x in enumerate((-0.3, 0.3))
        for s, y in enumerate((-0.2, 0.2))
    ]
    beyond = contact("keel", (-0.3, 0.2, -0.2001), 0.0, None, link="body")
    recipe = track(*on_rim, beyond)
    assert names(recipe, shown_contacts(Model(recipe))) == WHEELS | {
        "flipper10",
        "flipper11",
        "keel",
    }


def test_what_is_hidden_in_some_postures_alone_is_shown():
    # The arm takes the first out of the wheel that it begins in, and the second all round on a rim.
    leaves = contact("leaves", (0.05, 0.2, 0.0), 0.0, None, link="body")
    turns = contact("turns", (0.0, 0.2, 0.1), 0.0, None, link="arm")
    away = contact("away", (-0.25, 0.2, 0.0), 0.0, None, link="arm")
    recipe = track(leaves, turns, away)
    shown = names(recipe, shown_contacts(Model(recipe)))
    assert {"leaves", "away"} <= shown
    assert "turns" not in shown


def test_contacts_keep_the_numbers_of_the_recipe_where_some_are_hidden():
    hub = contact("hub", (-0.3, -0.2, -0.1), 0.0, None, link="body")
    recipe = track(before=hub)
    order, turning = order_of(Model(recipe))
    assert not turning
    # Track by track, from left to right; the hub is number 0.
    assert [recipe.contacts[at].name for at in order] == [
        *("wheel01", "wheel11", "flipper11"),
        *("wheel00", "wheel10", "flipper10"),
    ]
    assert order == (2, 4, 8, 1, 3, 7)


RAILS = '[robot]\nname = "rails"\nlength_unit = "m"\n[[robot.link]]\nname = "body"\nmass = 1\n'


def on_axles(noise, tilt):
    """Return four wheels whose rails and axles are off by some noise (m) and tilt (rad)."""
    rng = np.random.default_rng(1)
    places = [(x, y, -0.2) for x in (-0.3, 0.3) for y in (-0.2, 0.2)]
    wheels = [
        contact(
            f"w{k}",
            [float(p + noise * s) for p, s in zip(place, rng.choice([-1, 1], 3), strict=True)],
            0.1,
            [0.0, 1.0, float(tilt * rng.choice([-1, 1]))],
            link="body",
        )
        for k, place in enumerate(places)
    ]
    return parse_recipe(RAILS + "".join(wheels) + sweep_part())


def test_axles_and_rails_that_differ_in_their_last_digits_are_one():
    # 1.5708 for a right angle tilts an axle by 3.7e-6 rad, six decimals move a rail by 5e-7 m.
    for noise, tilt in ((0.0, 0.0), (5e-7, 0.0), (0.0, 3.7e-6), (5e-7, 3.7e-6)):
        model = Model(on_axles(noise, tilt))
        assert (model.kind == DISC).all()
        assert order_of(model)[1] is False
        assert many_of(model).first == (0, 2, 4)
    assert order_of(Model(on_axles(0.0, 1e-4)))[1] is True
    assert len(many_of(Model(on_axles(1e-4, 0.0))).first) > 3

"""Contacts that another one hides in every posture are not in the tables."""

import numpy as np
import pytest

from firmware_export.contacts import INFO as contacts
from firmware_export.contacts.many import order_of
from firmware_export.contacts.shown import shown_contacts
from firmware_export.host import Host
from firmware_export.host.reader import STANDS
from firmware_export.protocol import Export, describe
from firmware_export.truth import Model
from lutgen.channels import evaluate_each
from lutgen.recipe import Recipe, parse_recipe
from tests.fixtures.many_library import boundary_points, random_directions
from tests.fixtures.odd_robots import boxed_tracks
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
OFF_CHART = 3


def track(*more: str, before: str = "") -> Recipe:
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


def names(recipe: Recipe, kept: tuple[int, ...]) -> set[str]:
    return {recipe.contacts[at].name for at in kept}


WHEELS = {"wheel00", "wheel01", "wheel10", "wheel11"}


def test_of_two_wheels_on_one_axle_the_first_is_shown() -> None:
    recipe = track()
    assert names(recipe, shown_contacts(Model(recipe))) == WHEELS | {"flipper10", "flipper11"}


def test_corners_of_a_box_on_the_rims_are_hidden_and_those_beyond_are_not() -> None:
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


def test_what_is_hidden_in_some_postures_alone_is_shown() -> None:
    # The arm takes the first out of the wheel that it begins in, and the second all round on a rim.
    leaves = contact("leaves", (0.05, 0.2, 0.0), 0.0, None, link="body")
    turns = contact("turns", (0.0, 0.2, 0.1), 0.0, None, link="arm")
    away = contact("away", (-0.25, 0.2, 0.0), 0.0, None, link="arm")
    recipe = track(leaves, turns, away)
    shown = names(recipe, shown_contacts(Model(recipe)))
    assert {"leaves", "away"} <= shown
    assert "turns" not in shown


def test_contacts_keep_the_numbers_of_the_recipe_where_some_are_hidden() -> None:
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


@pytest.mark.needs("gcc")
@pytest.mark.parametrize("seed", [2, 5, 28, 109])
def test_what_is_exported_answers_as_the_robot_with_all_its_contacts(seed: int) -> None:
    recipe = boxed_tracks(seed)
    model = Model(recipe)
    assert len(shown_contacts(model)) < len(recipe.contacts)
    tables = contacts.encode(model, ("tip_angle",), contacts.sizes(model)[0])
    export = Export("boxed", recipe, model, "contacts", "float", ("tip_angle",), tables)
    rng = np.random.default_rng(seed)
    params = model.at(rng.random((60, model.k))).astype(np.float32)
    near = boundary_points(recipe, params, rng, 30, 18)
    far = random_directions(rng, 60 * 30).reshape(60, 30, 3).astype(np.float32)
    g = np.concatenate([near, far], axis=1)
    exact = evaluate_each(recipe, params.astype(float), g.astype(float), ("tip_angle",))
    truth = exact["tip_angle"]
    host = Host(describe(export))
    status, reading = host.read(np.repeat(params, 60, axis=0), g.reshape(-1, 3))
    safe, angle = np.isin(status, STANDS), reading[:, 1].reshape(60, 60)
    safe = safe.reshape(60, 60)
    assert not (safe & (truth < 0.0)).any()
    assert (angle[safe] <= truth[safe]).all()
    # Within the chart gaps that find no room are given up, and the guard.
    asked = (status != OFF_CHART).reshape(60, 60) & (truth > 3e-4)
    assert safe[asked].mean() > 0.98

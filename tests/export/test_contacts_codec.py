"""The codec `contacts`: positions in closed form, and what the tables hold of them."""

from dataclasses import replace

import numpy as np
import pytest

import lutgen
from firmware_export.contacts import codec as contacts
from firmware_export.contacts.many import many_of, order_of, shown_contacts
from firmware_export.exporter import examine, guarded
from firmware_export.model import Model
from firmware_export.protocol import describe
from lutgen.quantities import EXPORTABLE
from lutgen.recipe import gallery_names, parse_recipe, robot_size_of
from tests.fixtures.exports import host_of, off_at
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import contact, link, parameter, rigid, rover, sweep_part, tripod

AXLE = (0.0, 1.0, 0.0)


def export_of(recipe):
    return contacts.INFO.export(Model(recipe), "robot", EXPORTABLE)


@pytest.mark.parametrize("name", [*gallery_names(), "tripod", "rover"])
def test_positions_in_c_are_the_robots_in_every_posture(name):
    texts = {"tripod": tripod, "rover": rover}
    recipe = parse_recipe(texts[name]()) if name in texts else lutgen.load_recipe(f"recipe:{name}")
    export = export_of(recipe)
    params = export.model.at(np.random.default_rng(1).random((300, export.model.k)))
    # Single precision.
    assert off_at(export, params.astype(np.float32)).max() < 1e-6 * robot_size_of(recipe)


def test_the_papers_robot_takes_51_bytes_and_its_guard_is_a_bound():
    paper = export_of(lutgen.load_recipe(MAPS / "paper_two.toml"))
    assert paper.body.bytes == 51
    # Other points, with nothing altered, would be no proof of a larger guard.
    assert paper.tables.guarded(1e-3) is None
    # Links that only move the com are stored once for all contacts.
    assert not paper.tables.terms.common
    assert export_of(lutgen.load_recipe(MAPS / "marv.toml")).tables.terms.common


@pytest.mark.parametrize("axle", [AXLE, (1.0, 0.0, 0.0), (0.6, -0.8, 0.0)])
def test_axles_may_point_either_way(axle):
    # The importer gives every cylinder of a description that is turned a quarter about x the axle
    # -y: the frame of such rails was turned and not turned back, and whole cars were refused.
    def car(sign):
        text = rigid(
            "".join(
                contact(f"wheel{k}{s}", (x, s * y, -0.3), 0.1, tuple(sign * a for a in axle))
                for k, (x, y) in enumerate(((0.1, 0.2), (0.3, 0.1), (-0.4, 0.25)))
                for s in (-1, 1)
            ),
            head="rock_angle = 30\nupright = 80",
        )
        return export_of(parse_recipe(text))

    export = car(1.0)
    assert describe(export).bytes == describe(car(-1.0)).bytes
    assert len(export.tables.many.first) > 2
    gravity = np.random.default_rng(5).normal(size=(3000, 3)) * [1.0, 1.0, 2.0]
    gravity[:, 2] = -np.abs(gravity[:, 2])
    _, status, reading = host_of(export).at(np.zeros(0), gravity)
    tip = export.model.exact(np.zeros((1, 0)), gravity[None].astype(np.float32)).tip_angle[0]
    held, safe = status != 3, status < 2
    assert not np.any(safe & (tip < 0.0))
    assert np.all(reading["tip_angle"][safe] <= tip[safe])
    assert safe[held & (tip > 3e-4)].mean() > 0.99


def test_a_guard_that_is_too_small_is_made_as_large_as_points_need():
    # Tables of a robot whose com is a little further ahead say too much of tipping backwards.
    export = export_of(parse_recipe(rover()))

    def told_by(ahead):
        other = Model(parse_recipe(rover(ahead=ahead)))
        return replace(export, tables=contacts.INFO.encode(other, EXPORTABLE, contacts.Spec()))

    bold = told_by(3e-4)
    assert examine(bold, None, 10_000).false_safe > 0
    mended, certificate = guarded(bold, None, 10_000)
    assert certificate.false_safe == 0
    assert 0.0 < mended.tables.guard < 3e-3
    assert mended.tables.many.guard == pytest.approx(np.sin(mended.tables.guard))
    assert mended.tables.guard_text.count("as much as points needed") == 1
    # What is wrong by more than any rounding is not hidden by a guard.
    wild = told_by(0.05)
    kept, certificate = guarded(wild, None, 10_000)
    assert certificate.false_safe > 0
    assert kept.tables.guard == wild.tables.guard


# Contacts that another one hides in every posture are not in the tables.

HEAD = '[robot]\nname = "track"\nlength_unit = "m"\nrock_angle = 30\nupright = 80\n'
HEAD += parameter("flipper", -90, 90) + link("body", mass=10)
HEAD += link("arm", joint=("revolute", AXLE, "flipper"), mass=1, origin=[0.3, 0.0, -0.1])


def track(more="", before=""):
    """Return a robot on four wheels with two flippers, whose first wheels are on one axle."""
    parts = [("wheel", "body", ((-0.3, -0.1, 0.1), (0.3, -0.1, 0.1)))]
    parts += [("flipper", "arm", ((0.0, 0.0, 0.1), (0.25, 0.0, 0.05)))]
    wheels = [
        contact(f"{name}{k}{s}", (x, y, z), radius, AXLE, link=on)
        for name, on, places in parts
        for k, (x, z, radius) in enumerate(places)
        for s, y in enumerate((-0.2, 0.2))
    ]
    return parse_recipe(HEAD + before + "".join(wheels) + more + sweep_part("flipper = 5"))


def point(name, place, on="body"):
    return contact(name, place, link=on)


# The corners of a box on the rims, and one beyond.
BOX = [point(f"c{x}{y}", (x, y, -0.2)) for x in (-0.3, 0.3) for y in (-0.2, 0.2)]
BOX += [point("keel", (-0.3, 0.2, -0.2001))]
# The arm takes the first out of the wheel that it begins in, and the second all round on a rim.
MOVED = [point("leaves", (0.05, 0.2, 0.0)), point("turns", (0.0, 0.2, 0.1), "arm")]
MOVED += [point("away", (-0.25, 0.2, 0.0), "arm")]


@pytest.mark.parametrize(
    ("more", "seen"), [([], set()), (BOX, {"keel"}), (MOVED, {"leaves", "away"})]
)
def test_contacts_that_others_hide_in_every_posture_are_left_out(more, seen):
    recipe = track("".join(more))
    shown = {recipe.contacts[at].name for at in shown_contacts(Model(recipe))}
    # The first of two wheels on one axle.
    wheels = {f"wheel{k}{s}" for k in (0, 1) for s in (0, 1)}
    assert shown == wheels | {"flipper10", "flipper11"} | seen


def test_contacts_keep_the_numbers_of_the_recipe_where_some_are_hidden():
    recipe = track(before=point("hub", (-0.3, -0.2, -0.1)))
    order, turning = order_of(Model(recipe))
    assert not turning
    # Track by track, from left to right; the hub is number 0.
    assert [recipe.contacts[at].name for at in order] == [
        *("wheel01", "wheel11", "flipper11"),
        *("wheel00", "wheel10", "flipper10"),
    ]
    assert order == (2, 4, 8, 1, 3, 7)


def on_axles(noise, tilt):
    """Return four wheels whose rails and axles are off by some noise (m) and tilt (rad)."""
    rng, wheels = np.random.default_rng(1), ""
    for k, place in enumerate((x, y, -0.2) for x in (-0.3, 0.3) for y in (-0.2, 0.2)):
        off = noise * rng.choice([-1, 1], 3)
        wheels += contact(f"w{k}", off + place, 0.1, [0.0, 1.0, tilt * rng.choice([-1, 1])])
    return Model(parse_recipe(rigid(wheels)))


def test_axles_and_rails_that_differ_in_their_last_digits_are_one():
    # 1.5708 for a right angle tilts an axle by 3.7e-6 rad, six decimals move a rail by 5e-7 m.
    for noise, tilt in ((0.0, 0.0), (5e-7, 0.0), (0.0, 3.7e-6), (5e-7, 3.7e-6)):
        model = on_axles(noise, tilt)
        assert order_of(model)[1] is False
        assert many_of(model).first == (0, 2, 4)
    assert order_of(on_axles(0.0, 1e-4))[1] is True
    assert len(many_of(on_axles(1e-4, 0.0)).first) > 3

"""Discs that all but agree: a wheel described by two rims, with noise, is a wheel."""

import math
import re

import numpy as np
import pytest

import lutgen
from tests.fixtures.commands import data
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import contact, rigid


def two_rim_car(noise, rng):
    """Return a car that tips sideways at 45 deg: each wheel is two rims, off by up to `noise`."""
    discs = []
    for x in (0.4, -0.4):
        for y in (0.5, -0.5):
            for rim, inward in enumerate((0.0, 0.08)):
                off = rng.uniform(-noise, noise, 6)
                place = np.array([x, y - math.copysign(inward, y), -0.35]) + off[:3]
                axis = np.array([0.0, 1.0, 0.0]) + off[3:] / 0.15 * [1.0, 0.0, 1.0]
                name = f"rim{rim}_{len(discs)}"
                discs.append(contact(name, place, float(0.15 + off[4]), axis))
    rng.shuffle(discs)
    return rigid("".join(discs))


def articulated(noise):
    """Return the gallery's articulated robot with an inner rim on each wheel, off by `noise`."""
    text = (MAPS / "articulated.toml").read_text()
    rng = np.random.default_rng(4)
    rims = []
    for x, z, link in ((-0.5, 0.25, "body"), (0.45, -0.15, "front")):
        for y in (0.27, -0.27):
            off = rng.uniform(-noise, noise, 6)
            place = np.array([x, y, z]) + off[:3]
            axis = np.array([0.0, 1.0, 0.0]) + off[3:] * [1.0, 0.0, 1.0]
            rims.append(contact(f"in_{len(rims)}", place, float(0.25 + off[4]), axis, link))
    head, tail = text.split("[sweep]", 1)
    return head + "\n".join(rims) + "\n[sweep]" + tail


def sideways_limits(text, tilt):
    """Return the least tilt (deg) at which a robot tips to its left and to its right."""
    recipe, limits = lutgen.parse_recipe(text), []
    for side in (1.0, -1.0):
        down = np.stack([0.0 * tilt, side * np.sin(tilt), -np.cos(tilt)], axis=1)
        tips = lutgen.evaluate(recipe, np.zeros((1, 0)), down)["tip_angle"][0] < 0.0
        assert tips.any()
        limits.append(math.degrees(tilt[tips.argmax()]))
    return limits


def test_cars_of_two_rim_wheels_tip_at_45_deg_for_noise_from_1_um_to_5_mm():
    rng = np.random.default_rng(5)
    tilt = np.radians(np.arange(30.0, 60.0, 0.05))
    cars = [two_rim_car(noise, rng) for noise in np.geomspace(1e-6, 5e-3, 120)]
    limits = np.array([sideways_limits(car, tilt) for car in cars])
    # 5 mm of 0.5 m turn the lowest line by 0.6 deg.
    assert limits.max() <= 46.5
    # Above contact_tolerance (0.05 mm) discs are not snapped, and between rests of three rims a
    # slit 1e-5 rad wide is no gap by the definition: 2 of 240 limits are lower.
    assert (limits < 43.5).sum() <= 2
    assert limits.min() > 40.0


def test_a_noisy_second_rim_costs_no_more_than_an_exact_one():
    noisy, exact = (lutgen.parse_recipe(articulated(noise)) for noise in (1e-4, 0.0))
    rng = np.random.default_rng(1)
    low = np.array([p.minimum for p in exact.parameters])
    high = np.array([p.maximum for p in exact.parameters])
    params = low + (high - low) * rng.random((100, 2))
    cosine, turn = rng.uniform(0.5, 1.0, 200), rng.uniform(0.0, 2.0 * np.pi, 200)
    sine = np.sqrt(1.0 - cosine**2)
    down = np.stack([sine * np.cos(turn), sine * np.sin(turn), -cosine], axis=1)
    with_noise, without = (
        lutgen.evaluate(recipe, params, down)["tip_angle"] for recipe in (noisy, exact)
    )
    safe = without >= 0.0
    assert 0.2 < safe.mean() < 0.95
    assert (with_noise[safe] < 0.0).mean() <= 1e-3
    both = safe & (with_noise >= 0.0)
    apart = np.degrees(np.abs(with_noise - without)[both])
    assert np.percentile(apart, 90) <= 0.1


def test_discs_on_one_axle_are_put_on_one_line_with_one_radius_and_check_says_so(tmp_path):
    exact = lutgen.parse_recipe(articulated(0.0))
    assert exact.snapped == ()
    assert exact.contacts[-1].position == (0.45, -0.27, -0.15)
    recipe = lutgen.parse_recipe(articulated(1e-4))
    rear = [c for c in recipe.contacts if c.link == "body"]
    assert len(rear) == 4
    assert len({one.radius for one in rear}) == 1
    centre, axis = np.array(rear[0].position), np.array(rear[0].axis)
    for one in rear[1:]:
        arm = np.array(one.position) - centre
        # Two roundings of a length of 1.
        assert np.linalg.norm(np.cross(arm, axis)) < 1e-15
        assert abs(np.dot(one.axis, axis)) == pytest.approx(1.0, abs=1e-15)
    # With a parameter between them discs are left alone.
    assert lutgen.load_recipe(MAPS / "absolem.toml").snapped == ()
    path = tmp_path / "noisy.toml"
    path.write_text(articulated(1e-4))
    said = data("check", path)["snapped"]
    assert len(said) == len(recipe.snapped) == 8
    assert re.fullmatch(r"disc .* was moved by .* m, to agree with those on its axle", said[0])


def test_a_disc_that_all_but_lies_on_the_cone_between_two_others_touches_nothing():
    axle = [0.0, 1.0, 0.0]
    places = ((0.4, 0.15), (0.2, 0.17001), (0.0, 0.19))
    discs = [contact(f"d{i}", [0.0, y, -0.3], r, axle) for i, (y, r) in enumerate(places)]
    discs += [contact("far", [1.0, 0.0, -0.3], 0.15, axle)]
    recipe = lutgen.parse_recipe(rigid("".join(discs)))
    assert recipe.contacts[1].radius < 0.17
    assert recipe.contacts[0].radius == 0.15
    further = lutgen.parse_recipe(rigid("".join(discs).replace("0.17001", "0.171")))
    assert further.snapped == ()
    assert further.contacts[1].radius == 0.171

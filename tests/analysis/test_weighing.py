"""Mass and centre of mass from scales and tilts, on a robot whose true ones are known."""

import math
from dataclasses import replace

import numpy as np
import pytest

from firmware_export.contacts.closed import closed_form
from lutgen.analysis import Tipping, Weighing, corrected, tilt_limits, tilted, weigh
from lutgen.errors import InputError, RecipeError
from lutgen.recipe import forward, parse_recipe
from tests.fixtures.recipes import contact, link, parameter, rigid

CORNERS = {"fl": (0.5, 0.4), "fr": (0.5, -0.4), "rl": (-0.5, 0.4), "rr": (-0.5, -0.4)}
SHIFT = np.array([0.03, -0.02, 0.05])
# Poses: lift (m), slope and heading (rad).
LEVEL, SLOPED = [(0.0, 0.0, 0.0), (0.3, 0.0, 0.0)], [(0.1, 0.2, 0.7)]


def cart(mass, com):
    """Return a cart with a load that is lifted forward; its masses are in the ratio of 5 to 1."""
    raised = ("prismatic", (0.6, 0, 0.8), "lift")
    parts = parameter("lift", 0.0, 0.3, "m")
    parts += link("body", mass=mass / 1.2, com=[*map(float, com)])
    parts += link("load", joint=raised, origin=[0, 0, 0.4], mass=mass / 6.0)
    parts += "".join(contact(name, (x, y, -0.1)) for name, (x, y) in CORNERS.items())
    text = rigid(parts, "cart", samples="lift = 3", nodes=5)
    return parse_recipe(text.replace("[robot]", "[robot]  # a cart", 1))


MODEL = cart(12.0, (0.0, 0.0, 0.1))
# The body carries 5/6 of the mass, so that its com moves that of all by SHIFT.
TRUE = cart(14.4, tuple(np.array([0.0, 0.0, 0.1]) + 1.2 * SHIFT))


def loads(lift, slope, heading):
    """Return the loads (kg) of the true cart on a slope, of many one that friction balances.

    All forces on the body are added up about its com; each foot's friction is uphill and
    proportional to its load.
    """
    (points,) = forward(TRUE, [[lift]]).centres
    down = tilted(slope, heading)
    push = down / down[2]
    equations = np.vstack([np.ones(4), np.cross(points, push).T])
    wanted = np.array([14.4 * math.cos(slope), 0.0, 0.0, 0.0])
    found = np.linalg.lstsq(equations, wanted, rcond=None)[0]
    assert np.allclose(equations @ found, wanted, atol=1e-12)
    # Four feet on a plane: what one diagonal takes more the other takes less.
    found += 0.3 * np.array([1.0, -1.0, -1.0, 1.0]) * (1.0 if slope == 0.0 else 0.0)
    return {(name,): float(load) for name, load in zip(CORNERS, found, strict=True)}


def weighed(*poses, accuracy=0.01):
    return [Weighing((q,), loads(q, s, h), accuracy, s, h) for q, s, h in poses]


def test_exact_scales_on_a_slope_give_the_mass_and_all_of_the_com():
    found = weigh(MODEL, weighed(*LEVEL, *SLOPED))
    assert found.mass == pytest.approx(14.4, abs=1e-12)
    np.testing.assert_allclose(found.com_shift, SHIFT, atol=1e-12)
    np.testing.assert_allclose(found.residuals, 0.0, atol=1e-12)
    assert 0.0 < found.spread < 0.01


def test_level_scales_leave_the_height_open_and_a_slope_is_advised():
    found = weigh(MODEL, weighed(*LEVEL))
    np.testing.assert_allclose(found.com_shift, [*SHIFT[:2], 0.0], atol=1e-12)
    assert np.isinf(found.com_std).tolist() == [False, False, True]
    assert found.advice.slope > 0.0
    after = weighed(*LEVEL, (found.advice.params[0], found.advice.slope, found.advice.heading))
    # The advice promises the deviation that is then found.
    assert weigh(MODEL, after).spread == pytest.approx(found.advice.com_std, rel=0.05)


def test_scales_under_the_axles_tell_nothing_across():
    axles = (("fl", "fr"), ("rl", "rr"))
    both = [
        replace(one, loads={axle: sum(one.loads[(name,)] for name in axle) for axle in axles})
        for one in weighed(*LEVEL)
    ]
    one = weigh(MODEL, [Weighing((0.0,), {("fl", "fr"): 5000.0}, 0.01)])
    assert math.isinf(one.mass_std)
    found = weigh(MODEL, both)
    assert found.mass == pytest.approx(14.4)
    assert found.com_shift[0] == pytest.approx(SHIFT[0])
    assert np.isinf(found.com_std).tolist() == [False, True, True]


def test_slopes_at_which_it_begins_to_tip_give_the_height():
    headings = np.array([0.0, 1.57, 3.1, -1.6])
    slopes = tilt_limits(TRUE, [0.1], headings, "plane")
    tips = [
        Tipping((0.1,), float(slope), float(heading), math.radians(1.0))
        for slope, heading in zip(slopes, headings, strict=True)
    ]
    found = weigh(MODEL, [*weighed(*LEVEL), *tips])
    np.testing.assert_allclose(found.com_shift, SHIFT, atol=1e-9)
    alone = weigh(MODEL, tips)
    np.testing.assert_allclose(alone.com_shift, SHIFT, atol=1e-9)
    assert math.isinf(alone.mass_std)
    # Tilts that do not agree, either.
    off = weigh(MODEL, [replace(tips[0], slope=tips[0].slope + 1e-3), *tips[1:]])
    np.testing.assert_allclose(off.com_shift, SHIFT, atol=2e-3)
    assert math.isinf(off.mass_std)


def test_of_noisy_weighings_two_deviations_hold_in_19_of_20():
    rng, inside, draws = np.random.default_rng(5), 0, 60
    exact = weighed(*LEVEL, *SLOPED, accuracy=0.1)
    for _ in range(draws):
        noisy = [
            replace(
                one, loads={key: load + rng.normal(0.0, 0.1) for key, load in one.loads.items()}
            )
            for one in exact
        ]
        found = weigh(MODEL, noisy)
        inside += bool(abs(found.com_shift[2] - SHIFT[2]) < 2.0 * found.com_std[2])
    # 95.4 % of a normal distribution, within three deviations of 60 draws; more, as scatter makes
    # deviations larger.
    assert 0.87 * draws <= inside < draws


def test_a_reading_that_contradicts_the_others_makes_deviations_larger():
    good = weighed(*LEVEL, *SLOPED)
    bad = [*good[1:], Weighing((0.0,), {**good[0].loads, ("fl",): 9.0}, 0.01)]
    assert weigh(MODEL, bad).spread > 10.0 * weigh(MODEL, good).spread


def test_the_corrected_recipe_is_the_robot_that_was_weighed():
    text = corrected(MODEL, weigh(MODEL, weighed(*LEVEL, *SLOPED)))
    assert "# a cart" in text
    robot = parse_recipe(text)
    for lift in (0.0, 0.17):
        np.testing.assert_allclose(
            forward(robot, [[lift]]).centres, forward(TRUE, [[lift]]).centres, atol=1e-8
        )
    assert math.fsum(link.mass for link in robot.links) == pytest.approx(14.4)
    assert robot.com_uncertainty > 0.0
    # Weighed once more it needs no correction, and the keys are there once.
    again = corrected(robot, weigh(robot, weighed(*LEVEL, *SLOPED)))
    assert again.count("com_offset") == 1
    np.testing.assert_allclose(parse_recipe(again).com_offset, robot.com_offset, atol=1e-8)


def test_what_cannot_be_weighed_is_refused_in_a_sentence():
    with pytest.raises(InputError, match=r"carries nothing .*'mast'.* fl, fr"):
        weigh(MODEL, [Weighing((0.0,), {("mast",): 3.0}, 0.1)])
    with pytest.raises(InputError, match="no mass above 0"):
        weigh(MODEL, [Weighing((0.0,), {(name,): -1.0 for name in CORNERS}, 0.1)])
    dotted = parse_recipe(
        MODEL.text.replace("[robot]  # a cart\nname", "robot.name").replace(
            "\nlength_unit", "\nrobot.length_unit"
        )
    )
    with pytest.raises(RecipeError, match=r"com_offset = \[.*by hand"):
        corrected(dotted, weigh(MODEL, weighed(*LEVEL)))


def test_an_export_knows_the_offset():
    robot = parse_recipe(corrected(MODEL, weigh(MODEL, weighed(*LEVEL, *SLOPED))))
    constant = closed_form(robot).com.terms[()] - closed_form(MODEL).com.terms[()]
    np.testing.assert_allclose(constant, SHIFT, atol=1e-8)

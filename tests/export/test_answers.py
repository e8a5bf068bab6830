"""The exported C against the exact evaluation, in floats and in whole numbers, robot by robot."""

import math
import re

import numpy as np
import pytest

import lutgen
from firmware_export.contacts.codec import LIMITS
from firmware_export.control import PolicyOptions, design
from firmware_export.model import Model
from lutgen.channels import evaluate_each
from lutgen.errors import InputError
from lutgen.recipe import parse_recipe, robot_size_of
from tests.fixtures import many_library as many
from tests.fixtures.length import part
from tests.fixtures.linkage import COARSEST, coded
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import quadruped, rover, steered, tripod

MANY = ("absolem", "marv", "excavator", "articulated", "quadruped", "tractor")
TEXTS = {"rover": rover(), "steered": steered(), "tripod": tripod()}
# An axle that swings; and one that is moved by a joint.
TRACTOR = (MAPS / "tractor.toml").read_text()
FRONT = '"front_axle"\nparent = "{}"'
TEXTS |= {"lifted": TRACTOR.replace(FRONT.format("body"), FRONT.format("loader"))}
ROBOTS = (*MANY, "paper_two", "three_leg_sphere", *TEXTS, "legs", "wheels", "scissors")


def recipe_of(name):
    if name in TEXTS:
        return parse_recipe(TEXTS[name])
    if name == "quadruped":
        return quadruped()
    return coded(name) if name in COARSEST else lutgen.load_recipe(MAPS / f"{name}.toml")


def near_a_grid(recipe, rng, count):
    """Return float32 params of multiples of 7.5 deg (or 0.13 m), of which two thirds are off."""
    low, high = many.ends_of(recipe)
    step, off = math.radians(7.5), rng.choice([0.0, 1e-6, 1e-4], (count, 1))
    params = step * np.rint(rng.uniform(low, high, (count, len(low))) / step)
    params += off * rng.normal(size=params.shape)
    return np.clip(params, low, high).astype(np.float32)


@pytest.mark.parametrize("whole", [False, True], ids=["float", "whole"])
@pytest.mark.parametrize("name", ROBOTS)
def test_no_answer_is_safer_than_the_truth_and_next_to_nothing_is_given_up(name, whole):
    recipe, rng = recipe_of(name), np.random.default_rng(6)
    error = COARSEST.get(name, 0.0)
    robot, size = many.Library(recipe, error=error), robot_size_of(recipe)
    params = np.concatenate([many.postures_of(recipe, rng, 120), near_a_grid(recipe, rng, 120)])
    g = many.near_and_far(recipe, params, rng, 15, 50)
    if whole:
        g = np.rint(g / np.abs(g).max(axis=-1, keepdims=True) * 16000.0).astype(np.int16)
    channels = ("sdg", "tip_angle", "height", "status")
    expected = evaluate_each(recipe, params.astype(float), g.astype(float), channels)
    got = robot.read(params, g)
    safe, stands = got["status"] != many.TIPS, expected["status"] != many.TIPS
    assert not (safe & ~stands).any()
    assert not ((got["status"] == many.OK) & (expected["status"] == many.ROCKS)).any()
    short = expected["tip_angle"] - got["tip_angle"]
    # Less than a third of the guard is used up; whole numbers have a guard of their own.
    guard = robot.export.tables.guard
    assert short[safe].min() > guard * 2.0 / 3.0
    # Lost beside the guard: rounding, of whole numbers too, and more next to a gap.
    clear = stands & (expected["tip_angle"] > 2.0 * guard + 1e-4)
    assert (clear & ~safe).sum() <= (0.012 if whole else 0.001) * clear.sum()
    assert safe.sum() > 1000
    extra = np.degrees(short - guard)
    assert np.median(extra[safe]) < (0.03 if whole else 0.008)
    assert np.percentile(extra[safe], 75) < (0.06 if whole else 0.04)
    # How far it has tipped: whole numbers tell a sine, -1 beyond a right angle.
    both = (got["status"] == many.TIPS) & (np.abs(expected["tip_angle"] + np.pi / 4) < np.pi / 4)
    assert short[both].min() > 0.0
    assert np.median(extra[both]) < (0.03 if whole else 0.008)
    # |SD_g| jumps where the facet changes: there rounding decides.
    for channel, loose in (("sdg", 5e-4 if whole else 4e-6), ("height", 6e-5 if whole else 4e-6)):
        off = np.abs(expected[channel] - got[channel])[safe]
        assert np.percentile(off, 99) < (loose + 0.3 * error) * size, channel


def nearly_level(name):
    """Return a robot and 2,000 of its postures, four contacts 1e-7 to 1e-2 out of one plane."""
    recipe = recipe_of(name)
    (low, high), rng = many.ends_of(recipe), np.random.default_rng(4)
    noise = rng.normal(size=(2000, len(low))) * 10.0 ** rng.uniform(-7, -2, (2000, 1))
    at = rng.uniform(low, high, (2000, len(low)))
    if name == "quadruped":  # four legs alike
        at = np.tile(at[:, :3], 4) + noise
    else:  # headings of any size, nothing twisted
        at[:, 1::2] = noise[:, 1::2]
    return recipe, np.clip(at, low, high).astype(np.float32)


@pytest.mark.parametrize("name", ["articulated", "quadruped", "steered"])
def test_wheels_and_feet_that_stand_nearly_in_one_plane_carry_as_in_the_definition(name):
    # Readings of the sensors of a level robot.
    recipe, params = nearly_level(name)
    g = many.random_directions(np.random.default_rng(5), len(params) * 40).reshape(-1, 40, 3)
    found = many.compared(many.Library(recipe), params, g.astype(np.float32))
    assert found.stands.mean() > 0.15
    assert (found.stands & ~found.safe).sum() <= 0.002 * found.stands.sum()
    short = np.degrees(found.true - found.told)[found.safe]
    # The guard is 0.006 deg.  Where arcs are a thousandth of a degree rounding moves the ends of
    # gaps between feet by a thousandth of their length.
    assert np.percentile(short, 99) < 0.02
    assert short.max() < (0.5 if name == "quadruped" else 0.05)


def test_without_room_for_gaps_or_arcs_less_is_safe_and_nothing_else_changes():
    recipe, rng = recipe_of("marv"), np.random.default_rng(7)
    params = many.postures_of(recipe, rng, 400)
    g = many.random_directions(rng, 400 * 50).reshape(400, 50, 3).astype(np.float32)
    whole = many.Library(recipe).read(params, g)
    could = whole["status"] != many.TIPS
    for scarce in ({"gaps": 1}, {"arcs": 12}):
        got = many.Library(recipe, **scarce).read(params, g)
        safe = got["status"] != many.TIPS
        assert not (safe & ~could).any()
        assert safe.any()
        # The side of a gap may be so short that its direction is known to a thousandth.
        assert (got["tip_angle"] <= whole["tip_angle"] + 2e-5)[safe].all()
        assert (could & ~safe).any()
        if "arcs" in scarce:  # a posture without its boundary tips in every direction
            assert not safe[(got["status"] != whole["status"]).any(axis=1)].any()
        else:  # the rests beside a gap stay
            assert (could & ~safe).sum() < 0.1 * could.sum()


@pytest.mark.parametrize("name", ["marv", "quadruped"])
def test_hardly_a_posture_needs_more_room(name):
    recipe, rng = recipe_of(name), np.random.default_rng(11)
    params = many.postures_of(recipe, rng, 4000)
    g = many.random_directions(rng, 4000 * 2).reshape(4000, 2, 3).astype(np.float32)
    given, enough = (
        many.Library(recipe, **room).read(params, g) for room in ({}, LIMITS._asdict())
    )
    assert (given["status"] == enough["status"]).mean() > 0.9995


def test_answers_do_not_depend_on_the_unit_of_length():
    # 1024 is the power of two next to millimetres: no number is rounded.
    def larger(match):
        numbers = [1024.0 * float(one) for one in re.findall(r"-?[\d.]+", match[2])]
        return match[1] + (str(numbers) if "[" in match[2] else repr(*numbers))

    text = (MAPS / "absolem.toml").read_text()
    lengths = r"((?:position|origin|com|radius|rest_width|contact_tolerance) = )(\[.*\]|[\d.]+)"
    recipes = [parse_recipe(one) for one in (text, re.sub(lengths, larger, text))]
    assert robot_size_of(recipes[1]) == 1024.0 * robot_size_of(recipes[0])
    rng = np.random.default_rng(3)
    params = many.postures_of(recipes[0], rng, 200)
    g = many.random_directions(rng, 10_000).reshape(200, 50, 3).astype(np.float32)
    metres, other = (many.Library(recipe).read(params, g) for recipe in recipes)
    for name in ("status", "tip_angle"):
        assert metres[name].tobytes() == other[name].tobytes()


@pytest.mark.parametrize("name", ["tractor", "lifted", "still"])
def test_an_uncertain_com_above_an_axle_that_swings_tips_nowhere_where_the_c_says_it_stands(name):
    text = TEXTS.get(name, TRACTOR)
    if name == "still":  # all of its postures have one height
        text = text.replace("max = 1.05", "max = 0.7501").replace("max = 45.0", "max = -34.99")
    recipe = parse_recipe(text.replace("[robot]\n", "[robot]\ncom_uncertainty = 0.01\n"))
    rng, robot = np.random.default_rng(12), many.Library(recipe)
    params = many.postures_of(recipe, rng, part(10_000, 40))
    g = many.near_and_far(recipe, params, rng, 15, 50)
    true = evaluate_each(recipe, params.astype(float), g.astype(float), ("tip_angle",))["tip_angle"]
    got = robot.read(params, g)
    safe, stands = got["status"] != many.TIPS, true >= 0.0
    assert not (safe & (got["tip_angle"] > true)).any()
    guard = robot.export.tables.guard
    assert math.radians(0.5) < guard < math.radians(1.5)
    clear = true > guard + 1e-4
    assert (clear & ~safe).sum() < 0.03 * clear.sum()
    assert (stands & safe).sum() > 1000


def test_control_refuses_an_axle_that_carries_in_some_postures_only():
    one_wheel = 'link = "left_wheel"\nposition = [0, 0, 0.78]'
    for text in (TEXTS["lifted"], TRACTOR.replace(one_wheel, one_wheel.replace("0.78]", "0.75]"))):
        with pytest.raises(InputError, match=r"some postures only \(got front\); read its export"):
            design(Model(parse_recipe(text)), PolicyOptions())

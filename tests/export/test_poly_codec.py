"""The codec `poly`: contacts as polynomials, their bound in the verdict, the C that reads them."""

import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from firmware_export.contacts import poly
from firmware_export.contacts.shorten import exponents
from firmware_export.protocol import Export
from firmware_export.truth.beyond import widened
from firmware_export.truth.model import Exact, Model
from firmware_export.truth.series import evaluate, expand
from lutgen.recipe.recipe import load_recipe, parse_recipe
from tests.fixtures.exports import before_guard
from tests.fixtures.recipes import contact, feet, rigid, rover, tripod

CHANNELS = ("sdg", "tip_angle", "height")
LEGS = "".join(
    f"""
[[robot.parameter]]
name = "{name}"
min = {low}
max = {high}
unit = "deg"
[[robot.link]]
name = "leg{i}"
rpy = [0, 0, {120 * i}]
parent = "body"
joint = {{ type = "revolute", axis = [0, 1, 0], parameter = "{name}" }}
"""
    + contact(f"P{i}", (2.0, 0.0, -0.5), link=f"leg{i}")
    for i, (name, low, high) in enumerate([("a", -5.0, 60.0), ("b", 0.0, 70.0), ("c", 10.0, 30.0)])
)
SAMPLES = "a = 2, b = 2, c = 2"
ROBOTS = {
    "paper_two": Path("maps/paper_two.toml").read_text(),
    "masses, a length and an angle": tripod(),
    "three legs, every direction": rigid(LEGS, samples=SAMPLES, chart="sphere"),
    "no parameters": rigid(feet([(1, 0, -1), (-0.5, 0.8, -1.2), (-0.5, -0.9, -1)])),
}


def model(text: str) -> Model:
    """Return the model of a recipe's text."""
    return Model(parse_recipe(text, "test.toml"))


def largest(robot: Model) -> poly.Tables:
    """Return the tables at the end of the growth."""
    return steps(robot)[-1]


def steps(robot: Model) -> list[poly.Tables]:
    """Return the tables of every step of the growth."""
    assert poly.refusal(robot, "float") is None
    specs = poly.start(robot, CHANNELS, "float")
    while grown := poly.grow(robot, specs[-1]):
        specs += grown
    return [poly.encode(robot, CHANNELS, spec) for spec in specs]


def asked(
    robot: Model, tables: poly.Tables, count: int, seed: int
) -> tuple[NDArray[np.float64], Exact]:
    """Return readings (m, 3) before the guard, and the truth; a third of the places are on rims."""
    rng = np.random.default_rng(seed)
    t = rng.uniform(-0.25, 1.25, (count, robot.k)).clip(0.0, 1.0)
    params = (robot.lower + t * (robot.upper - robot.lower)).astype(np.float32)
    u, v = rng.uniform(-1.25, 1.25, (2, count)).clip(-1.0, 1.0) * robot.chart_limit
    face = rng.integers(0, robot.faces, count)
    gravity = robot.uv_to_gravity(face, u, v).astype(np.float32)
    export = Export("robot", robot.recipe, robot, "poly", "float", CHANNELS, tables)
    exact = robot.exact(params.astype(np.float64), gravity[:, None].astype(np.float64))
    return before_guard(export, params, gravity).astype(np.float64), exact


def errors(robot: Model, tables: poly.Tables, count: int) -> tuple[float, float, float]:
    """Return the largest errors: sdg in % of its range, tip angle (rad), unsafe tip angle (rad)."""
    got, exact = asked(robot, tables, count, 5)
    standing = exact.tip_angle[:, 0] >= 0.0
    assert standing.mean() > 0.02
    span = np.ptp(exact.sdg[standing, 0])
    sdg = np.abs(got[:, 0] - exact.sdg[:, 0])[standing].max() / span * 100.0
    off = got[:, 1] - exact.tip_angle[:, 0]
    return float(sdg), float(np.abs(off).max()), float(off[got[:, 1] >= 0.0].max())


@pytest.mark.parametrize("text", ROBOTS.values(), ids=ROBOTS)
def test_no_tip_angle_is_off_by_more_than_the_guard(text: str) -> None:
    robot = model(text)
    for tables in steps(robot):
        off = errors(robot, tables, 20_000)[1]
        assert off <= tables.guard
        # A bound twelve times too large would be safe and useless; single precision has 1e-6 of it.
        assert tables.guard < 12.0 * off + 1e-4


def test_paper_two_takes_51_bytes_for_one_per_cent() -> None:
    robot = Model(load_recipe("maps/paper_two.toml"))
    # The second step of the growth: squares of both angles, nothing for the fixed leg.
    tables = steps(robot)[1]
    assert tables.bytes <= 51
    assert tables.bytes == poly.c_body(tables).bytes
    assert errors(robot, tables, 500_000)[0] < 1.0


@pytest.mark.parametrize("text", ROBOTS.values(), ids=ROBOTS)
def test_heights_are_those_of_the_facet(text: str) -> None:
    robot = model(text)
    tables = largest(robot)
    reading, exact = asked(robot, tables, 5_000, 9)
    standing = exact.tip_angle[:, 0] >= 0.0
    got = reading[standing, 2]
    # A contact is off by half a code in each of x, y, z for each of its terms, the plane below the
    # com by that times how far the com is outside the contacts' triangle: by less than 4 of these.
    contact_off = 0.5 * float(tables.unit) * math.sqrt(3.0) * tables.shape[:, -1].max()
    np.testing.assert_allclose(got, exact.height[standing, 0], rtol=1e-6, atol=4.0 * contact_off)


def test_growth_ends_at_the_rounding_of_the_codes() -> None:
    robot = Model(load_recipe("maps/paper_two.toml"))
    found = [errors(robot, tables, 20_000)[0] for tables in steps(robot)]
    assert found == sorted(found, reverse=True)
    # 16 bits of 23 units are 0.0007; the error of one is 0.003 % of the range of 22.
    assert found[-1] < 0.01
    sizes = [tables.bytes for tables in steps(robot)]
    assert sizes == sorted(set(sizes))


@pytest.mark.parametrize("text", ROBOTS.values(), ids=ROBOTS)
def test_series_are_the_contacts_anywhere_in_the_box(text: str) -> None:
    robot = model(text)
    series = expand(robot)
    assert series is not None
    t = np.random.default_rng(3).random((500, robot.k))
    exact = robot.postures(robot.lower + t * (robot.upper - robot.lower)).centres
    got = np.stack([evaluate(one, 2.0 * t - 1.0) for one in series], 1)
    order = [int(np.abs(exact - got[:, i, None]).sum((0, 2)).argmin()) for i in range(3)]
    assert sorted(order) == [0, 1, 2]
    # Series are cut off at 1e-13 of the robot's size and have some dozen terms.
    np.testing.assert_allclose(got, exact[:, order], rtol=0.0, atol=1e-11 * np.abs(exact).max())
    assert np.all(np.linalg.det(got) > 0.0)


def test_terms_are_counted_with_the_first_parameter_fastest() -> None:
    assert exponents((1, 2)) == [(0, 0), (1, 0), (0, 1), (1, 1), (0, 2)]
    assert exponents(()) == [()]


def test_a_contact_has_terms_only_in_the_parameters_that_move_it() -> None:
    spec = largest(Model(load_recipe("maps/paper_two.toml"))).spec
    assert sorted(sum(n > 0 for n in degrees) for degrees in spec.degrees) == [0, 1, 1]


def test_encoding_twice_gives_the_same_tables() -> None:
    first, second = (largest(model(tripod())) for _ in range(2))
    assert first.codes.tobytes() == second.codes.tobytes()
    assert (first.guard, first.unit, first.spec) == (second.guard, second.unit, second.spec)


@pytest.mark.parametrize(
    ("text", "arithmetic", "reason"),
    [
        (tripod(), "integer", "floats only"),
        (rover(), "float", "4 contacts, some of them round"),
        (tripod(contacts=contact("rear", (-1, 0, -1))), "float", "4 contacts"),
        # The body leans by up to 60 deg when the legs of one side are drawn in.
        (rigid(LEGS, head="upright = 20.0", samples=SAMPLES), "float", "accepted in every posture"),
        # At -40 deg the foot is above the com, and so is the plane through the other feet.
        (
            rigid(LEGS.replace("min = 0.0", "min = -80.0"), samples=SAMPLES),
            "float",
            "accepted in every posture",
        ),
    ],
)
def test_what_it_cannot_hold_is_refused_in_one_sentence(
    text: str, arithmetic: str, reason: str
) -> None:
    sentence = poly.refusal(model(text), arithmetic)
    assert sentence is not None
    assert reason in sentence
    assert "\n" not in sentence


def test_a_facet_that_is_refused_in_a_corner_of_the_box_only_is_found() -> None:
    # paper_two's facet leans most, 26 deg, where one leg is level and the other fully down.
    text = ROBOTS["paper_two"]
    # The box, and as far beyond its ends as a sensor's slack goes.
    wider = widened(model(text))
    ends = [(one.minimum, one.maximum) for one in wider.recipe.parameters]
    where = wider.postures(np.array(list(itertools.product(*ends)))).centres
    normal = np.cross(where[:, 1] - where[:, 0], where[:, 2] - where[:, 0])
    lean = math.degrees(np.arccos(normal[:, 2] / np.linalg.norm(normal, axis=1)).max())
    for beyond, holds in ((0.1, True), (-0.1, False)):
        head = text.replace("upright = 80.0", f"upright = {lean + beyond!r}")
        assert (poly.refusal(model(head), "float") is None) == holds

"""Ground tilt: rocking by hand, a slow walk in small steps, and bounds that are bounds."""

import dataclasses
import math

import numpy as np
import pytest

import lutgen
from lutgen.analysis import Posture, ground_tilt, posture_limits
from lutgen.analysis.tilt import level_angles, level_frames, tilt_limits, tilted
from lutgen.recipe.recipe import parse_recipe
from tests.fixtures.length import part
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import feet, rigid
from tests.oracles.primitives import least_turn

ALL_ROUND = np.radians(np.arange(0.0, 360.0, 5.0))
BOX = [(0.30, 0.20, -0.4), (-0.25, 0.20, -0.4), (-0.25, -0.15, -0.4), (0.30, -0.15, -0.4)]
# A sledge: flat under the com for 0.2 m to both ends, then rising by 12 deg for another 0.5 m.
FLAT, RISES, HIGH, WIDE, BEND = 0.2, 0.5, 0.5, 0.6, math.radians(12.0)
NAMES = pytest.mark.parametrize("name", ["bowls", "articulated", "marv"])


def sledge(rock_angle, flat=FLAT, rises=RISES, bend=BEND):
    up = -HIGH + rises * math.tan(bend)
    points = [
        (x, y, z)
        for x, z in ((flat, -HIGH), (flat + rises, up), (-flat, -HIGH), (-flat - rises, up))
        for y in (WIDE, -WIDE)
    ]
    return Posture(parse_recipe(rigid(feet(points), head=f"rock_angle = {rock_angle}")), [])


def bowl(rng):
    """Return a robot on random points of a bowl, which rocks over many of its facets."""
    count = int(rng.integers(6, 14))
    angle, reach = rng.uniform(0.0, 2.0 * math.pi, count), np.sqrt(rng.uniform(0.05, 1.0, count))
    height = -0.8 + 0.35 * reach**2 + rng.normal(0.0, 0.02, count)
    points = np.stack([reach * np.cos(angle), reach * np.sin(angle), height], axis=1)
    head = "rock_angle = 45.0\nupright = 85.0"
    return Posture(parse_recipe(rigid(feet(points.tolist()), head=head)), [])


def postures(name, count):
    """Return bowls, or postures of a robot of the gallery all over its ranges."""
    rng = np.random.default_rng(3)
    if name == "bowls":
        return [bowl(rng) for _ in range(count)]
    robot = lutgen.load_recipe(MAPS / f"{name}.toml")
    low, high = ([getattr(p, end) for p in robot.parameters] for end in ("minimum", "maximum"))
    return [Posture(robot, row) for row in rng.uniform(low, high, (count, len(low)))]


def walked(posture, ways):
    """Return at which of many tilts and headings (w, 2) a robot tips, and how often it has rolled.

    It asks `evaluate` alone for verdicts.  Where gravity leaves the facet that it is on, found by
    halving, it rolls over the two contacts there; it tips where it does not stand behind them, or
    has no `tip_angle` left between.
    """
    facets, frame = posture.facets, level_frames(posture.recipe, posture.row, "plane")[0]

    def read(frame, way):
        """Return the facet on which it stands still, -1 for none, and `tip_angle`."""
        down, names = (frame @ tilted(*way))[None], ("facet", "status", "tip_angle")
        found = lutgen.evaluate(posture.recipe, posture.row, down, names)
        facet, status, angle = (float(found[name][0, 0]) for name in names)
        return (int(facet) if status == 0.0 else -1), angle

    on, rolls, before = read(frame, ways[0])[0], 0, ways[0]
    for number, way in enumerate(ways if on >= 0 else ()):
        while read(frame, way)[0] != on:
            gone = way
            for _ in range(50):
                half = (before + gone) / 2.0
                before, gone = (half, gone) if read(frame, half)[0] == on else (before, half)
            # What is halved to rounding has 1e-12 left on an axis; beside one, far more.
            if read(frame, before)[1] < 1e-9:
                return number, rolls
            start, stop = facets[on].points, np.roll(facets[on].points, -1, axis=0)
            walls = np.cross(start, stop) / np.linalg.norm(np.cross(start, stop), axis=1)[:, None]
            at = int(np.argmin(walls @ frame @ tilted(*before)))
            carry = {facets[on].contacts[at], np.roll(facets[on].contacts, -1)[at]}
            beyond = [k for k, facet in enumerate(facets) if carry <= set(facet.contacts)]
            beyond.remove(on)
            turned = least_turn(facets[on].normal, facets[beyond[0]].normal) @ frame
            if read(turned, before)[0] != beyond[0]:
                return number, rolls
            on, frame, rolls = beyond[0], turned, rolls + 1
        before = way
    return (len(ways) if on >= 0 else 0), rolls


def test_a_robot_that_does_not_rock_has_the_same_limit_on_the_ground_as_in_its_body():
    body = '[[robot.link]]\nname = "body"\nmass = 10.0\n'
    pull = '[[robot.force]]\nname = "pull"\nlink = "body"\nforce = [15.0, 5.0, -3.0]\n'
    pulled = rigid(body + feet(BOX) + pull + "position = [0.1, 0.0, 0.3]\n")
    alone = [rigid(feet(BOX), head=head) for head in ("", "com_uncertainty = 0.03")]
    for text in (*alone, pulled):
        posture = Posture(parse_recipe(text), [])
        found = ground_tilt(posture)
        limits = tilt_limits(posture.recipe, [], ALL_ROUND, "plane")
        np.testing.assert_allclose(found.limits(ALL_ROUND), limits, atol=1e-11)
        level = level_angles(posture.recipe, posture.row, "plane")[0]
        assert level - 1e-11 < found.guaranteed < level
        if text != pulled:
            assert found.worst == pytest.approx(-math.pi / 2.0, abs=1e-9)  # rounding
            assert set(found.contacts(found.worst)) == {"P3", "P4"}


def test_a_sledge_rocks_onto_its_nose_and_tips_at_the_slope_that_is_under_it_there():
    posture, falls = sledge(30.0), ground_tilt(sledge(10.0))
    rocks = ground_tilt(posture)
    # Gravity through the tip of the nose, from the normal of the plane that it stands on then.
    tip = math.atan((FLAT + RISES) / (HIGH - RISES * math.tan(BEND)))
    ahead, leaves = [0.0, math.pi], math.atan(FLAT / HIGH)
    np.testing.assert_allclose(rocks.limits(ahead), tip - BEND, atol=1e-12)  # closed form
    np.testing.assert_allclose(falls.limits(ahead), leaves, atol=1e-12)
    # An accelerometer sees the bend, too: body tilt is larger by it.
    assert tilt_limits(posture.recipe, [], ahead, "plane") == pytest.approx([tip] * 2)
    # A com that is not known exactly is not followed onto the nose.
    ball = dataclasses.replace(posture.recipe, com_uncertainty=0.001)
    assert leaves - 0.003 < ground_tilt(Posture(ball, [])).limits(ahead).min() < leaves


def test_what_tips_on_level_ground_has_no_limit_and_what_is_over_an_edge_stands():
    aside = Posture(parse_recipe(rigid(feet([(x + 1.0, y, z) for x, y, z in BOX]))), [])
    found = ground_tilt(aside)
    assert (found.guaranteed, found.least, found.contacts(0.0)) == (0.0, 0.0, ())
    assert (found.limits([0.0]), math.isnan(found.worst)) == (0.0, True)
    assert not posture_limits(aside).stands
    edge = Posture(parse_recipe(rigid(feet([(x, y - 0.20, z) for x, y, z in BOX]))), [])
    limits = posture_limits(edge)
    assert limits.stands
    assert (limits.guaranteed, limits.ground.guaranteed, limits.ground.least) == (0.0, 0.0, 0.0)
    assert limits.ground.worst == pytest.approx(math.pi / 2.0)
    assert set(limits.ground.contacts(math.pi / 2.0)) == {"P1", "P2"}
    away = [tilt_limits(edge.recipe, [], [-1.0], "plane")[0], limits.ground.limits([-1.0])[0]]
    assert away == pytest.approx([math.atan(0.35 / 0.4 / math.sin(1.0))] * 2, abs=1e-9)


def test_an_articulated_robot_tips_on_the_ground_where_a_physics_engine_says_so():
    robot = lutgen.load_recipe(MAPS / "articulated.toml")
    posture = Posture(robot, np.radians([45.0, 15.0]))
    found = ground_tilt(posture)
    # MuJoCo, the ground tilted slowly: 30.5, 33.2 and 48.0 deg.  In the first two it rocks through
    # 21 deg and does not stay, but goes on over the next edge.  A wheel's width of rubber and the
    # lag of a tilt that takes seconds are worth up to 2 deg, and make its limits larger.
    for heading, measured in ((120.0, 30.5), (125.0, 33.2), (75.0, 48.0)):
        limit = math.degrees(found.limits([math.radians(heading)])[0])
        assert measured - 2.0 < limit < measured
    # Onto the rest on which it has 2.4 deg left it does not get on slopes of less than 22 deg.
    assert 22.0 < math.degrees(found.guaranteed) <= math.degrees(found.least) < 23.0


@NAMES
def test_ground_tilted_step_by_step_tips_robots_at_the_limits_in_closed_form(name):
    rng, step, rolled = np.random.default_rng(1), math.radians(0.2), 0
    for posture in postures(name, part(16, 2 if name == "bowls" else 4)):
        found, fine = ground_tilt(posture), np.linspace(-math.pi, math.pi, 3601)
        # No heading of a fine grid is worse than the worst, and that is as bad, but for rounding.
        assert found.limits(fine).min() >= found.least - 1e-12
        assert not found.stands or abs(found.limits([found.worst])[0] - found.least) < 1e-9
        for heading in rng.uniform(-math.pi, math.pi, 3):
            limit = found.limits([heading])[0]
            tilts = np.arange(0.0, limit + 2.0 * step, step)
            number, rolls = walked(posture, np.stack([tilts, np.full(len(tilts), heading)], axis=1))
            # Seen one step late at most.
            assert -1e-9 <= tilts[min(number, len(tilts) - 1)] - limit <= step + 1e-9
            rolled += rolls > 0
    assert rolled > 0


@NAMES
def test_ground_no_steeper_than_guaranteed_tips_no_robot_however_it_is_turned(name):
    rng, around, rolled = np.random.default_rng(6), np.radians(np.arange(0.0, 720.0, 3.0)), 0
    for posture in postures(name, part(16, 2 if name == "bowls" else 4)):
        found, heading = ground_tilt(posture), float(rng.uniform(-math.pi, math.pi))
        slope = 0.999 * found.guaranteed
        up = np.stack([np.linspace(0.0, slope, 20), np.full(20, heading)], axis=1)
        turned = np.stack([np.full(len(around), slope), heading + around], axis=1)
        number, rolls = walked(posture, np.vstack([up, turned]))
        assert number == (20 + len(around) if found.stands else 0)
        rolled += rolls > 0
    assert rolled > 0

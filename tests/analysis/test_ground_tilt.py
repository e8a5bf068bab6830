"""Ground tilt: rocking by hand, what a physics engine measured, and bounds that are bounds."""

import dataclasses
import math

import numpy as np
import pytest

import lutgen
from lutgen.analysis.ground_outline import ground_limits, ground_tilt
from lutgen.analysis.sliding import slopes
from lutgen.analysis.stance import Posture
from lutgen.analysis.tilt import level_frames, level_limits, tilt_limits, tilted
from lutgen.analysis.tilt_table import posture_limits
from lutgen.recipe.recipe import Recipe, parse_recipe
from tests.fixtures.length import part
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import contact, feet, rigid

ALL_ROUND = np.radians(np.arange(0.0, 360.0, 5.0))
BOX = [(0.30, 0.20, -0.4), (-0.25, 0.20, -0.4), (-0.25, -0.15, -0.4), (0.30, -0.15, -0.4)]
# A sledge: flat under the com for 0.2 m to both ends, then rising by 12 deg for another 0.5 m.
FLAT, RISES, HIGH, WIDE, BEND = 0.2, 0.5, 0.5, 0.6, math.radians(12.0)


def sledge(
    rock_angle: float, flat: float = FLAT, rises: float = RISES, bend: float = BEND
) -> Posture:
    """Return a sledge on eight points."""
    up = -HIGH + rises * math.tan(bend)
    points = [
        (x, y, z)
        for x, z in ((flat, -HIGH), (flat + rises, up), (-flat, -HIGH), (-flat - rises, up))
        for y in (WIDE, -WIDE)
    ]
    return Posture(parse_recipe(rigid(feet(points), head=f"rock_angle = {rock_angle}")), [])


def test_a_robot_that_does_not_rock_has_the_same_limit_on_the_ground_as_in_its_body() -> None:
    for head in ("friction = 0.7", "com_uncertainty = 0.03"):
        posture = Posture(parse_recipe(rigid(feet(BOX), head=head)), [])
        found = ground_tilt(posture)
        body = tilt_limits(posture.recipe, [], ALL_ROUND, "plane")
        # The walk of the body knows its limits to 1e-13 rad; a hundred times that for both.
        np.testing.assert_allclose(found.limits(ALL_ROUND), body, atol=1e-11)
        level = level_limits(posture.recipe, posture.row, "plane")[0]
        assert found.guaranteed == pytest.approx(level, abs=1e-11)
        assert found.guaranteed < level
        assert found.worst == pytest.approx(-math.pi / 2.0, abs=1e-9)  # rounding
        assert set(found.contacts(found.worst)) == {"P3", "P4"}


def test_forces_move_the_limit_on_the_ground_as_they_do_in_the_body() -> None:
    body = '[[robot.link]]\nname = "body"\nmass = 10.0\n'
    pull = '[[robot.force]]\nname = "pull"\nlink = "body"\nforce = [15.0, 5.0, -3.0]\n'
    recipe = parse_recipe(rigid(body + feet(BOX) + pull + "position = [0.1, 0.0, 0.3]\n"))
    found = ground_tilt(Posture(recipe, []))
    body_tilt = tilt_limits(recipe, [], ALL_ROUND, "plane")
    np.testing.assert_allclose(found.limits(ALL_ROUND), body_tilt, atol=1e-11)  # as above
    assert np.ptp(body_tilt) > 0.3
    assert posture_limits(Posture(recipe, [])).slide is None


def test_a_sledge_rocks_onto_its_nose_and_tips_at_the_slope_that_is_under_it_there() -> None:
    rocks, falls = sledge(30.0), sledge(10.0)
    # Gravity through the tip of the nose, from the normal of the plane that it stands on then.
    tip = math.atan((FLAT + RISES) / (HIGH - RISES * math.tan(BEND)))
    for heading in (0.0, math.pi):
        found = ground_tilt(rocks).limits([heading])[0]
        assert found == pytest.approx(tip - BEND, abs=1e-12)  # closed form, some roundings
        assert ground_tilt(falls).limits([heading])[0] == pytest.approx(
            math.atan(FLAT / HIGH), abs=1e-12
        )
        # An accelerometer sees the bend, too: body tilt is larger by it.
        body = tilt_limits(rocks.recipe, [], [heading], "plane")[0]
        assert body == pytest.approx(tip, abs=1e-12)
    assert tip - BEND > math.atan(FLAT / HIGH) + 0.1
    sides = ground_tilt(rocks).limits([math.pi / 2.0, -math.pi / 2.0])
    np.testing.assert_allclose(sides, math.atan(WIDE / HIGH), atol=1e-12)


def test_a_sledge_that_its_nose_does_not_catch_tips_where_it_leaves_its_flat() -> None:
    flat, rises, bend = 0.1, 0.3, math.radians(20.0)
    leaves = math.atan(flat / HIGH)
    high = rises * math.tan(bend)
    # From where it balances at the bend it falls on to the tip of the nose, and has more energy
    # than it takes to go over that: the com is lower there than where it was let go.
    sinks = math.hypot(rises, high) * math.sin(leaves)
    assert math.hypot(flat + rises, HIGH - high) - sinks < math.hypot(flat, HIGH)
    posture = sledge(30.0, flat, rises, bend)
    ahead = [0.0, math.pi]
    np.testing.assert_allclose(ground_tilt(posture).limits(ahead), leaves, atol=1e-12)  # rounding
    # Gravity passes from rest to rest, and still the robot falls as it passes the edge.
    body = tilt_limits(posture.recipe, [], ahead, "plane")
    np.testing.assert_allclose(body, leaves, atol=1e-10)  # where `tip_angle` is 1e-11 at most


def test_a_slope_is_never_above_90_deg_however_far_the_robot_may_rock() -> None:
    cube = [(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)]
    free = "upright = 180.0\nrock_angle = 180.0"
    posture = Posture(parse_recipe(rigid(feet(cube), head=free)), [])
    # No attitude tips it over, yet from 45 deg on it rolls from face to face.
    assert level_limits(posture.recipe, posture.row)[0] == math.pi
    assert ground_tilt(posture).limits([0.0])[0] == pytest.approx(math.pi / 4.0, abs=1e-9)
    for name in ("absolem", "marv"):
        robot = lutgen.load_recipe(MAPS / f"{name}.toml")
        wide = dataclasses.replace(robot, rock_angle=math.radians(60.0))
        rows = random_rows(wide, 20)
        body = tilt_limits(wide, rows, ALL_ROUND, "plane")
        ground = ground_limits(wide, rows, ALL_ROUND)
        assert ground.max() < math.radians(80.0)
        # The body turns further, though not as far as if it rocked where nothing catches it.
        assert body.max() > ground.max() + math.radians(2.0)


def test_what_tips_on_level_ground_has_no_limit() -> None:
    aside = Posture(parse_recipe(rigid(feet([(x + 1.0, y, z) for x, y, z in BOX]))), [])
    found = ground_tilt(aside)
    assert (found.guaranteed, found.least, found.contacts(0.0)) == (0.0, 0.0, ())
    assert found.limits([0.0, 1.0]).tolist() == [0.0, 0.0]
    assert math.isnan(found.worst)


def test_an_articulated_robot_tips_on_the_ground_where_a_physics_engine_says_so() -> None:
    robot = lutgen.load_recipe(MAPS / "articulated.toml")
    posture = Posture(robot, np.radians([45.0, 15.0]))
    found = ground_tilt(posture)
    # MuJoCo, the ground tilted slowly: 30.5, 33.2 and 48.0 deg.  In the first two it rocks through
    # 21 deg and is not caught, but goes on over the next edge.  A wheel's width of rubber and the
    # lag of a tilt that takes seconds are worth up to 2 deg, and make its limits larger.
    for heading, measured in ((120.0, 30.5), (125.0, 33.2), (75.0, 48.0)):
        limit = math.degrees(found.limits([math.radians(heading)])[0])
        assert measured - 2.0 < limit < measured
    # Where it is not caught it tips over the edge that it would rock over, in body and ground tilt.
    body = math.degrees(level_limits(robot, posture.row, "plane")[0])
    assert math.degrees(found.least) == pytest.approx(body, abs=0.01)
    assert math.degrees(found.least) < 23.0
    # Onto the rest on which it has 2.4 deg left it does not get on slopes of less than 22 deg.
    assert 22.0 < math.degrees(found.guaranteed) <= math.degrees(found.least)


def random_rows(robot: Recipe, count: int, seed: int = 3) -> np.ndarray:
    """Return postures all over a robot's ranges."""
    low, high = ([getattr(p, end) for p in robot.parameters] for end in ("minimum", "maximum"))
    return np.random.default_rng(seed).uniform(low, high, (count, len(low)))


@pytest.mark.parametrize("convention", ["plane", "body"])
@pytest.mark.parametrize("name", ["articulated", "absolem", "markhor", "marv"])
def test_a_robot_whose_body_is_tilted_until_it_tips_has_been_on_more_than_the_guaranteed_slope(
    name: str, convention: str
) -> None:
    robot, steps, count = lutgen.load_recipe(MAPS / f"{name}.toml"), 20, part(40, 2)
    rows = random_rows(robot, count)
    limits = tilt_limits(robot, rows, ALL_ROUND, convention)
    frames = level_frames(robot, rows, convention)
    ways = np.concatenate([limits * k / steps for k in range(steps + 1)], axis=1)
    headings = np.tile(ALL_ROUND, (count, steps + 1))
    downs = np.einsum("mij,mhj->mhi", frames, tilted(ways, headings))
    along = slopes(robot, rows, downs).reshape(count, steps + 1, -1)
    # Between two places the slope may have been larger, but by no more than gravity turned.
    most = along.max(axis=1) + limits / steps
    # Where it stands at all with that attitude to begin with.
    least = np.where((limits > 0.0) & (limits < math.pi), most, np.inf).min(axis=1)
    guaranteed = np.array([ground_tilt(Posture(robot, row)).guaranteed for row in rows])
    assert (guaranteed <= least).all()
    assert np.degrees(guaranteed).mean() > 25.0
    # Body tilt's bound is none for the ground where a robot rocks and is caught, which few do.
    at_tip_over = np.where((limits > 0.0) & (limits < math.pi), along[:, -1], np.inf).min(axis=1)
    assert (level_limits(robot, rows, "plane") > at_tip_over + 0.01).any()


@pytest.mark.parametrize("name", ["articulated", "absolem", "marv"])
def test_no_heading_of_a_fine_grid_is_worse_than_the_worst(name: str) -> None:
    robot = lutgen.load_recipe(MAPS / f"{name}.toml")
    fine = np.linspace(-math.pi, math.pi, 3601)
    rocking = 0
    for row in random_rows(robot, 6):
        found = ground_tilt(Posture(robot, row))
        tilts = found.limits(fine)
        assert tilts.min() >= found.least - 1e-12  # rounding
        # Where the part of an edge ends over which the robot is caught, a limit rises steeply and
        # then jumps: beside its worst heading the least is missed by far less than in the grid.
        beside = found.limits(found.worst + np.linspace(-1e-4, 1e-4, 201))
        assert beside.min() <= found.least + 1e-5
        assert found.limits([found.worst])[0] == pytest.approx(found.least, abs=1e-9)
        assert found.guaranteed < found.least
        body = tilt_limits(robot, row, fine[::40], "plane")
        rocking += bool((np.abs(body - tilts[::40]) > 0.02).any())
    assert rocking >= 2


def bowl(rng: np.random.Generator) -> Posture:
    """Return a robot on random points of a bowl, which rocks over many of its facets."""
    count = int(rng.integers(6, 14))
    angle, reach = rng.uniform(0.0, 2.0 * math.pi, count), np.sqrt(rng.uniform(0.05, 1.0, count))
    height = -0.8 + 0.35 * reach**2 + rng.normal(0.0, 0.02, count)
    points = np.stack([reach * np.cos(angle), reach * np.sin(angle), height], axis=1)
    head = "rock_angle = 60.0\nupright = 85.0"
    return Posture(parse_recipe(rigid(feet(points.tolist()), head=head)), [])


def turn(start: np.ndarray, stop: np.ndarray) -> np.ndarray:
    """Return the least rotation that takes one unit vector to another."""
    axis = np.cross(start, stop)
    cross = np.cross(np.eye(3), axis)
    return np.asarray(np.eye(3) + cross + cross @ cross / (1.0 + start @ stop))


def by_steps(posture: Posture, heading: float, step: float) -> float:
    """Return the tilt at which a robot on points tips: the ground tilted step by step.

    At each step the robot turns onto the facet that gravity pierces, until it is on that one.  It
    falls where gravity passes an edge beyond which it is not caught: there it stands on both sides,
    and has no `tip_angle` left between them.
    """
    facets, tilt, rocked = posture.stance.facets, 0.0, 0.0
    frame = level_frames(posture.recipe, posture.row, "plane")[0]
    on = int(np.argmax([facet.normal @ -frame[:, 2] for facet in facets]))

    def angle(down: np.ndarray) -> float:
        found = lutgen.evaluate(posture.recipe, [[]], down[None], ("tip_angle",))
        return float(found["tip_angle"][0, 0])

    def under(down: np.ndarray) -> int:
        return int(posture.stance.under(down[None])[0]) if angle(down) >= 0.0 else -1

    def leaves(stays: float, gone: float) -> np.ndarray:
        """Return gravity as it leaves the facet on which the robot is, between two tilts."""
        for _ in range(50):
            half = (stays + gone) / 2.0
            stays, gone = (
                (half, gone) if under(frame @ tilted(half, heading)) == on else (stays, half)
            )
        return np.asarray(frame @ tilted(stays, heading))

    if under(-frame[:, 2]) != on:
        return 0.0
    while True:
        down = frame @ tilted(tilt, heading)
        # What is bisected to rounding has 1e-12 left; where it is caught, far more than 1e-9.
        if under(down) != on and angle(leaves(tilt - step, tilt)) < 1e-9:
            return tilt
        if facets[on].is_rest:
            rocked = 0.0
        while (below := under(down)) != on:
            here, there = (facets[k].normal for k in (on, below))
            rocked += math.acos(min(1.0, float(here @ there)))
            if below < 0 or rocked > posture.recipe.rock_angle:
                return tilt
            rolled = turn(here, there)
            frame, down, on = rolled @ frame, rolled @ down, below
        tilt += step


def test_a_ground_that_is_tilted_step_by_step_tips_robots_at_the_limits_in_closed_form() -> None:
    rng, step = np.random.default_rng(1), math.radians(0.2)
    rocking = standing = 0
    for _ in range(part(16, 2)):
        posture = bowl(rng)
        found = ground_tilt(posture)
        for heading in rng.uniform(-math.pi, math.pi, 3):
            limit, seen = found.limits([heading])[0], by_steps(posture, heading, step)
            # Seen one step late at most.
            assert -1e-9 <= seen - limit <= step + 1e-9
            body = tilt_limits(posture.recipe, [], [heading], "plane")[0]
            rocking += body > limit + 0.02
            standing += limit > 0.1
    # Most edges of a bowl catch nothing, and there ground and body tip at one tilt.
    assert rocking > part(5, 2)
    assert standing > part(20, 2)


@pytest.mark.parametrize(
    ("count", "step", "fell"), [(16, 2.0, 2.85), (16, 4.4, 6.30), (31, 2.2, 7.48), (20, 1.0, 2.43)]
)
def test_a_sole_that_swings_from_wheel_to_wheel_is_guaranteed_less_than_an_engine_shows(
    count: int, step: float, fell: float
) -> None:
    # MuJoCo, tilted at 0.1 deg/s: it still swings when it gets to the end, and goes over early.
    angles = math.radians(step) * (np.arange(count) - (count - 1) / 2.0)
    text = "".join(
        contact(f"w{k}{y}", (0.48 * math.sin(a), y, 0.1 - 0.48 * math.cos(a)), 0.02, (0, 1, 0))
        for k, a in enumerate(angles)
        for y in (0.25, -0.25)
    )
    found = ground_tilt(Posture(parse_recipe(rigid(text)), []))
    # Until it leaves the facet in the middle it does not swing: half a step of the 0.5 m sole, and
    # less by a fifth where a wheel and no facet is in the middle.
    first = math.degrees(math.atan(0.5 * math.sin(math.radians(step) / 2.0) / 0.4))
    assert 0.7 * first < math.degrees(found.guaranteed) < fell
    assert found.guaranteed < 0.5 * found.least


def turned_about(posture: Posture, slope: float, heading: float) -> bool:
    """Return whether a robot on points tips on ground that is tilted and then turned round twice.

    At each step the robot turns onto the facet that gravity pierces, if what it passes between two
    facets belongs to the standing region.
    """
    facets, rocked = posture.stance.facets, 0.0
    frame = level_frames(posture.recipe, posture.row, "plane")[0]
    on = int(np.argmax([facet.normal @ -frame[:, 2] for facet in facets]))
    steps = np.radians(np.arange(0.0, 720.0, 3.0))
    ways = [(t, heading) for t in np.linspace(0.0, slope, 20)]
    ways += [(slope, heading + turned) for turned in steps]
    was = frame @ tilted(0.0, heading)
    for tilt, towards in ways:
        down = frame @ tilted(tilt, towards)
        rocked = 0.0 if facets[on].is_rest else rocked
        while (below := int(posture.stance.under(down[None])[0])) != on:
            between = was + np.linspace(0.0, 1.0, 400)[:, None] * (down - was)
            between /= np.linalg.norm(between, axis=1)[:, None]
            angle = lutgen.evaluate(posture.recipe, [[]], between, ("tip_angle",))["tip_angle"][0]
            step = float(np.linalg.norm(between[0] - between[1]))
            # An edge that does not catch has no tip angle left: less than a step beside it.
            if below < 0 or angle.min() < 2.0 * step:
                return True
            rolled = turn(facets[on].normal, facets[below].normal)
            rocked += math.acos(min(1.0, float(facets[on].normal @ facets[below].normal)))
            if rocked > posture.recipe.rock_angle:
                return True
            frame, down, was, on = rolled @ frame, rolled @ down, rolled @ down, below
        was = down
    return False


def test_a_ground_no_steeper_than_guaranteed_tips_no_robot_however_it_is_turned() -> None:
    rng = np.random.default_rng(6)
    bowls = (bowl(rng) for _ in range(part(30, 2)))
    rows = [row for row in bowls if ground_tilt(row).guaranteed > 0.05]
    for posture in rows:
        found = ground_tilt(posture)
        heading = float(rng.uniform(-math.pi, math.pi))
        # Gravity that only grazes a tip-over axis has no angle left to it either, hence the 1 %.
        assert not turned_about(posture, 0.99 * found.guaranteed, heading)
        # Further than the least limit of all headings it tips, tilted in that one.
        assert turned_about(posture, found.least + math.radians(0.1), found.worst)
    assert len(rows) > part(10, 2)


def test_positions_that_are_a_little_wrong_do_not_change_what_is_guaranteed() -> None:
    rng, sigma = np.random.default_rng(0), 1e-5
    places = [(x, y + d) for x in (0.3, 0.0, -0.3) for y in (0.3, -0.3) for d in (0.02, -0.02)]
    facets = 0
    for _ in range(6):
        text = ""
        for i, (x, y) in enumerate(places):
            # Two rims to a wheel, six wheels.
            place, axis = (v + rng.normal(0.0, sigma, 3) for v in ((x, y, -0.3), (0.0, 1.0, 0.0)))
            text += contact(f"w{i}", tuple(place), 0.1, tuple(axis))
        posture = Posture(parse_recipe(rigid(text)), [])
        facets = max(facets, len(posture.stance.facets))
        # A rim of 20 mm, between rims of which the robot rocks, tilts it by 1e-3 rad at most.
        guaranteed = ground_tilt(posture).guaranteed
        assert guaranteed == pytest.approx(math.atan(0.3 / 0.4), abs=1e-3)
    assert facets > 8

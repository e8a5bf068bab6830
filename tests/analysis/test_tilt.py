"""Tilt limits: hand-worked boxes, brute force over headings, and all postures against loops."""

import math

import numpy as np
import pytest

import lutgen
from lutgen.analysis.diagnosis import diagnose
from lutgen.analysis.ground import gravity_transform
from lutgen.analysis.posture import Posture
from lutgen.analysis.sliding import slide_limits
from lutgen.analysis.tilt import level_frames, level_limits, tilt_limits, tilted, worst_heading
from lutgen.analysis.tilt_table import FOUR, even_headings, posture_limits, sweep_limits
from lutgen.channels.evaluation import evaluate_each
from lutgen.errors import InputError
from lutgen.recipe.recipe import Recipe, parse_recipe
from tests.fixtures.length import part
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import feet, rigid, rover, tripod, without_limits

AHEAD, BEHIND, LEFT, RIGHT, HEIGHT = 0.30, 0.25, 0.20, 0.15, 0.40
CORNERS = [
    (AHEAD, LEFT, -HEIGHT),
    (-BEHIND, LEFT, -HEIGHT),
    (-BEHIND, -RIGHT, -HEIGHT),
    (AHEAD, -RIGHT, -HEIGHT),
]
CUBE = [(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)]
CONVENTIONS = ("body", "plane")


def box(head: str = "friction = 0.7", unit: str = "m", scale: float = 1.0) -> Recipe:
    """Return a rigid box on four feet."""
    corners = [[scale * x for x in corner] for corner in CORNERS]
    return parse_recipe(rigid(feet(corners), head=head, unit=unit))


def nodes(recipe: Recipe) -> np.ndarray:
    """Return the postures of a recipe's sweep."""
    return recipe.grid.params(np.arange(recipe.grid.size))


# One posture


@pytest.mark.parametrize("convention", CONVENTIONS)
@pytest.mark.parametrize(("unit", "scale"), [("m", 1.0), ("mm", 1000.0), ("1", 3.0)])
def test_a_box_tips_where_its_com_passes_the_edge(convention: str, unit: str, scale: float) -> None:
    found = posture_limits(Posture(box(unit=unit, scale=scale), []), convention)
    reaches = {
        "nose down": (AHEAD, {"P1", "P4"}),
        "left side down": (LEFT, {"P1", "P2"}),
        "nose up": (BEHIND, {"P2", "P3"}),
        "right side down": (RIGHT, {"P3", "P4"}),
    }
    for row in found.headings[:4]:
        reach, contacts = reaches[row.name]
        # Found to 1e-13 rad; some roundings of coordinates.
        assert row.tilt == pytest.approx(math.atan(reach / HEIGHT), abs=1e-12)
        assert row.heading == FOUR[row.name]
        assert set(row.contacts) == contacts
        # It slides from atan(0.7) on, which lies between the limits of both ends.
        assert row.slides is (reach / HEIGHT > 0.7)
    assert found.worst.heading == pytest.approx(-math.pi / 2.0, abs=1e-6)
    assert found.worst.tilt == pytest.approx(math.atan(RIGHT / HEIGHT), abs=1e-12)
    assert found.guaranteed == pytest.approx(math.atan(RIGHT / HEIGHT), abs=1e-12)
    assert found.worst.slides is False


@pytest.mark.parametrize("turn", [0.1, 0.7, 2.0, -2.9])
def test_the_worst_heading_points_at_the_nearest_edge(turn: float) -> None:
    cos, sin = math.cos(turn), math.sin(turn)
    corners = [(cos * x - sin * y, sin * x + cos * y, z) for x, y, z in CORNERS]
    recipe = parse_recipe(rigid(feet(corners)))
    expected = math.remainder(turn - math.pi / 2.0, 2.0 * math.pi)
    # The circle of headings is divided until its pieces are 1e-6 rad.
    assert worst_heading(Posture(recipe, [])) == pytest.approx(expected, abs=1e-6)


def test_of_equally_bad_headings_the_one_nearest_the_nose_and_on_the_left_counts() -> None:
    square = [(0.3, 0.3, -0.5), (-0.3, 0.3, -0.5), (-0.3, -0.3, -0.5), (0.3, -0.3, -0.5)]
    assert worst_heading(Posture(parse_recipe(rigid(feet(square))), [])) == pytest.approx(
        0.0, abs=1e-6
    )
    diamond = [(0.4, 0.0, -0.5), (0.0, 0.4, -0.5), (-0.4, 0.0, -0.5), (0.0, -0.4, -0.5)]
    found = worst_heading(Posture(parse_recipe(rigid(feet(diamond))), []))
    assert found == pytest.approx(math.pi / 4.0, abs=1e-6)


def test_what_cannot_stand_has_no_limit_and_what_cannot_fall_has_no_axis() -> None:
    above = parse_recipe(rigid(feet([(x, y, -z) for x, y, z in CORNERS]), head="friction = 0.7"))
    found = posture_limits(Posture(above, []))
    assert found.guaranteed == 0.0
    assert [row.tilt for row in found.headings] == [0.0] * 5
    assert math.isnan(found.worst.heading)
    free = without_limits(rigid(feet(CUBE), head="friction = 0.7"))
    found = posture_limits(Posture(free, []))
    assert found.guaranteed == math.pi
    assert {(row.tilt, row.contacts, row.slides) for row in found.headings} == {(math.pi, (), None)}
    assert math.isnan(found.worst.heading)


def random_postures() -> list[tuple[str, Recipe, np.ndarray]]:
    """Return robots of points and of discs with postures all over their ranges."""
    random = np.random.default_rng(11)
    robots = [("tripod", parse_recipe(tripod())), ("rover", parse_recipe(rover()))]
    robots.append(("absolem", lutgen.load_recipe(MAPS / "absolem.toml")))
    return [
        (
            name,
            robot,
            random.uniform(
                [p.minimum for p in robot.parameters],
                [p.maximum for p in robot.parameters],
                (part(8, 2), k),
            ),
        )
        for name, robot in robots
        for k in [len(robot.parameters)]
    ]


@pytest.mark.parametrize(
    ("robot", "rows"), [case[1:] for case in random_postures()], ids=["tripod", "rover", "absolem"]
)
@pytest.mark.parametrize("convention", CONVENTIONS)
def test_no_heading_of_a_fine_grid_is_worse_than_guaranteed(
    robot: Recipe, rows: np.ndarray, convention: str
) -> None:
    fine = np.linspace(-math.pi, math.pi, 1441)
    standing = 0
    for posture in rows:
        found = posture_limits(Posture(robot, posture), convention)
        tilts = tilt_limits(robot, posture, fine, convention)
        # The walk itself knows its limits to 1e-13 rad.
        assert tilts.min() >= found.guaranteed - 1e-12
        assert found.worst.tilt - found.guaranteed < math.radians(1e-3)
        assert found.worst.tilt <= tilts.min() + 1e-9
        standing += found.guaranteed > 0.05
    assert standing >= 3


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_many_postures_at_once_have_the_limits_of_each_alone(convention: str) -> None:
    robot = parse_recipe(rover())
    rows, headings = nodes(robot), np.radians([0.0, 33.0, 90.0, 200.0])
    together = tilt_limits(robot, rows, headings, convention)
    assert together.shape == (len(rows), 4)
    alone = [tilt_limits(robot, row, headings, convention) for row in rows]
    np.testing.assert_array_equal(together, alone)
    np.testing.assert_array_equal(
        level_limits(robot, rows, convention),
        [posture_limits(Posture(robot, row), convention).guaranteed for row in rows],
    )


def test_the_ground_is_tilted_from_where_the_posture_stands_on_it() -> None:
    one = lutgen.load_recipe(MAPS / "paper_one.toml")
    posture = np.array([0.75])
    facet = diagnose(Posture(one, posture), [0.0, 0.0, -1.0]).facet
    assert facet is not None
    (frame,) = level_frames(one, posture[None], "plane")
    np.testing.assert_allclose(frame, gravity_transform(-facet.normal), atol=1e-12)
    heading = 0.4
    limit = tilt_limits(one, posture, [heading], "plane")[0]
    for tilt, stands in ((limit - 1e-9, True), (limit + 1e-9, False)):
        down = (frame @ tilted(tilt, heading))[None]
        angle = evaluate_each(one, posture[None], down, ("tip_angle",))["tip_angle"][0]
        assert (angle >= 0.0) is np.bool_(stands)
    # Its nose is 8 deg up on level ground, so the ground may fall by that much more than the body.
    both = [tilt_limits(one, posture, [0.0], which)[0] for which in CONVENTIONS]
    assert both[1] - both[0] == pytest.approx(math.acos(frame[2, 2]), abs=1e-12)
    assert both[1] - both[0] > 0.1


# Sliding


def test_a_level_robot_slides_at_the_angle_of_friction() -> None:
    found = slide_limits(Posture(box(), []), np.linspace(0.0, 6.0, 7))
    np.testing.assert_allclose(found, math.atan(0.7), atol=1e-12)


def test_a_body_that_leans_slides_earlier_on_the_side_that_it_leans_to() -> None:
    lean = math.radians(10.0)
    turned = [
        (x * math.cos(lean) - z * math.sin(lean), y, x * math.sin(lean) + z * math.cos(lean))
        for x, y, z in CORNERS
    ]
    recipe = parse_recipe(rigid(feet(turned), head="friction = 0.7"))
    found = slide_limits(Posture(recipe, []), [0.0, math.pi], "body")
    slope = math.atan(0.7)
    # The facet's outward normal is 10 deg ahead of straight down.
    np.testing.assert_allclose(found, [slope + lean, slope - lean], atol=1e-12)
    for heading, tilt in zip((0.0, math.pi), found, strict=True):
        states = [
            diagnose(Posture(recipe, []), tilted(tilt + d, heading)).slides for d in (-1e-9, 1e-9)
        ]
        assert states == [False, True]
    ground = slide_limits(Posture(recipe, []), [0.0, math.pi], "plane")
    np.testing.assert_allclose(ground, slope, atol=1e-12)


# All postures


@pytest.mark.parametrize("text", [tripod(), rover()], ids=["points", "discs with gaps"])
@pytest.mark.parametrize("convention", CONVENTIONS)
def test_limits_over_all_postures_are_those_of_a_double_loop(text: str, convention: str) -> None:
    robot = parse_recipe(text)
    headings = even_headings(12)
    found = sweep_limits(robot, nodes(robot), headings, convention)
    every = np.array(
        [
            [tilt_limits(robot, row, [psi], convention)[0] for psi in headings]
            for row in nodes(robot)
        ]
    )
    np.testing.assert_allclose(found.least, every.min(axis=0), atol=1e-12)
    np.testing.assert_allclose(found.most, every.max(axis=0), atol=1e-12)
    across = np.arange(12)
    np.testing.assert_allclose(every[found.least_at, across], found.least, atol=1e-12)
    np.testing.assert_allclose(every[found.most_at, across], found.most, atol=1e-12)
    assert (found.most - found.least).max() > 0.02
    alone = [posture_limits(Posture(robot, row), convention).guaranteed for row in nodes(robot)]
    assert found.guaranteed.tolist() == alone
    assert found.weakest == int(np.argmin(alone))
    assert found.strongest == int(np.argmax(alone))


def test_headings_without_the_four_and_shapes_that_do_not_fit_are_refused() -> None:
    np.testing.assert_allclose(even_headings(8)[::2], np.radians([0.0, 90.0, 180.0, 270.0]))
    for count in (0, -4, 6, 7):
        with pytest.raises(InputError, match="multiple of 4"):
            even_headings(count)
    with pytest.raises(InputError, match="at least one row"):
        sweep_limits(box(), np.empty((0, 0)), [0.0])
    with pytest.raises(InputError, match="finite headings"):
        tilt_limits(box(), [], [math.nan])
    with pytest.raises(InputError, match="unknown convention"):
        posture_limits(Posture(box(), []), "world")

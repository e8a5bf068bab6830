"""Where a robot slides first: hand-worked slopes, warped feet, flippers, and the drawn line."""

import math

import numpy as np
import pytest

import lutgen
from lutgen.analysis import Posture, diagnose, slide_limits, tilt_limits, tilted
from lutgen.errors import InputError
from tests.fixtures.places import MAPS
from tests.fixtures.pulled import moving
from tests.fixtures.recipes import feet, rigid, rover

SQUARE = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]


def table(friction, rise=0.0):
    """Return a table, 2 x 2 and 1 high, on ground that rises ahead by `rise` in the body frame."""
    places = [(x, y, -1.0 + rise * x) for x, y in SQUARE]
    head = "" if friction is None else f"friction = {friction}"
    return lutgen.parse_recipe(rigid(feet(places), name="table", head=head))


def test_it_slides_where_the_slope_s_tangent_exceeds_friction_and_a_facet_may_not_be_level():
    headings = np.radians(np.arange(0.0, 360.0, 7.0))
    for mu in (0.05, 0.5, 0.9):
        limits = slide_limits(Posture(table(mu), []), headings)
        assert limits == pytest.approx(math.atan(mu), abs=1e-12)
    # The ground rises by 0.2 ahead: with its nose down by atan 0.2 the robot is on level ground.
    limits, rise = slide_limits(Posture(table(0.5, 0.2), []), [0.0, math.pi]), math.atan(0.2)
    assert limits == pytest.approx([math.atan(0.5) + rise, math.atan(0.5) - rise], abs=1e-12)
    # Slippery feet slide there at level already, though the ground comes to lie level later.
    assert slide_limits(Posture(table(0.1, 0.2), []), [0.0, math.pi]).tolist() == [0.0, 0.0]
    with pytest.raises(InputError, match="no friction coefficient"):
        slide_limits(Posture(table(None), []), headings)


def test_it_is_what_diagnose_says_for_warped_feet_wheels_that_lift_and_forces():
    rng = np.random.default_rng(2)
    warped = [(x, y, -1.0 + 0.2 * rng.normal()) for x, y in SQUARE]
    cases = [
        (lutgen.parse_recipe(rigid(feet(warped), head="friction = 0.4")), []),
        (lutgen.parse_recipe(rover().replace("upright", "friction = 0.4\nupright")), [0.35]),
        (moving(), moving().home_params),
    ]
    headings = np.radians(np.arange(0.0, 360.0, 10.0))
    for recipe, params in cases:
        posture = Posture(recipe, params)
        limits = slide_limits(posture, headings)
        ends = np.where(np.isnan(limits), tilt_limits(recipe, params, headings), limits)
        for heading, limit, end in zip(headings, limits, ends, strict=True):
            below = diagnose(posture, tilted(end - 1e-6, heading))
            assert end < 1e-6 or (below.standing and not below.slides)
            assert np.isnan(limit) or diagnose(posture, tilted(end + 1e-6, heading)).slides
        assert np.isfinite(limits).sum() > 0


def test_a_robot_without_support_slides_on_nothing():
    line = rigid(feet([(1, 0, -1), (0, 0, -1), (-1, 0, -1)]), head="friction = 0.5")
    assert np.isnan(slide_limits(Posture(lutgen.parse_recipe(line), []), [0.0])).all()


def test_ground_slides_at_the_friction_angle_however_the_posture_leans_on_it():
    text = (MAPS / "paper_one.toml").read_text(encoding="utf-8")
    low = lutgen.parse_recipe(text.replace("[robot]", "[robot]\nfriction = 0.2", 1))
    headings = np.linspace(0.0, 6.0, 9)
    # One wheel is low: on level ground the body leans by 8.2 deg.
    ground = slide_limits(Posture(low, [0.75]), headings, "plane")
    assert ground == pytest.approx(math.atan(0.2), abs=1e-9)
    body = slide_limits(Posture(low, [0.75]), headings, "body")
    assert np.ptp(body) > math.radians(10.0)

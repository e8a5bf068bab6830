"""Driving: the paper's percentages point by point, lag, rates, turning, and what is refused."""

import math

import numpy as np
import pytest

from lutgen.channels import body_gravity, evaluate_each
from lutgen.errors import InputError
from lutgen.recipe.recipe import parse_recipe
from lutgen.search import along, drive, optimum, paper_path, turned
from tests.fixtures.recipes import feet, rigid

NOMINAL = [math.atan(0.6)] * 2
FLAT = along([[0, 0, 0], [4, 0, 0], [8, 0, 0], [12, 0, 0], [12.5, 0, 0]])
# Where the paper's robot tips over with control.
LEFT = [*range(8), *range(11, 23), 30, 31]


def paper(points=100):
    """Return the paper's path, on which its robot is turned by 30 deg to the left."""
    return turned(paper_path(points), math.pi / 6.0)


def at(run):
    return np.flatnonzero(run.tips).tolist()


def test_without_control_the_robot_tips_over_at_72_of_100_points(two):
    run = drive(two, paper(), control=False, params0=NOMINAL)
    # The edge from P1 to P3 is 10 from the com, 30 deg off the heading; dz/dx by the power rule.
    s = run.path.position[:, 0]
    slope = 15.0 * (np.sin(2.0 * s) / s - (np.sin(s) / s) ** 2)
    assert at(run) == np.flatnonzero(np.abs(slope) > 10.0 / math.cos(math.pi / 6.0) / 12.0).tolist()
    assert run.share == 0.72
    assert run.evaluations == 0
    assert (run.params == NOMINAL).all()


def test_with_control_it_tips_over_at_22(two):
    run = drive(two, paper(), params0=NOMINAL)
    assert at(run) == LEFT
    assert run.evaluations == 150 * 99


def test_right_ends_give_24_without_lag_23_and_in_the_attitude_of_the_ground_28(two):
    for options, tips in (({}, 24), ({"lag": 0}, 23), ({"convention": "body"}, 28)):
        run = drive(two, paper(), params0=NOMINAL, ends="right", **options)
        assert run.tips.sum() == tips


def test_a_run_is_the_verdict_of_the_attitudes_that_the_robot_takes(two):
    run = drive(two, paper(20), params0=NOMINAL, headings=3)
    taken = turned(run.path, run.turn)
    down = body_gravity(two, run.params, taken.gravity, "plane")
    np.testing.assert_array_equal(run.gravity_body, down)
    np.testing.assert_array_equal(run.heading, taken.heading)
    exact = evaluate_each(two, run.params, down, ["sdg", "height", "tip_angle", "margin"])
    assert list(run.channels) == list(exact)
    for name, values in exact.items():
        np.testing.assert_array_equal(run.channels[name], values)
    np.testing.assert_array_equal(run.tips, exact["tip_angle"] < 0.0)
    # A lag longer than the path is no control, and equal ground is searched once.
    late = drive(two, paper(5), lag=5, params0=NOMINAL)
    assert (late.params == NOMINAL).all()
    assert (late.evaluations, drive(two, FLAT, lag=0).evaluations) == (0, 150)


def test_control_takes_what_the_search_finds_for_the_point_before(two):
    path = paper(7)
    run = drive(two, path, params0=NOMINAL, method="nelder-mead", objective="tip_angle")
    assert (run.params[0] == NOMINAL).all()
    for i in range(6):
        found = optimum(two, path.gravity[i], "nelder-mead", "tip_angle", convention="plane")
        np.testing.assert_array_equal(run.params[i + 1], found.params)


@pytest.mark.parametrize("lag", [1, 3])
def test_lag_shifts_what_control_does(two, lag):
    path = paper(12)
    at_once = drive(two, path, lag=0, headings=3)
    late = drive(two, path, lag=lag, headings=3)
    np.testing.assert_array_equal(late.params[lag:], at_once.params[:-lag])
    np.testing.assert_array_equal(late.turn[lag:], at_once.turn[:-lag])
    # Before that the middle of the ranges, and no turn.
    assert (late.params[:lag] == math.radians(25.0)).all()
    assert (late.turn[:lag] == 0.0).all()
    assert len(np.unique(at_once.params)) > 2
    assert len(np.unique(at_once.turn)) > 1


def test_a_limited_parameter_goes_there_as_fast_as_it_can(two):
    rates = {"alpha": math.radians(2.0)}
    start = np.radians([20.0, 20.0])
    run = drive(two, FLAT, params0=start, rates=rates, speed=2.0, lag=0)
    # 2 deg/s at 2 per second and steps of 4, 4, 4 and 0.5: 4, 4, 4 and 0.5 deg each.
    np.testing.assert_allclose(np.degrees(run.params[:, 0]), [20, 24, 28, 30.9568, 30.9568])
    # gamma has no limit, and follows at once.
    np.testing.assert_allclose(np.degrees(run.params[:, 1]), 30.9568)
    np.testing.assert_allclose(np.degrees(run.wanted), 30.9568)
    # What is reached is what is judged.
    assert run.channels["sdg"][0] > 0.1
    assert run.channels["sdg"][3] < 0.001


def test_a_long_robot_turns_its_long_side_to_the_slope():
    # Four times as long as wide: it stands lengthwise on 30 deg, not across.
    text = feet([(2, 0.5, -1), (2, -0.5, -1), (-2, 0.5, -1), (-2, -0.5, -1)])
    path = along([[0, 0, 0], [0, 1, math.tan(math.radians(30.0))]], heading=[0.0, 0.0])
    options = {"control": False, "lag": 0, "objective": "tip_angle"}
    recipe = parse_recipe(rigid(text))
    assert drive(recipe, path, **options).share == 1.0
    run = drive(recipe, path, headings=4, **options)
    assert run.share == 0.0
    # Both ways along the slope are as good; the first is to the left.
    np.testing.assert_allclose(run.turn, math.pi / 2)
    # Then the sides are nearest: their planes are inclined by atan(1/2) to the com's vertical.
    sine = math.cos(math.radians(30.0)) * math.sin(math.atan(0.5))
    np.testing.assert_allclose(run.channels["tip_angle"], math.asin(sine))


def test_what_makes_no_sense_is_refused(two):
    for options, said in (
        ({"method": "guess"}, "unknown method 'guess'"),
        ({"speed": 1.0}, "need a speed, and a speed needs rates"),
        ({"rates": {"alpha": -1.0}, "speed": 1.0}, "rate of alpha must be 0 or more"),
        ({"rates": {"beta": 1.0}, "speed": 1.0}, "no parameter 'beta' to limit"),
    ):
        with pytest.raises(InputError, match=said):
            drive(two, FLAT, **options)
    rigid_one = parse_recipe(rigid(feet([(1, 0, -1), (-1, 1, -1), (-1, -1, -1)])))
    with pytest.raises(InputError, match="no geometry parameter"):
        drive(rigid_one, FLAT)
    assert drive(rigid_one, FLAT, control=False).share == 0.0

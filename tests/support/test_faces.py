"""Wheels that lie on their faces carry nobody: how near a plane's normal a carrying axle may be."""

import math

import numpy as np
import pytest

from lutgen import evaluate
from lutgen.recipe import parse_recipe
from tests.fixtures.recipes import contact, rigid

OK, TIPS = 0, 2
FEET = ((0.5, 0.4, 0.0), (-0.5, 0.4, 0.0), (0.0, -0.6, 0.0))


def stands(leaning, upright, discs=3):
    """Tell whether a robot stands level on feet of which some are discs, `leaning` off a coin."""
    a = math.radians(leaning)
    feet = "".join(
        contact(f"F{k}", place, 0.1, (0.0, math.sin(a), math.cos(a)))
        if k < discs
        else contact(f"F{k}", (*place[:2], -0.1 * math.sin(a)))
        for k, place in enumerate(FEET)
    )
    body = '[[robot.link]]\nname = "body"\nmass = 1.0\ncom = [0, 0, 0.5]\n'
    recipe = parse_recipe(rigid(body + feet, head=f"upright = {upright}"))
    status = evaluate(recipe, np.zeros((1, 0)), [[0.0, 0.0, -1.0]], ("status",))["status"]
    assert status.item() in (OK, TIPS)
    return bool(status.item() == OK)


@pytest.mark.parametrize("discs", [1, 3])
def test_nobody_stands_on_the_face_of_a_wheel(discs):
    assert not stands(9.99, 80.0, discs)
    assert stands(10.01, 80.0, discs)
    # As for wheels on level axles, of which `upright` says the same.
    assert not stands(4.99, 85.0, discs)
    assert stands(5.01, 85.0, discs)
    assert stands(10.01, 45.0, discs)
    # A robot that may lie on its side may lie on its wheels.
    assert stands(0.1, 90.0)
    assert stands(0.1, 180.0)

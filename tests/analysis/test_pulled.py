"""Slopes, friction and metrics of a robot that something pulls at."""

import pytest

import lutgen
from lutgen import parse_recipe
from lutgen.analysis.diagnosis import diagnose
from lutgen.analysis.metrics import compare_metrics
from lutgen.analysis.posture import Posture
from tests.fixtures.pulled import BOX, LEVEL, moving, pull, robot
from tests.fixtures.recipes import feet, tripod


def test_the_slope_is_that_of_the_resultant() -> None:
    params, g = moving().home_params, moving().chart.directions().reshape(-1, 3)[24]
    found, alone = (diagnose(Posture(one, params), g) for one in (moving(), parse_recipe(tripod())))
    # About 10 N across 64 N.
    assert abs(found.slope - alone.slope) > 0.02


def test_what_knows_the_weight_alone_refuses_forces() -> None:
    pulled, uncertain = robot(feet(BOX), pull((5, 0, 0))), robot(feet(BOX), rho=0.01)
    with pytest.raises(lutgen.InputError, match="counts the weight and no other force"):
        compare_metrics(Posture(pulled, []), LEVEL)
    with pytest.raises(lutgen.InputError, match="metrics are those of one com"):
        compare_metrics(Posture(uncertain, []), LEVEL)

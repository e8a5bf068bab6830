"""Slopes, friction and metrics of a robot that something pulls at."""

import numpy as np
import pytest
from numpy.typing import NDArray

import lutgen
from lutgen.analysis.diagnosis import diagnose
from lutgen.analysis.metrics import compare_metrics
from lutgen.analysis.posture import Posture
from lutgen.analysis.sliding import slides_first, slopes
from tests.fixtures.pulled import BOX, LEVEL, moving, pull, robot
from tests.fixtures.recipes import feet, tripod

Floats = NDArray[np.float64]


def test_the_slope_is_that_of_the_resultant_and_friction_is_asked_of_it() -> None:
    recipe = moving()
    params = recipe.grid.params(np.arange(recipe.grid.size))
    g = recipe.chart.directions().reshape(-1, 3)
    got = slopes(recipe, params, np.broadcast_to(g, (len(params), *g.shape)))
    slides = slides_first(recipe, params, g)
    assert slides.any()
    assert not slides.all()
    for i, j in ((0, 3), (5, 24), (11, 40)):
        found = diagnose(Posture(recipe, params[i]), g[j])
        assert got[i, j] == pytest.approx(found.slope, abs=1e-7)
        assert slides[i, j] == found.slides
    # About 10 N across 64 N.
    assert (
        abs(got[0, 24] - diagnose(Posture(lutgen.parse_recipe(tripod()), params[0]), g[24]).slope)
        > 0.02
    )


def test_what_knows_the_weight_alone_refuses_forces() -> None:
    pulled, uncertain = robot(feet(BOX), pull((5, 0, 0))), robot(feet(BOX), rho=0.01)
    with pytest.raises(lutgen.InputError, match="counts the weight and no other force"):
        compare_metrics(Posture(pulled, []), LEVEL)
    with pytest.raises(lutgen.InputError, match="metrics are those of one com"):
        compare_metrics(Posture(uncertain, []), LEVEL)

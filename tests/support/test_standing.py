"""Readings of postures of every kind against a slow second reading of the definition.

With LUTGEN_LONG=1 500 postures of chance and 252 exact ones are asked in 200 directions each.
"""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
import pytest

from tests.fixtures.length import LONG
from tests.oracles.primitives import size_of
from tests.oracles.standing import ROCKS, TIPS, Standing
from tests.support.postures import EXACT, FAMILIES, asked, drawn, exact, limits_of, read

# What straight sides of a gap may bulge beyond the curve, and 3e-5 deg of the oracle's polylines.
BULGE = math.radians(1e-3)
# What the sides of gaps are moved in by at the median, in 99 of 100 readings, and at most.
SHORT = math.radians(1e-4), math.radians(0.3), math.radians(3.0)


class Compared(NamedTuple):
    """Readings of the oracle and of lutgen (4, k); angles to the boundary, gaps, levers."""

    truth: np.ndarray
    found: np.ndarray
    away: np.ndarray
    gaps: np.ndarray
    lever: np.ndarray


@cache
def compared(family):
    """Compare the postures of a family; lengths are divided by the size."""
    parts = []
    few, many = (4, 125) if family in FAMILIES else (2, 36)
    for seed in range(many if LONG else few):
        rng = np.random.default_rng(seed)
        rows = drawn(family, rng) if family in FAMILIES else exact(family, rng)
        limits = limits_of(rows)
        standing = Standing(rows, limits)
        g = asked(standing, 200 if LONG else 100, rng)
        *values, lever = standing.read(g)
        truth, found = np.stack(values), np.stack([*read(rows, g, limits=limits).values()])
        truth[2:] /= size_of(rows)
        found[2:] /= size_of(rows)
        gaps = np.full(len(g), float(len(standing.gaps)))
        parts.append([*truth, *found, standing.distance(g), gaps, lever])
    table = np.concatenate([np.array(part) for part in parts], 1)
    return Compared(table[:4], table[4:8], *table[8:])


ALL = pytest.mark.parametrize("family", [*FAMILIES, *EXACT])


@ALL
def test_no_robot_stands_or_rocks_where_the_definition_says_that_it_tips(family):
    of = compared(family)
    stands, tips = of.found[0] != TIPS, of.truth[0] == TIPS
    # Within rounding of an edge that does not bend either may say what it likes.
    clear = of.away > np.where(of.gaps > 0, BULGE, 1e-12)
    assert not (stands & tips & clear).any()
    # Both answers are common, or this would say little.
    assert 0.1 < tips.mean() < 0.9


@ALL
def test_no_direction_that_stands_is_lost(family):
    of = compared(family)
    lost = (of.found[0] == TIPS) & (of.truth[0] != TIPS) & (of.away > 1e-12)
    # The sides of gaps are straight and lie within the curves.
    allowed = np.where(of.truth[0] == ROCKS, SHORT[2], 0.0)
    assert (of.away[lost] <= allowed[lost]).all()
    both = (of.found[0] != TIPS) & (of.truth[0] != TIPS)
    assert (of.found[0] == of.truth[0])[both & (of.away > 1e-9)].all()


@ALL
def test_the_tip_angle_is_exact_without_gaps_and_never_above_the_truth_with_them(family):
    of = compared(family)
    both = (of.found[0] != TIPS) & (of.truth[0] != TIPS)
    more = (of.found[1] - of.truth[1])[both]
    rigid = of.gaps[both] == 0
    # Planes of contacts 1e-9 of the size off them are told by which contacts they are laid through.
    exact_to = 1e-8 if family == "all but flat" else 1e-11
    assert np.abs(more[rigid]).max(initial=0.0) < exact_to
    tips = (of.gaps == 0) & (of.found[0] == TIPS) & (of.truth[0] == TIPS)
    off = np.abs(of.found[1] - of.truth[1])[tips]
    assert off.max(initial=0.0) < exact_to
    assert more.max() < BULGE
    less = -more[~rigid]
    if len(less) > 300:
        assert np.median(less) < SHORT[0]
        assert np.percentile(less, 99) < SHORT[1]
    assert np.ptp(of.truth[1]) > 0.5


@ALL
def test_the_stability_factor_and_the_height_are_those_of_the_definition(family):
    of = compared(family)
    both = (of.found[0] != TIPS) & (of.truth[0] != TIPS) & (of.found[0] == of.truth[0])
    off = np.abs(of.found - of.truth)[2:, both]
    # Planes of contacts that are 1e-9 of the size off them differ by twice that, and s by as much.
    exact_to = 3e-9 * of.lever[both] if family == "all but flat" else 1e-9
    assert (off < exact_to).all()
    assert np.isnan(of.found[2:, of.found[0] == TIPS]).all()
    assert np.ptp(of.truth[2][both]) > 0.1

"""Checks of the path simulation, Eqs 30 to 34, for the paper's robot."""

from statistics import NormalDist

import numpy as np

from lutgen.paper import printed
from lutgen.paper.closed_form import path_height, path_slope, tipping_points
from lutgen.paper.erratum import Checks, Example, check
from lutgen.paper.nominal import NOMINAL, TO_THE_LEFT, Array, tripods
from lutgen.paper.published import CONTROLLED, POINTS, UNCONTROLLED

# The end of the path is reconstructed; at its beginning sin(x)/x has no value.
BEGIN, END = 1e-6, 4.0 * np.pi
# Standard deviations of a Gaussian about the path's middle, as parts of the path.
PARTS = (4, 5, 6, 8)


def equal_spacing(points: int) -> Array:
    """Return values of s, (points,), from just above 0 to 4 pi."""
    return np.linspace(BEGIN, END, points)


def gaussian_spacing(points: int, parts: int) -> Array:
    """Return values of s, (points,): quantiles of a Gaussian of deviation END/parts."""
    normal = NormalDist(END / 2.0, END / parts)
    quantiles = [normal.inv_cdf((i + 0.5) / points) for i in range(points)]
    return np.clip(quantiles, BEGIN, END)


def steeper_than_the_limit(points: int) -> int:
    """Return how many equally spaced points are too steep, from the wheels' triangle alone."""
    wheels = tripods(np.array(NOMINAL), np.array(NOMINAL), TO_THE_LEFT)
    # Below the heading the edge from wheel 1 to wheel 3 is nearest; where it crosses y = 0:
    (x1, y1, z1), (x3, y3, _) = wheels[0], wheels[2]
    ahead = x1 - y1 * (x3 - x1) / (y3 - y1)
    # dz/dx by the power rule on the printed quotient.
    s = equal_spacing(points)
    slope = 15.0 * (np.sin(2.0 * s) / s - (np.sin(s) / s) ** 2)
    return int((np.abs(slope) > ahead / -z1).sum())


def singularities(_: Example) -> Checks:
    """Compare the path at 0: the printed quotients, their limits, and their values nearby."""
    near = 1e-8
    before, at, after = (printed.eq33(x) for x in (-near, 0.0, near))
    yield check("$y$ at $s = 0$", printed.eq32(0.0), 0.8 * np.sinc(0.0), printed.eq32(near))
    # z is 15 s near 0.
    yield check("$z$ at $s = 0$", at, path_height(0.0), (after + before) / 2.0)
    rise = (after - before) / (2.0 * near)
    yield check("$dz/dx$ at $s = 0$", (after - at) / near, path_slope(0.0), rise)


def spacing(_: Example) -> Checks:
    """Compare how many points tip with control: Gaussian spacings, equal spacing, and the print."""
    even = tipping_points(equal_spacing(POINTS), control=True)
    for parts in PARTS:
        gaussian = tipping_points(gaussian_spacing(POINTS, parts), control=True)
        claim = (
            f"points that tip with control; as printed: Gaussian, $sigma$ = 1/{parts} of the path"
        )
        yield check(claim, gaussian, even, CONTROLLED)


def uncontrolled(_: Example) -> Checks:
    """Compare how many points tip without control: the print, closed form, the slope's limit."""
    claim = f"of {POINTS} points at equal spacing on $[0, 4 π]$, those at which the robot tips"
    found = tipping_points(equal_spacing(POINTS))
    yield check(claim, UNCONTROLLED, found, steeper_than_the_limit(POINTS))

"""Errata of the path simulation, Eqs 30 to 34."""

import numpy as np

from lutgen.paper import printed
from lutgen.paper.closed_form import NOMINAL, path_height, path_slope, tipping_points, tripods
from lutgen.paper.erratum import Array, Erratum, check

# Printed: how many of how many points tip.  The end of the path is reconstructed.
TIPPING, POINTS = 72, 100
END = 4.0 * np.pi


def errata() -> tuple[Erratum, ...]:
    """Return the errata of the path simulation, for the paper's robot."""
    return (_singularities(), _spacing(), _uncontrolled())


def equal_spacing(points: int) -> Array:
    """Return values of s, (points,), from just above 0 to 4 pi."""
    return np.linspace(1e-6, END, points)


def steeper_than_the_limit(points: int) -> int:
    """Return how many equally spaced points are too steep, from the wheels' triangle alone."""
    wheels = tripods(np.array([NOMINAL]), np.array([NOMINAL]), 30.0)[0]
    # Below the heading the edge from wheel 1 to wheel 3 is nearest; where it crosses y = 0:
    (x1, y1, z1), (x3, y3, _) = wheels[0], wheels[2]
    ahead = x1 - y1 * (x3 - x1) / (y3 - y1)
    # dz/dx by the power rule on the printed quotient.
    s = equal_spacing(points)
    slope = 15.0 * (np.sin(2.0 * s) / s - (np.sin(s) / s) ** 2)
    return int((np.abs(slope) > ahead / -z1).sum())


def _singularities() -> Erratum:
    near = 1e-8
    rise = (printed.eq33(near) - printed.eq33(-near)) / (2.0 * near)
    checks = (
        check("y at s = 0", printed.eq32(0.0), 0.8 * np.sinc(0.0), printed.eq32(near)),
        # z is 15 s near 0.
        check(
            "z at s = 0",
            printed.eq33(0.0),
            path_height(0.0),
            (printed.eq33(near) + printed.eq33(-near)) / 2.0,
        ),
        check(
            "dz/dx at s = 0",
            (printed.eq33(near) - printed.eq33(0.0)) / near,
            path_slope(0.0),
            rise,
        ),
    )
    return Erratum(
        "Eqs 32 and 33",
        "y = 0.8 sin x/x, z = 15 sin^2 x/x",
        "the same with y(0) = 0.8, z(0) = 0, dz/dx(0) = 15",
        "Both are 0/0 at the start of the path; the singularities are removable.",
        checks,
    )


def _spacing() -> Erratum:
    return Erratum(
        "path simulation, text",
        "100 points (with normal distribution of the path)",
        "100 points at equal spacing in s",
        "As before Eq 20, normal stands for even.  Neither interval nor spacing is printed: equal "
        "spacing on [0, 4 pi] gives the printed 72 %, but Gaussian spacings give 71 to 74 %, so "
        "the count alone does not decide.",
    )


def _uncontrolled() -> Erratum:
    checks = (
        check(
            "of 100 points at equal spacing on [0, 4 pi], those at which the robot tips",
            TIPPING,
            tipping_points(equal_spacing(POINTS)),
            steeper_than_the_limit(POINTS),
        ),
    )
    return Erratum(
        "path simulation, uncontrolled",
        "the robot would tip over on the 72% of the path",
        "as printed",
        "Reconstruction: gravity's ray leaves the triangle where |dz/dx| > 0.962.  Consistent "
        "with the paper, which does not print the geometry.",
        checks,
        confirmed=True,
    )

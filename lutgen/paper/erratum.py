"""What one erratum of the paper is, and the robot on which it is computed.

Owns the types only; the words of the errata are in `errata.toml`, their checks in the files
`checks_*`, and `errata` puts both together.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import SupportsFloat

import numpy as np

from lutgen.paper.nominal import Array

# Two ways to the same number differ by less than this: the numbers are below 1000 and pass a few
# 3 x 3 solves, which lose some digits of 1e-16 on a narrow triangle.
ROUNDING = 1e-9
AXES = "xyz"
# Three contacts of a scalene, slightly tilted triangle, and the places of three point masses.
WHEELS = ((10.0, -1.0, -6.0), (-6.0, 9.0, -6.5), (-5.0, -8.0, -7.0))
ELEMENTS = ((2.0, 0.0, 1.0), (-1.0, 3.0, 0.0), (0.0, -1.0, 4.0))


@dataclass(frozen=True)
class Check:
    """One number that decides, computed in three ways.

    `claim` says in words what was computed, formulas between dollar signs, see `markup`.
    `printed` is what the printed form gives, NaN for 0/0; `ours` what the corrected form gives;
    `reference` the same quantity by an independent way.  `ours` may be `tolerance` from the
    reference: more than rounding only where the paper's numbers have few digits or its geometry
    had to be reconstructed.
    """

    claim: str
    printed: float
    ours: float
    reference: float
    tolerance: float = ROUNDING


# What one function checks: one number after the other.
Checks = Iterator[Check]


def check(
    claim: str,
    printed: SupportsFloat,
    ours: SupportsFloat,
    reference: SupportsFloat,
    tolerance: float = ROUNDING,
) -> Check:
    """Return a check of plain floats, whatever kinds of number come in."""
    return Check(claim, float(printed), float(ours), float(reference), tolerance)


def coordinates(name: str, printed: Array, ours: Array, reference: Array) -> Checks:
    """Return one check for each coordinate of a point, all (3,)."""
    for i, axis in enumerate(AXES):
        yield check(f"${axis}$ of {name}", printed[i], ours[i], reference[i])


@dataclass(frozen=True)
class Erratum:
    """One place of the paper: what is printed, what is right, and the numbers that tell.

    `place` is such as "Eq 27", and no two errata have the same; `printed`, `correct` and `why`
    have formulas between dollar signs, see `markup`; there is at least one check.  `confirmed`
    is True for a place that was checked and is right as printed: all three numbers agree.
    """

    place: str
    printed: str
    correct: str
    why: str
    checks: tuple[Check, ...]
    confirmed: bool = False


@dataclass(frozen=True, eq=False)
class Example:
    """The robot and the direction of gravity on which the errata are computed.

    Nothing depends on this choice but the numbers: any tripod whose plane is neither horizontal
    nor vertical shows the same errata, as long as gravity's ray and the plane's normal through
    the com go through its triangle.

    Wheels (3, 3) relative to the com, below it, in no particular order; gravity (3,) pointing
    down, any length; places (k, 3) and masses (k,) of the elements for Eqs 13 to 18, in any
    frame; the seed of the random directions and contact sets.
    """

    wheels: Array = field(default_factory=lambda: np.array(WHEELS))
    gravity: Array = field(default_factory=lambda: np.array([0.9, -1.5, -9.5]))
    elements: Array = field(default_factory=lambda: np.array(ELEMENTS))
    masses: Array = field(default_factory=lambda: np.array([1.0, 2.0, 3.0]))
    seed: int = 20

"""Three contact points: their order in the tables, the checks of the runtime, the guard.

The contacts are exact but for rounding.  So the guard is what single precision can turn the
tip-over planes: an edge normal E = P x Q is off by 2 e |P| + 4 u |P| |Q| with e the error of a
contact, and turns by that over |E|.  Where the least |E| over the box is bounded nothing
else is needed.  Where the box holds postures in which the com comes close to a tip-over axis,
facets that are low are refused: |E| is at least the side's length times the height of the com over
the facet.

For a robot given by code the contacts are `off` by more.  That is no worse than a com that may be
anywhere in a ball of that radius: each point of an edge is off by no more than its ends are, so
its direction turns by no more than asin(off / its distance), and no edge is nearer than the facet's
plane.
"""

import math
from typing import NamedTuple

import numpy as np

from firmware_export.model import Model, combinations, least_edge_of, rounds
from lutgen.channels import acceptance_of
from lutgen.vector import Floats

EITHER_WAY = 128
# The runtime reads this as no limit of the normal.
ANY = -2.0
POSTURES = 20_000
# rad; the guard that is aimed at where low facets have to be refused, and rounding of the rest: the
# direction, the chart's rim, scalar product, root, quotients, arcsine.
AIM, ROUNDING = 2e-4, 4e-6
HALF_UNIT = 2.0**-24
# Parts of the size by which a limit is kept, beyond rounding.
HAIR = 1e-5
# For a robot given by code: facets lower than this part of what all but a few postures have are
# refused, and narrower ones than this part of the reach where nothing else says how narrow.
LOW, FEW, NARROWEST = 0.5, 0.001, 1e-3


class Three(NamedTuple):
    """Extras of the tables of three points, beside positions.

    `code`, the order of the contacts as the runtime has it; the thresholds `lowest`
    (length), `steepest`, `rest_width` (length); the `guard` (rad), and a sentence about it.
    """

    code: int
    lowest: float
    steepest: float
    rest_width: float
    guard: float
    text: str


def three_of(model: Model, error: float, off: float = 0.0) -> Three:
    """Return what the tables need of a robot.

    `error` is how far (length) rounding may misplace a contact of a closed form; `off`, above 0
    for a robot given by code, how far all is off together.
    """
    recipe = model.recipe
    accept = acceptance_of(recipe)
    rho = recipe.com_uncertainty + off
    width = accept.rest_width if math.isfinite(accept.rock_angle) else 0.0
    places = max(2, math.floor(POSTURES ** (1.0 / max(model.k, 1))))
    lattice = combinations([np.linspace(0.0, 1.0, places)] * model.k)
    p = model.postures(model.at(lattice)).centres
    reach = float(np.sqrt((p**2).sum(axis=2)).max())
    least = least_edge_of(model) if off == 0.0 else 0.0
    wrong = 2.0 * error * reach + 4.0 * HALF_UNIT * reach**2
    first, second, third = rounds(model)
    code = first | second << 2 | third << 4
    text = "what rounding to single precision can turn a tip-over plane"
    if least > 0.0 and wrong / least < AIM:
        return Three(code, 0.0, ANY, 0.0, ROUNDING + wrong / least, text)
    sides = np.stack([p[:, i] - p[:, i - 2] for i in range(3)], axis=1)
    side = max(float(np.sqrt((sides**2).sum(axis=2)).min()), width, 1e-3 * reach)
    lowest = rho + wrong / (AIM * side)
    # The com anywhere in its ball: the plane of an axis turns by asin(rho / d), d the axis'
    # distance.
    edges = np.cross(p, np.roll(p, -1, axis=1))
    away = np.sqrt((edges**2).sum(axis=2)) / np.sqrt((sides**2).sum(axis=2))[:, [2, 0, 1]]
    nearest, turn = max(float(away.min()), lowest), 0.0
    if off > 0.0:
        # Nothing that only some postures show: the runtime checks these itself.
        lowest = max(lowest, LOW * _usual_height(p, accept.steepest))
        width = max(width, NARROWEST * reach)
        nearest, turn = lowest - off, 2.0 * off / width
        text += f", with contacts off by up to {off:.2g}"
    ball = math.asin(min(1.0, rho / nearest)) if rho > 0.0 else 0.0
    guard = ROUNDING + AIM + ball
    if recipe.com_uncertainty > 0.0:
        text += ", and a com anywhere in its ball"
    upright = recipe.upright < math.pi
    return Three(
        code | EITHER_WAY,
        lowest,
        accept.steepest + HAIR + turn if upright else ANY,
        width * (1.0 + HAIR) + HAIR * reach + 2.0 * off if width > 0.0 else 0.0,
        guard,
        f"{text}; facets less than {lowest:.3g} below the com are refused",
    )


def _usual_height(p: Floats, steepest: float) -> float:
    """Return the height of the com that all but a few of the facets (m, 3, 3) have that carry."""
    normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    normal /= np.maximum(np.sqrt((normal**2).sum(axis=1, keepdims=True)), 1e-300)
    high = (normal * p[:, 0]).sum(axis=1)
    carries = -normal[:, 2] * np.sign(high) > steepest
    return float(np.quantile(np.abs(high[carries]), FEW)) if carries.any() else 0.0

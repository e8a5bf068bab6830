"""Three contact points: their order in the tables, what the runtime has to ask, the guard.

The contacts are exact but for rounding.  So the guard is what single precision can turn the
tip-over planes: an edge normal E = P x Q is off by 2 e |P| + 4 u |P| |Q| with e the error of a
contact, and turns by that over |E|.  Where the least |E| over the box is bounded (`poly`) nothing
else is needed.  Where the box holds postures in which the com comes close to a tip-over axis,
facets that are low are refused: |E| is at least the side's length times the height of the com over
the facet.
"""

import math
from typing import NamedTuple

import numpy as np

from firmware_export.truth import Model, combinations, least_edge_of, rounds
from lutgen.channels import acceptance_of

EITHER_WAY = 128
# What the runtime takes for no limit of the normal.
ANY = -2.0
POSTURES = 20_000
# rad; the guard that is aimed at where low facets have to be refused, and rounding of the rest: the
# direction, the chart's rim, scalar product, root, quotients, arcsine.
AIM, ROUNDING = 2e-4, 4e-6
HALF_UNIT = 2.0**-24
# Parts of the size by which a limit is kept, beyond rounding.
HAIR = 1e-5


class Three(NamedTuple):
    """What the tables of three points need beside positions.

    `order` of the contacts and `code`, the same as the runtime has it; the thresholds `lowest`
    (length), `steepest`, `rest_width` (length); the `guard` (rad), and a sentence about it.
    """

    order: tuple[int, int, int]
    code: int
    lowest: float
    steepest: float
    rest_width: float
    guard: float
    text: str


def three_of(model: Model, error: float) -> Three:
    """Return what the tables need; `error` is how far (length) a contact is off."""
    recipe = model.recipe
    accept = acceptance_of(recipe)
    rho = recipe.com_uncertainty
    width = accept.rest_width if math.isfinite(accept.rock_angle) else 0.0
    places = max(2, math.floor(POSTURES ** (1.0 / max(model.k, 1))))
    lattice = combinations([np.linspace(0.0, 1.0, places)] * model.k)
    p = model.postures(model.at(lattice)).centres
    reach = float(np.sqrt((p**2).sum(axis=2)).max())
    least = least_edge_of(model)
    wrong = 2.0 * error * reach + 4.0 * HALF_UNIT * reach**2
    order = rounds(model)
    text = "what rounding to single precision can turn a tip-over plane"
    if least > 0.0 and wrong / least < AIM:
        return Three(order, _code(order), 0.0, ANY, 0.0, ROUNDING + wrong / least, text)
    sides = np.stack([p[:, i] - p[:, i - 2] for i in range(3)], axis=1)
    side = max(float(np.sqrt((sides**2).sum(axis=2)).min()), width, 1e-3 * reach)
    lowest = rho + wrong / (AIM * side)
    # The com anywhere in its ball: the plane of an axis turns by asin(rho / d), d the axis'
    # distance.
    edges = np.cross(p, np.roll(p, -1, axis=1))
    away = np.sqrt((edges**2).sum(axis=2)) / np.sqrt((sides**2).sum(axis=2))[:, [2, 0, 1]]
    ball = math.asin(min(1.0, rho / max(float(away.min()), lowest))) if rho > 0.0 else 0.0
    guard = ROUNDING + AIM + ball
    if ball:
        text += ", and a com anywhere in its ball"
    upright = recipe.upright < math.pi
    return Three(
        order,
        _code(order) | EITHER_WAY,
        lowest,
        accept.steepest + HAIR if upright else ANY,
        width * (1.0 + HAIR) + HAIR * reach if width > 0.0 else 0.0,
        guard,
        f"{text}; facets less than {lowest:.3g} below the com are refused",
    )


def _code(order: tuple[int, int, int]) -> int:
    """Return the order as the runtime has it."""
    return order[0] | order[1] << 2 | order[2] << 4

"""Score postures on slopes: what makes one posture better than another."""

import math
import re
from collections.abc import Callable

import numpy as np

from firmware_export.truth import Model, combinations
from lutgen.channels import body_gravity, evaluate_each
from lutgen.errors import InputError
from lutgen.vector import Floats

# Postures of the lattice at most.
POSTURES = 4200
# A score of what tips: below every other.
TIPS = -1e3
_PRICED = re.compile(r"tip_angle\s*-\s*([0-9.]+)\s*\*\s*move2$")
WORDS = "tip_angle, tip_angle-X*move2, move, sdg"


# Scores of tip angles (rad), |SD_g| and squared moves from home (rad): the larger, the better.
Score = Callable[[Floats, Floats, Floats], Floats]


def score_of(objective: str, margin: float) -> Score:
    """Return the score of an objective.

    ``tip_angle``, of which ``tip_angle-X*move2`` takes X rad for a move of 1 rad; ``move``: the
    smallest move that has the tip angle `margin`; ``sdg``: the smallest |SD_g|, as in the paper.
    """
    priced = _PRICED.match(objective.strip())
    if not priced and objective not in ("tip_angle", "move", "sdg"):
        raise InputError(f"--objective: unknown objective (got {objective!r}); one of {WORDS}.")
    price = float(priced[1]) if priced else 0.0

    def score(tip: Floats, sdg: Floats, move2: Floats) -> Floats:
        if objective == "sdg":
            value = -sdg
        elif objective == "move":
            value = np.where(tip >= margin, math.pi - np.sqrt(move2), tip - math.pi)
        else:
            value = tip - price * move2
        return np.asarray(np.where(tip >= 0.0, value, TIPS + tip))

    return score


def lattice(model: Model) -> Floats:
    """Return the postures (p, k) that are tried; a joint that turns round has no end twice."""
    places = max(2, int(POSTURES ** (1.0 / max(model.k, 1))))
    axes = [
        np.linspace(low, high, places, endpoint=high - low < 2.0 * math.pi - 1e-6)
        for low, high in zip(model.lower, model.upper, strict=True)
    ]
    return np.asarray(combinations(axes))


def read(model: Model, postures: Floats, slopes: Floats, convention: str) -> tuple[Floats, Floats]:
    """Return tip angle (rad) and |SD_g|, each (m,), of postures (m, k) on slopes (m, 3) or (3,)."""
    downs = body_gravity(model.recipe, postures, slopes, convention)
    found = evaluate_each(model.recipe, postures, downs, ("sdg", "tip_angle"))
    return found["tip_angle"], found["sdg"]


def measured(
    model: Model, postures: Floats, slopes: Floats, convention: str
) -> tuple[Floats, Floats]:
    """Return tip angle (rad) and |SD_g|, each (s, p), of every posture (p, k) on slopes (s, 3)."""
    each = [read(model, postures, slope, convention) for slope in slopes]
    return np.stack([tip for tip, _ in each]), np.stack([sdg for _, sdg in each])

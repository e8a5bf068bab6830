"""Objective of a search: one channel, or a weighted sum of several.

Channels of which more is better count with their sign turned, so a cost is always minimised.  A
geometry in which the robot tips costs more than any in which it stands, and the more the farther it
is from standing, so that a search that begins there finds its way out.
"""

import re
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.channels import CONVENTIONS, checked_directions, evaluate_each
from lutgen.errors import InputError, reject
from lutgen.quantities import QUANTITIES, RANKED, UNLOADED
from lutgen.recipe import Recipe

# Added to the cost of a geometry that tips.  Larger than any length in a recipe's unit; the angle
# by which the robot tips still counts to 1e-6 rad beside it.
TIPS = 1e9
# Postures evaluated at once; bounds the memory of a search over many nodes.
AT_ONCE = 65536
NUMBER = r"[0-9]*\.?[0-9]+(?:[eE][-+]?[0-9]+)?"


def parse_objective(text: str) -> dict[str, float]:
    """Return the weight of each channel of an objective; `InputError` for anything else.

    It is a channel, or a sum such as ``sdg + 0.1*height``; weights are above 0, and every channel
    pulls to its own good end: see `lutgen.quantities`.
    """
    weights: dict[str, float] = {}
    for term in text.split("+"):
        match = re.fullmatch(rf"\s*(?:({NUMBER})\s*\*\s*)?([a-z_]+)\s*", term)
        name = match.group(2) if match else ""
        weight = float(match.group(1) or 1.0) if match else 0.0
        if name not in RANKED or name in weights or not 0.0 < weight < np.inf:
            raise InputError(
                f"objective {text!r} is not understood (got the term {term.strip()!r}); write one "
                f"of {', '.join(RANKED)}, or a sum such as sdg+0.1*height with each of them once"
            )
        weights[name] = weight
    return weights


@dataclass
class Objective:
    """The cost of geometries of one robot on one ground, counting its evaluations.

    `gravity` (3,) points down, any length > 0, in the frame that `convention` names, see
    `channels.resting`; `text` is that of `parse_objective`.
    """

    recipe: Recipe
    gravity: ArrayLike
    text: str = "sdg"
    convention: str = "body"
    evaluations: int = field(default=0, init=False)
    weights: dict[str, float] = field(init=False)

    def __post_init__(self) -> None:
        self.weights = parse_objective(self.text)
        if self.convention not in CONVENTIONS:
            known = ", ".join(CONVENTIONS)
            raise InputError(f"unknown convention {self.convention!r}; choose from {known}")
        undefined = [name for name in UNLOADED if name in self.weights]
        if self.recipe.loaded and undefined:
            what = f"{undefined[0]} is not defined under a force or with com_uncertainty"
            way_out = "use margin or tip_angle"
            reject(self.recipe.source, what, f"the objective {self.text!r}", way_out, InputError)
        self.gravity = checked_directions(self.gravity)[0]

    def cost(self, params: ArrayLike, gravity: ArrayLike | None = None) -> NDArray[np.float64]:
        """Return the cost of m geometries (m, k), rad or length, as (m,) float64.

        Below `TIPS` exactly where the robot stands.  With `gravity` (m, 3) each geometry has its
        own direction in place of the objective's.
        """
        rows = np.atleast_2d(np.asarray(params, dtype=np.float64))
        each = np.broadcast_to(self.gravity if gravity is None else gravity, (len(rows), 3))
        self.evaluations += len(rows)
        blocks = [slice(i, i + AT_ONCE) for i in range(0, len(rows), AT_ONCE)]
        parts = [self._cost(rows[block], each[block]) for block in blocks]
        return np.concatenate(parts) if parts else np.empty(0)

    def _cost(self, rows: NDArray[np.float64], down: NDArray[np.float64]) -> NDArray[np.float64]:
        channels = [*{**self.weights, "tip_angle": 0.0}]
        found = evaluate_each(self.recipe, rows, down, channels, self.convention)
        angle = found["tip_angle"]
        cost = np.zeros(len(rows))
        for name, weight in self.weights.items():
            cost += weight * QUANTITIES[name].sign * found[name]
        # A robot that cannot tip has infinite margins: as good as can be.
        return np.where(angle < 0.0, TIPS - angle, np.maximum(cost, -TIPS))

    def value(self, cost: float) -> float:
        """Return the objective of a cost: the channel itself where it is one.

        NaN where the robot tips; infinite (a weighted sum: minus infinity) where no geometry could
        be better, because the robot cannot tip over at all.
        """
        if cost >= TIPS:
            return float("nan")
        if cost <= -TIPS:
            cost = -float("inf")
        (name, *more) = self.weights
        return cost if more else cost * QUANTITIES[name].sign / self.weights[name]

    def cost_of(self, value: float) -> float:
        """Return the cost of a value of the objective; the inverse of `value`."""
        (name, *more) = self.weights
        return value if more else value * QUANTITIES[name].sign * self.weights[name]

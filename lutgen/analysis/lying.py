"""Whether a robot lies on its body: what of it would be below the ground that its contacts touch.

Owns that question; what is known of the body is the recipe room's.
"""

import math
from dataclasses import replace

import numpy as np

from lutgen.analysis.stance import Facet, Posture
from lutgen.recipe import body_parts, forward, robot_size_of

# Share of the robot's size: descriptions round their shapes, and a sole may be a little below the
# spheres that stand for it.
SLACK = 0.01


def below_ground(posture: Posture, facet: Facet) -> dict[str, float]:
    """Return how far links without contacts would reach below the ground, by their name.

    Parameters
    ----------
    posture : Posture
        The robot in one posture.
    facet : Facet
        The facet that is on the ground.

    Returns
    -------
    dict of str to float
        Depth below the facet's plane (the recipe's length unit) of those whose depth is more
        than 1 % of the robot's size; empty where nothing is known of the body.
    """
    recipe = posture.recipe
    parts = body_parts(recipe)
    if not parts:
        return {}
    placed = forward(replace(recipe, contacts=parts), posture.row)
    depth = placed.centres[0] @ facet.normal - facet.height
    result: dict[str, float] = {}
    for part, axis, down in zip(parts, placed.axes[0], depth.tolist(), strict=True):
        across = float(np.dot(axis, facet.normal))
        # A disc reaches out by the sine of the angle between its axle and the normal.
        reach = part.radius * (math.sqrt(max(0.0, 1.0 - across**2)) if axis.any() else 1.0)
        if down + reach > SLACK * robot_size_of(recipe):
            result[part.link] = max(down + reach, result.get(part.link, 0.0))
    return result

"""Whether a robot lies on its body: what of it would be below the ground that its contacts touch.

Owns that question; what is known of the body is the recipe room's.
"""

from dataclasses import replace

from lutgen.analysis.stance import Facet, Posture
from lutgen.recipe import body_parts, robot_size_of
from lutgen.support import support_height

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
    # Sizes are the robot's, not those of a robot on all its parts.
    least = SLACK * robot_size_of(recipe)
    body = Posture(replace(recipe, contacts=parts), posture.params).primitives
    x, y, z = facet.normal.tolist()
    result: dict[str, float] = {}
    for i, part in enumerate(parts):
        depth = support_height(body, i, (x, y, z)) - facet.height
        if depth > least:
            result[part.link] = max(depth, result.get(part.link, 0.0))
    return result

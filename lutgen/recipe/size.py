"""The size of a recipe's robot: one length by which its tolerances and widths are measured."""

from functools import lru_cache
from itertools import product

import numpy as np

from lutgen.recipe.kinematics import forward, radii_and_kinds
from lutgen.recipe.model import Recipe

# Postures that are looked at: both ends and the middle of every parameter, or of so many parameters
# that they would be more than this, the ends of as many as possible.
POSTURES = 1024
# Part of the size: how near to a facet's plane a contact counts to its support polygon.
TOLERANCE = 1e-4


def contact_tolerance_of(recipe: Recipe) -> float:
    """Return `contact_tolerance` (length) of a recipe, or what it is by default."""
    tolerance = recipe.contact_tolerance
    return TOLERANCE * robot_size_of(recipe) if tolerance is None else tolerance


@lru_cache(maxsize=64)
def robot_size_of(recipe: Recipe) -> float:
    """Return the size of a robot (length), 0 where every contact is a point at the com.

    It is the greatest distance of a contact's far side from the com over `POSTURES`.
    """
    places = []
    for place, parameter in enumerate(recipe.parameters):
        middle = 0.5 * (parameter.minimum + parameter.maximum)
        ends = [parameter.minimum, parameter.maximum]
        if 3 ** len(recipe.parameters) <= POSTURES:
            ends.insert(1, middle)
        places.append(ends if 2 ** (place + 1) <= POSTURES else [middle])
    radius, _ = radii_and_kinds(recipe)
    centres = forward(recipe, np.array(list(product(*places)), dtype=np.float64)).centres
    return float((np.sqrt((centres**2).sum(axis=2)) + radius).max(initial=0.0))

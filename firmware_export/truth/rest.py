"""Whether the facet of three contacts is always a rest, and how short an edge normal can be."""

import math
from functools import lru_cache

from firmware_export.truth.beyond import widened
from firmware_export.truth.bound import carries_everywhere, least_edge
from firmware_export.truth.model import Model
from firmware_export.truth.series import expand
from lutgen.channels import acceptance_of


@lru_cache(maxsize=4)
def least_edge_of(model: Model) -> float:
    """Return a lower bound of any edge normal's length over the box, and a sensor's slack beyond.

    0 where there is none, or where the three contacts' facet is not a rest everywhere.
    """
    if not model.is_tripod or model.recipe.com_uncertainty > 0.0:
        return 0.0
    series = expand(widened(model))
    accept = acceptance_of(model.recipe)
    # Where nobody asks how far the robot rolls, a stage is as good as a rest.
    width = accept.rest_width if math.isfinite(accept.rock_angle) else 0.0
    if series is None or not carries_everywhere(series, accept.steepest, width):
        return 0.0
    return least_edge(series)

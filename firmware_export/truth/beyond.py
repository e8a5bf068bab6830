"""What sensors of joints may say beyond the ends of an axis: there, too, answers must be true."""

import math
from dataclasses import replace
from functools import lru_cache

from firmware_export.truth.model import Model
from lutgen.parts import Parameter

# rad, and parts of an axis of lengths.
SLACK, SLACK_SHARE = math.radians(0.5), 0.005


def slack(parameter: Parameter) -> float:
    """Return how far beyond the ends of its axis a parameter is still read (rad or length)."""
    span = parameter.maximum - parameter.minimum
    return min(SLACK, span) if parameter.unit == "rad" else SLACK_SHARE * span


@lru_cache(maxsize=8)
def widened(model: Model) -> Model:
    """Return the model over its box and what sensors may say beyond its ends."""
    recipe = model.recipe
    wider = tuple(
        replace(p, minimum=p.minimum - slack(p), maximum=p.maximum + slack(p))
        for p in recipe.parameters
    )
    return Model(replace(recipe, parameters=wider))

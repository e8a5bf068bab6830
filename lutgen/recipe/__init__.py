"""Text into a recipe, and a recipe into postures.

In reading order: `table`, `robot`, `loads`, `plugin`, `described`, `recipe`, `kinematics`,
`candidates`, `proposal_text`, `proposal`.
"""

from lutgen.recipe.kinematics import Postures, forward, postures, radii_and_kinds
from lutgen.recipe.proposal import import_urdf
from lutgen.recipe.recipe import (
    Contact,
    Parameter,
    Recipe,
    Wheel,
    load_recipe,
    parse_recipe,
    recipe_digest,
)

__all__ = [
    "Contact",
    "Parameter",
    "Postures",
    "Recipe",
    "Wheel",
    "forward",
    "import_urdf",
    "load_recipe",
    "parse_recipe",
    "postures",
    "radii_and_kinds",
    "recipe_digest",
]

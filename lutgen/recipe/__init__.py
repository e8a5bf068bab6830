"""Text into a recipe, and a recipe into postures.

In reading order: `table`, `robot`, `loads`, `plugin`, `described`, `recipe`, `kinematics`,
`size`, `body`, `candidates`, `proposal_text`, `proposal`.
"""

from typing import TYPE_CHECKING, Any

from lutgen.recipe.body import body_parts
from lutgen.recipe.kinematics import Postures, forward, postures, radii_and_kinds
from lutgen.recipe.recipe import Recipe, load_recipe, parse_recipe, recipe_digest
from lutgen.recipe.robot import LENGTH_UNITS
from lutgen.recipe.size import robot_size_of
from lutgen.recipe.table import parse_table, read_text

if TYPE_CHECKING:
    from lutgen.recipe.proposal import import_urdf

__all__ = [
    "LENGTH_UNITS",
    "Postures",
    "Recipe",
    "body_parts",
    "forward",
    "import_urdf",
    "load_recipe",
    "parse_recipe",
    "parse_table",
    "postures",
    "radii_and_kinds",
    "read_text",
    "recipe_digest",
    "robot_size_of",
]


def __getattr__(name: str) -> Any:
    """Import on first use what reads robot descriptions (PEP 562)."""
    if name != "import_urdf":
        raise AttributeError(f"module 'lutgen.recipe' has no attribute {name!r}")
    from lutgen.recipe.proposal import import_urdf

    return import_urdf

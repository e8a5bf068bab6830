"""Text into a recipe, and a recipe into postures.

In reading order: `table`, `key`, `robot_keys`, `keys`, `schema`, `start`, `robot`, `loads`,
`plugin`, `described`, `gallery`, `recipe`, `merge`, `kinematics`, `size`, `snap`, `body`.
"""

from lutgen.recipe.body import body_parts
from lutgen.recipe.gallery import GALLERY, gallery_names, gallery_text
from lutgen.recipe.kinematics import Postures, forward, postures, radii_and_kinds
from lutgen.recipe.merge import merged_recipe
from lutgen.recipe.recipe import Recipe, load_recipe, parse_recipe, recipe_digest
from lutgen.recipe.robot_keys import LENGTH_UNITS
from lutgen.recipe.schema import recipe_schema
from lutgen.recipe.size import TOLERANCE, contact_tolerance_of, robot_size_of
from lutgen.recipe.start import start_recipe, start_recipes
from lutgen.recipe.table import HDF5, parse_table, read_text

__all__ = [
    "GALLERY",
    "HDF5",
    "LENGTH_UNITS",
    "TOLERANCE",
    "Postures",
    "Recipe",
    "body_parts",
    "contact_tolerance_of",
    "forward",
    "gallery_names",
    "gallery_text",
    "load_recipe",
    "merged_recipe",
    "parse_recipe",
    "parse_table",
    "postures",
    "radii_and_kinds",
    "read_text",
    "recipe_digest",
    "recipe_schema",
    "robot_size_of",
    "start_recipe",
    "start_recipes",
]

"""Text into a recipe, and a recipe into postures.

In reading order: `schema`, `load`, `model`, `rules`, `described`, `gallery`,
`kinematics`, `snap`, `recipe`.
"""

from lutgen.recipe.described import body_parts
from lutgen.recipe.gallery import GALLERY, gallery_names, gallery_text, start_recipe, start_recipes
from lutgen.recipe.kinematics import (
    Postures,
    forward,
    postures,
    radii_and_kinds,
    swung_links,
    within_limits,
)
from lutgen.recipe.load import HDF5, read_tables, read_text, recipe_schema
from lutgen.recipe.model import Recipe, recipe_digest
from lutgen.recipe.recipe import load_recipe, parse_recipe
from lutgen.recipe.snap import TOLERANCE, contact_tolerance_of, robot_size_of

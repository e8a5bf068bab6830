"""What a command is given to work on: a recipe's file, one of the gallery, or a map.

Owns how they are told apart, so that all commands do so alike.
"""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lutgen.mapping import StabilityMap
    from lutgen.recipe import Recipe

# A file that is called so was meant as a map, whatever is in it; any other says so itself.
_ENDINGS = (".h5", ".hdf5", ".nc")


def open_source(path: str, allow_python: bool = False) -> "Recipe | StabilityMap":
    """Open a recipe or a map, whichever `path` names."""
    if _is_map(path):
        from lutgen.mapping import load_map

        return load_map(path)
    from lutgen.recipe import load_recipe

    return load_recipe(path, allow_python=allow_python)


def open_recipe(path: str, allow_python: bool = False) -> "Recipe":
    """Open a recipe, also the one inside a map; its code is looked for beside the map."""
    from lutgen.recipe import Recipe, parse_recipe

    opened = open_source(path, allow_python)
    if isinstance(opened, Recipe):
        return opened
    recipe = opened.recipe
    if recipe.python is None:
        return recipe
    # A map leaves the code alone, and so has a robot without contacts.
    return parse_recipe(recipe.text, recipe.source, allow_python, urdf=recipe.urdf)


def _is_map(path: str) -> bool:
    from lutgen.recipe import HDF5

    if path.endswith(_ENDINGS):
        return True
    try:
        with Path(path).open("rb") as file:
            return file.read(len(HDF5)) == HDF5
    except OSError:
        # What opens it says why it cannot be opened.
        return False

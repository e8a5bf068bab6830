"""Commented recipes to start from, one for each kind of robot.

Owns where they are and how one is named; the recipes themselves are files of this package.
"""

from functools import cache
from pathlib import Path

from lutgen.errors import InputError, suggestion
from lutgen.recipe.table import read_text

# In the order in which they are listed: the simplest comes first.
KINDS = ("wheels", "tracks", "legs", "arm")
FOLDER = Path(__file__).parent / "starts"


def start_recipe(kind: str) -> str:
    """Return a commented recipe to start from.

    Parameters
    ----------
    kind : str
        One of the keys of `start_recipes`.

    Returns
    -------
    str
        TOML that is complete as it is; InputError is raised for an unknown kind.
    """
    if kind not in KINDS:
        way_out = suggestion(kind, KINDS, "use one of")
        raise InputError(
            f"there is no recipe to start from of this kind (got {kind!r}); {way_out}."
        )
    return read_text(FOLDER / f"{kind}.toml")


@cache
def start_recipes() -> dict[str, str]:
    """Return the kinds of recipes to start from, and what each is, in a sentence."""
    return {kind: start_recipe(kind).partition("\n")[0].removeprefix("# ") for kind in KINDS}

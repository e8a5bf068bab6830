"""The recipes of the gallery, which come with the package: `recipe:NAME` is one of them.

Owns where they are.  In a checkout they stand in `maps` beside the package, from where an
installation takes them into it.
"""

from pathlib import Path

from lutgen.errors import RecipeError, suggestion

__all__ = ["GALLERY", "gallery_names", "gallery_text"]

# What a name of the gallery begins with, where else there would be a path.
GALLERY = "recipe:"
_PACKAGE = Path(__file__).resolve().parents[1]
_FOLDERS = (_PACKAGE / "gallery", _PACKAGE.parent / "maps")


def gallery_names() -> tuple[str, ...]:
    """Return the names of the gallery's recipes, sorted; none where they were left out."""
    return tuple(sorted(path.stem for path in _folder().glob("*.toml")))


def gallery_text(name: str) -> str:
    """Return the TOML of a recipe of the gallery.

    Parameters
    ----------
    name : str
        One of `gallery_names`, with or without `recipe:` before it.

    Returns
    -------
    str
        The whole file, comments included.

    Raises
    ------
    RecipeError
        Where the gallery has no recipe of this name.
    """
    bare = name.removeprefix(GALLERY)
    known = gallery_names()
    if bare not in known:
        raise RecipeError(
            f"{GALLERY}{bare}: the gallery has no recipe of this name (got {bare!r}); "
            f"{suggestion(bare, known, 'choose from')}."
        )
    return (_folder() / f"{bare}.toml").read_text(encoding="utf-8")


def _folder() -> Path:
    """Return the folder of the recipes: the package's own, or that of a checkout."""
    own, checkout = _FOLDERS
    return own if own.is_dir() else checkout

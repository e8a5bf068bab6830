"""The recipes that come with the package: those of the gallery, and commented ones to start from.

`recipe:NAME` is one of the gallery.  In a checkout the gallery is the folder `maps` beside the
package; an installation has a copy of it inside the package.
"""

from functools import cache
from pathlib import Path

from lutgen.errors import InputError, reject, suggestion

# A name of the gallery begins with this, and a path does not.
GALLERY = "recipe:"
# Recipes to start from, the simplest first.
KINDS = ("wheels", "tracks", "legs", "arm")
_STARTS = Path(__file__).parent / "starts"
_PACKAGE = Path(__file__).resolve().parents[1]
_OWN, _CHECKOUT = _PACKAGE / "gallery", _PACKAGE.parent / "maps"
_FOLDER = _OWN if _OWN.is_dir() else _CHECKOUT


def gallery_names() -> tuple[str, ...]:
    """Return the names of the gallery's recipes, sorted; none where they were left out."""
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.toml")))


def gallery_text(name: str) -> str:
    """Return the TOML of a recipe of the gallery, with or without `recipe:` before its name."""
    bare = name.removeprefix(GALLERY)
    known = gallery_names()
    if bare not in known:
        way_out = suggestion(bare, known, "choose from")
        reject(f"{GALLERY}{bare}", "the gallery has no recipe of this name", repr(bare), way_out)
    return (_FOLDER / f"{bare}.toml").read_text(encoding="utf-8")


def start_recipe(kind: str) -> str:
    """Return a commented recipe to start from, of a kind in `start_recipes`."""
    if kind not in KINDS:
        way_out = suggestion(kind, KINDS, "use one of")
        raise InputError(
            f"there is no recipe to start from of this kind (got {kind!r}); {way_out}."
        )
    return (_STARTS / f"{kind}.toml").read_text(encoding="utf-8")


@cache
def start_recipes() -> dict[str, str]:
    """Return the kinds of recipes to start from, and what each is, in a sentence."""
    return {kind: start_recipe(kind).partition("\n")[0].removeprefix("# ") for kind in KINDS}

"""Bounds on what other people write or type: every limit, once.

The limits are far above what a robot needs, and low enough for a small machine's memory.
docs/reference/bounds.md is this table.
"""

from dataclasses import dataclass
from pathlib import Path

from lutgen.errors import InputError, LutgenError, RecipeError, one_line, reject

# Numbers of more digits than this are cut short in a message.
_SHOWN = 24


@dataclass(frozen=True)
class Bound:
    """The largest `most` that something may be; `what` says of what, with its unit."""

    most: int
    what: str


RECIPE_BYTES = Bound(4 << 20, "bytes of a recipe or another TOML file")
URDF_BYTES = Bound(16 << 20, "bytes of a URDF or SRDF file")
MESH_BYTES = Bound(64 << 20, "bytes of a mesh")
TERRAIN_BYTES = Bound(64 << 20, "bytes of a terrain in CSV")
REPORT_BYTES = Bound(256 << 20, "bytes of the report in an export folder")
KEY_DOTS = Bound(200, "dots in a key of TOML")
MAGNITUDE = Bound(10**12, "the size of a number in a recipe or a URDF, in its unit")
CONTACTS = Bound(62, "contacts of a robot")
LINKS = Bound(10_000, "links of a URDF")
ENTRIES = Bound(10_000, "parameters, links, wheels, payloads or forces of a recipe, each")
KNOTS = Bound(1_000_000, "nodes of a parameter")
SIDE = Bound(1024, "nodes along a side of a face of the gravity chart")
NODES = Bound(2**62, "nodes of a map")
BLOCKS = Bound(1 << 18, "blocks of a map that is swept")
POINTS = Bound(200_000, "points of a path")
HEADINGS = Bound(36_000, "headings")
LIMITS = Bound(50_000_000, "postures times headings of `limits`")
SEARCHED = Bound(8, "parameters that the method `search` varies")
LEVELS = Bound(32, "levels of a search")

# In the order of the table in the reference.
BOUNDS: dict[str, Bound] = {
    name: value for name, value in list(globals().items()) if isinstance(value, Bound)
}


def check(value: int, bound: Bound, where: str, way_out: str) -> None:
    """Refuse a number above a bound with InputError, before anything is made of that size.

    `where` is the file and key, or the option, that gives it, and `way_out` what to do instead.
    """
    if value > bound.most:
        what = f"beyond the limit of {bound.most:,} {bound.what}"
        reject(where, what, shown(value), way_out, InputError)


def read(source: str, bound: Bound, kind: type[LutgenError] = RecipeError) -> bytes:
    """Return the bytes of a file, or raise an error if it cannot be read or is too long."""
    try:
        with Path(source).open("rb") as file:
            return short_enough(file.read(bound.most + 1), source, bound, kind)
    except OSError as error:
        missing = isinstance(error, FileNotFoundError)
        what = "there is no such file" if missing else f"cannot be read (got {error.strerror})"
        raise kind(f"{one_line(source)}: {what}; check the path.") from error


def short_enough(
    content: bytes, source: str, bound: Bound, kind: type[LutgenError] = RecipeError
) -> bytes:
    """Return bytes, or refuse too many of them."""
    if len(content) > bound.most:
        what, way_out = "is too long", "leave out what is not needed, or name another file"
        reject(source, what, f"more than {bound.most:,} {bound.what}", way_out, kind)
    return content


def shown(value: int) -> str:
    """Return a whole number for a message, a long one as its length."""
    if abs(value) < 10**_SHOWN:
        return f"{value:,}"
    # Python refuses to print the longest; 0.30103 is log10 of 2.
    return f"a number of {int(value.bit_length() * 0.30103) + 1} digits"

"""The runtime of an export: the parts that its codec needs, as one smap.c with a table of contents.

Owns which parts those are, and the settings in front of them.
"""

import re
from functools import cache
from importlib.resources import files

from firmware_export.emit.text import LICENCE
from firmware_export.protocol import CBody
from lutgen.errors import ExportError

# The switches of the runtime: what its code depends on.
SWITCHES = (
    *("SMAP_FLOATS", "SMAP_INTEGERS", "SMAP_POINTS", "SMAP_TABLES", "SMAP_GRID"),
    *("SMAP_MANY", "SMAP_MANY_BY_RAILS", "SMAP_MANY_SEARCH", "SMAP_MANY_GAPS", "SMAP_SERIES"),
)
# A part, and the switches that need it, any of them; all always have it where none is named.
_PARTS: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("head", ()),
    ("arithmetic", ()),
    ("blob", ()),
    ("range", ()),
    ("positions", ("SMAP_POINTS", "SMAP_MANY")),
    ("series", ("SMAP_SERIES",)),
    ("chart", ()),
    ("three", ("SMAP_POINTS", "SMAP_TABLES")),
    ("tables", ("SMAP_TABLES",)),
    ("three_entry", ("SMAP_POINTS", "SMAP_TABLES")),
    ("grid", ("SMAP_GRID",)),
    ("many_types", ("SMAP_MANY",)),
    ("many_rails", ("SMAP_MANY_BY_RAILS",)),
    ("many_planes", ("SMAP_MANY_SEARCH",)),
    ("many_rests", ("SMAP_MANY",)),
    ("many_search", ("SMAP_MANY_SEARCH",)),
    ("many_walls", ("SMAP_MANY",)),
    ("many_gaps", ("SMAP_MANY_GAPS",)),
    *((f"many_{name}", ("SMAP_MANY",)) for name in ("pose", "at", "at_i", "entry")),
    ("steps", ("SMAP_FLOATS",)),
    ("check", ()),
    ("end", ()),
)
# The parts of on-board control; that which looks at a way is of the codec's family.
_CONTROL = ("head", "types", "{}", "target", "watch", "way", "step", "end")
_TITLE = re.compile(r"^/\* ---- (\w[^:\n]*: [^\n]*?) -*(?: \*/)?$", re.MULTILINE)


@cache
def runtime_file(name: str) -> str:
    """Return the text of a file of the runtime."""
    folder = files("firmware_export") / "runtime"
    try:
        return (folder / name).read_text(encoding="utf-8")
    except OSError as error:
        raise ExportError(
            f"{name}: this file of the runtime cannot be read (got {error.strerror}); "
            "install lutgen again."
        ) from error


@cache
def runtime_version() -> int:
    """Return SMAP_VERSION of the runtime."""
    found = re.search(r"#define SMAP_VERSION (\d+)", runtime_file("smap.h"))
    if found is None:
        raise ExportError("smap.h: SMAP_VERSION is missing (got nothing); install lutgen again.")
    return int(found[1])


def settings(body: CBody, params: int) -> dict[str, int]:
    """Return the settings of the runtime by name: all switches, then sizes."""
    given = dict(body.macros)
    switches = {name: given.pop(name, 0) for name in SWITCHES}
    return {**switches, "SMAP_MAX_PARAMS": max(params, 1), **given}


def features(body: CBody) -> frozenset[str]:
    """Return the switches that an export has on: what its code size depends on."""
    given = dict(body.macros)
    return frozenset(name for name in SWITCHES if given.get(name))


def parts_of(on: frozenset[str]) -> list[str]:
    """Return the names of the parts that some switches need."""
    return [name for name, needed in _PARTS if not needed or on.intersection(needed)]


def runtime_text(on: frozenset[str]) -> str:
    """Return smap.c with the parts that some switches need."""
    parts = [_without_licence(runtime_file(f"{name}.c")) for name in parts_of(on)]
    titles = [title.strip() for part in parts for title in _TITLE.findall(part)]
    contents = "\n".join(f" *   {title}" for title in titles)
    return f"""{LICENCE}/* smap.c: reads the map of its export.  NAME.c takes it in behind its
 * settings and its blob; compiled by itself it is nothing.  Its promises are in smap.h.
 *
{contents} */
#ifdef SMAP_FLOATS

{"".join(parts)}
#else
typedef int smap_is_taken_in_by_an_export;
#endif
"""


def control_parts(on: frozenset[str]) -> list[str]:
    """Return the names of the parts of on-board control that some switches need."""
    family = "many" if "SMAP_MANY" in on else "three"
    return [f"control_{part.format(family)}" for part in _CONTROL]


def control_text(on: frozenset[str]) -> str:
    """Return smap_control.c for the family of codecs that some switches need."""
    parts = [_without_licence(runtime_file(f"{name}.c")) for name in control_parts(on)]
    titles = [title.strip() for part in parts for title in _TITLE.findall(part)]
    contents = "\n".join(f" *   {title}" for title in titles)
    return f"""{LICENCE}/* smap_control.c: steers by a map and its policy.  NAME.c takes it in
 * behind smap.c; compiled by itself it is nothing.  Its promises are in smap_control.h.
 *
{contents} */
#ifdef SMAP_CONTROL

{"".join(parts)}
#else
typedef int smap_control_is_taken_in_by_an_export;
#endif
"""


def _without_licence(text: str) -> str:
    """Return the text of a part without the licence's lines."""
    return text.removeprefix(LICENCE)

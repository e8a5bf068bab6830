"""The structs of smap.h as ctypes knows them, read from smap.h itself."""

import ctypes
import re
from functools import cache
from typing import Any

from firmware_export.host.library import RUNTIME
from firmware_export.protocol import CTYPES

_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
_STRUCT = re.compile(
    r"(?:typedef struct|struct (?P<tag>\w+)) \{(?P<body>.*?)\}\s*(?P<name>\w*);", re.DOTALL
)
_DECLARATION = re.compile(r"\s*(?:const\s+)?(?:SMAP_FLASH\s+)?(?P<ctype>\w+)\s+(?P<rest>.+)", re.S)
_MEMBER = re.compile(r"(?P<star>\*?)\s*(?P<name>\w+)(?:\[(?P<count>\d+)\])?")
_TYPES: dict[str, Any] = {
    name: ctypes.c_float if name == "float" else getattr(ctypes, f"c_{name.removesuffix('_t')}")
    for name in CTYPES
}


def _header() -> str:
    return (RUNTIME / "smap.h").read_text(encoding="utf-8")


@cache
def structs() -> dict[str, type[ctypes.Structure]]:
    """Return every struct of smap.h by name; a pointer is a c_void_p."""
    found = {}
    for match in _STRUCT.finditer(_COMMENT.sub("", _header())):
        fields = [
            field
            for declaration in match["body"].split(";")
            if declaration.strip()
            for field in _members(declaration)
        ]
        name = match["name"] or match["tag"]
        found[name] = type(name, (ctypes.Structure,), {"_fields_": fields})
    return found


def _members(declaration: str) -> list[tuple[str, Any]]:
    """Return the members of one declaration, such as ``float offset[2], step``."""
    parts = _DECLARATION.fullmatch(declaration.rstrip())
    assert parts is not None, declaration
    members = []
    for text in parts["rest"].split(","):
        member = _MEMBER.fullmatch(text.strip())
        assert member is not None, declaration
        ctype = ctypes.c_void_p if member["star"] else _TYPES[parts["ctype"]]
        members.append((member["name"], ctype * int(member["count"]) if member["count"] else ctype))
    return members


@cache
def constants() -> dict[str, int]:
    """Return the enumerators of smap.h by name, and what marks a table in chunks: none is here."""
    pairs = re.findall(r"\b(SMAP_\w+) = (-?\d+)", _header())
    return {name: int(value) for name, value in pairs} | {"SMAP_CUT": 0}

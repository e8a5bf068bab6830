"""How large the runtime's structs are for given capacities, read from its own text.

A header must say how much memory a pose needs before anything is compiled; NAME.c then asserts it.
"""

import ast
import operator
import re
from collections.abc import Mapping
from functools import cache, lru_cache

from firmware_export.host import RUNTIME

# (bytes, alignment); addresses as on the largest target.
_BASIC = {
    **{f"{sign}int{bits}_t": (bits // 8, bits // 8) for sign in ("", "u") for bits in (8, 16, 32)},
    "float": (4, 4),
}
_ADDRESS = (8, 8)
_STRUCT = re.compile(r"typedef struct \{(?P<body>[^{}]*)\} (?P<name>\w+);")
_OPERATORS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul}
_EITHER = re.compile(r"([^()?]+) \? ([^()?]+) : ([^()?]+)")


@cache
def _texts() -> str:
    files = [RUNTIME / f"smap_{name}" for name in ("region.h", "rails.c", "search.c")]
    return re.sub(
        r"/\*.*?\*/", "", "\n".join(f.read_text(encoding="utf-8") for f in files), flags=re.S
    )


def _chosen(macros: Mapping[str, int]) -> str:
    """Return the text that the preprocessor leaves of it, as far as conditions are known."""
    kept, open_ = [], [True]
    for line in _texts().splitlines():
        words = line.split()
        if words[:1] in (["#if"], ["#ifdef"], ["#ifndef"]):
            name = words[1].lstrip("!") if len(words) > 1 else ""
            known = words[0] == "#if" and name in macros
            true = not known or bool(macros[name]) != words[1].startswith("!")
            true = true and words[-1] != "SMAP_HOST"  # what only this machine has
            open_.append(true)
        elif words[:1] == ["#else"]:
            open_[-1] = not open_[-1]
        elif words[:1] == ["#endif"]:
            open_.pop()
        elif all(open_):
            kept.append(line)
    return "\n".join(kept)


@lru_cache(maxsize=16)
def _structs(macros: tuple[tuple[str, int], ...]) -> dict[str, str]:
    """Return the bodies of the structs by name; an export asks for each of them many times."""
    found = list(_STRUCT.finditer(_chosen(dict(macros))))
    return {one["name"]: one["body"] for one in reversed(found)}  # the first of a name counts


def _number(text: str, macros: Mapping[str, int]) -> int:
    """Return the value of the size of an array.

    Numbers, macros, sums, differences and products; of two of them the one, if one is greater.
    """

    def value(node: ast.expr) -> int:
        if isinstance(node, ast.Constant):
            return int(node.value)  # type: ignore[arg-type]
        if isinstance(node, ast.Name) and node.id in macros:
            return macros[node.id]
        if isinstance(node, ast.Name):
            found = re.search(rf"#define {node.id} (.+)", _texts())
            assert found is not None, node.id
            # A default; what it says of others counts.
            return _number(found[1], macros)
        if isinstance(node, ast.IfExp):
            assert isinstance(node.test, ast.Compare), text
            assert isinstance(node.test.ops[0], ast.Gt), text
            greater = value(node.test.left) > value(node.test.comparators[0])
            return value(node.body if greater else node.orelse)
        assert isinstance(node, ast.BinOp), text
        return _OPERATORS[type(node.op)](value(node.left), value(node.right))  # type: ignore[no-any-return]

    python = _EITHER.sub(r"\2 if \1 else \3", text.strip())
    return value(ast.parse(python, mode="eval").body)


def struct_bytes(name: str, macros: Mapping[str, int]) -> tuple[int, int]:
    """Return bytes and alignment of a struct of runtime/smap_region.h.

    Examples
    --------
    >>> struct_bytes("smap_gap_t", {})
    (2, 1)
    """
    if name in _BASIC:
        return _BASIC[name]
    body = _structs(tuple(macros.items()))[name]
    size, widest = 0, 1
    for declaration in filter(str.strip, body.split(";")):
        words = " ".join(declaration.split()).removeprefix("const ")
        ctype, rest = words.split(None, 1)
        for text in rest.split(","):
            one, align = _ADDRESS
            if "*" not in text:
                one, align = struct_bytes(ctype, macros)
                for count in re.findall(r"\[([^\]]+)\]", text):
                    one *= _number(count, macros)
            size = -(-size // align) * align + one
            widest = max(widest, align)
    return -(-size // widest) * widest, widest


def pose_words(macros: Mapping[str, int]) -> tuple[int, int]:
    """Return the words of 32 bits of a pose beside an address: both forms, integers alone."""
    real, work, whole, layout = (
        struct_bytes(name, macros)[0]
        for name in (
            "smap_many_pose_t",
            "smap_many_work_t",
            "smap_many_pose_i_t",
            "smap_layout_t",
        )
    )
    # The head's four bytes; up to seven more where the work is aligned.
    return -(-(4 + real + 8 + max(work, whole)) // 4), -(-(4 + layout + 1 + whole + 4) // 4)


def swept_words(macros: Mapping[str, int]) -> int:
    """Return the words of 32 bits of a pose of a box of postures (runtime/smap_state.h)."""
    return -(-struct_bytes("smap_many_pose_t", macros)[0] // 4) + 3

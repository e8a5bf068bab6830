"""The descriptor of a map: all that NAME.c defines, as C prints it or as JSON holds it.

Numbers of structs are C expressions, so that the file, the report and what this machine is asked
have one source.  Tables are arrays; in JSON they are little-endian bytes in base64.
"""

import base64
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from firmware_export.protocol.array import CTYPES, CArray, CBody, literal
from firmware_export.protocol.exported import Export
from firmware_export.truth import Model


@dataclass(frozen=True, eq=False)
class Descriptor:
    """A map as C defines it.

    Parameters
    ----------
    arrays : tuple of CArray
        All tables in the order of their definition, those of the axes first.
    ctype : str
        The codec's struct.
    body, map : tuple of (str, str)
        Field and C expression of the codec's struct and of ``struct smap``; ``@name`` names an
        array, and ``@body`` the former struct.
    config : dict of str to int
        What of smap_config.h the tables need beyond their codec's switch, see `CBody`.
    """

    arrays: tuple[CArray, ...]
    ctype: str
    body: tuple[tuple[str, str], ...]
    map: tuple[tuple[str, str], ...]
    config: dict[str, int]


def describe(export: Export, enum: str, body: CBody) -> Descriptor:
    """Return the descriptor of an export; `enum` is its codec to C, `body` its tables."""
    model = export.model
    fields = (
        ("codec", enum),
        ("params", str(model.k)),
        ("channels", " | ".join(f"SMAP_{channel.upper()}" for channel in export.channels)),
        ("faces", str(model.faces)),
        ("chart_limit", literal(model.chart_limit, "float")),
        ("guard", literal(export.tables.guard, "float")),
        ("axes", "@axes" if model.k else "0"),
        ("body", "&@body"),
    )
    axes = (_axes(export),) if model.k else ()
    return Descriptor((*axes, *body.arrays), body.ctype, body.fields, fields, dict(body.config))


def _axes(export: Export) -> CArray:
    """Return the table of the parameters' axes."""
    rows = [
        f"{{{', '.join(literal(value, 'float') for value in row)}}}"
        for row in axis_numbers(export.model)
    ]
    notes = [f"{parameter.name}, {parameter.unit}" for parameter in export.recipe.parameters]
    return CArray(
        "axes", "smap_axis_t", rows, "Axes: lower end, upper end, 1 / (upper - lower)", 1, notes
    )


def axis_numbers(model: Model) -> NDArray[np.float32]:
    """Return min, max and 1 / (max - min) of every parameter, (k, 3), as smap_axis_t holds them.

    The last is rounded so that the upper end comes to 1 at most, and with it every place below.
    """
    lower, upper = model.lower.astype(np.float32), model.upper.astype(np.float32)
    inverse = (1.0 / (upper.astype(np.float64) - lower.astype(np.float64))).astype(np.float32)
    beyond = (upper - lower) * inverse > 1.0
    inverse = np.where(beyond, np.nextafter(inverse, np.float32(0.0)), inverse)
    return np.stack([lower, upper, inverse], axis=1).reshape(-1, 3)


def stored(content: Descriptor) -> dict[str, Any]:
    """Return a descriptor as JSON knows it."""
    arrays: dict[str, Any] = {}
    for array in content.arrays:
        row: dict[str, Any] = {"type": array.ctype}
        if array.plain:
            numbers = array.numbers
            packed = numbers.astype(numbers.dtype.newbyteorder("<")).tobytes()
            row |= {
                "shape": list(np.shape(array.values)),
                "base64": base64.b64encode(packed).decode("ascii"),
            }
        else:
            row["rows"] = list(array.values)
        arrays[array.name] = row
    return {
        "arrays": arrays,
        "type": content.ctype,
        "body": dict(content.body),
        "map": dict(content.map),
        "config": content.config,
    }


def restored(held: Mapping[str, Any]) -> Descriptor:
    """Return the descriptor that `stored` wrote.

    Raises
    ------
    KeyError, TypeError, ValueError
        Where it did not write this.
    """
    arrays = []
    for name, row in held["arrays"].items():
        ctype, values = row["type"], row.get("rows")
        if values is None:
            dtype = np.dtype(CTYPES[ctype]).newbyteorder("<")
            values = np.frombuffer(base64.b64decode(row["base64"]), dtype).reshape(row["shape"])
        arrays.append(CArray(name, ctype, values))
    body, fields = tuple(held["body"].items()), tuple(held["map"].items())
    return Descriptor(tuple(arrays), held["type"], body, fields, dict(held["config"]))


def members(expression: str) -> list[str] | None:
    """Return the members of a braced initialiser, None for any other expression."""
    text = expression.strip()
    if not (text.startswith("{") and text.endswith("}")):
        return None
    found, depth, start = [], 0, 1
    for at, character in enumerate(text[:-1]):
        depth += (character in "{(") - (character in "})")
        if character == "," and depth == 1:
            found.append(text[start:at].strip())
            start = at + 1
    return [*found, text[start:-1].strip()]

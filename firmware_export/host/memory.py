"""A map's descriptor laid out in memory as C has it.

Owns the step from the C expressions of a descriptor to numbers and addresses.
"""

import ctypes
from typing import Any

import numpy as np

from firmware_export.host.layout import constants, structs
from firmware_export.protocol import CArray, Descriptor, members
from lutgen.errors import ExportError


class Memory:
    """The map of a descriptor in memory; it stays where it is as long as this object lives.

    `address` is that of its ``struct smap``, `params` the number of its parameters.
    """

    def __init__(self, descriptor: Descriptor) -> None:
        self._kept: list[Any] = []
        self._places: dict[str, int] = {}
        for array in descriptor.arrays:
            self._places[array.name] = self._array(array)
        self._places["body"] = self._struct(descriptor.ctype, dict(descriptor.body))
        self.address = self._struct("smap", dict(descriptor.map))
        self.params = int(dict(descriptor.map)["params"])

    def _array(self, array: CArray) -> int:
        """Place a table; return its address, 0 where it has no elements."""
        if not len(array.values):
            return 0
        if array.plain:
            numbers = np.ascontiguousarray(array.numbers)
            self._kept.append(numbers)
            return int(numbers.ctypes.data)
        kind = structs()[array.ctype]
        rows = (kind * len(array.values))()
        for row, text in zip(rows, array.values, strict=True):
            names = [name for name, *_ in kind._fields_]
            self._fill(row, dict(zip(names, members(str(text)) or [], strict=True)))
        self._kept.append(rows)
        return ctypes.addressof(rows)

    def _struct(self, ctype: str, fields: dict[str, str]) -> int:
        """Place a struct; return its address."""
        struct = structs()[ctype]()
        self._fill(struct, fields)
        self._kept.append(struct)
        return ctypes.addressof(struct)

    def _fill(self, struct: Any, fields: dict[str, str]) -> None:
        kinds = {name: kind for name, kind, *_ in struct._fields_}
        if set(fields) != set(kinds):
            raise ExportError(
                f"{type(struct).__name__}: its fields are not those of smap.h (got "
                f"{', '.join(fields)}); export again."
            )
        for name, expression in fields.items():
            several = members(expression)
            if several is None:
                setattr(struct, name, self._value(expression, kinds[name]))
            else:
                kind = kinds[name]._type_
                setattr(struct, name, kinds[name](*(self._value(one, kind) for one in several)))

    def _value(self, expression: str, kind: Any) -> Any:
        """Return what an expression stands for: an address, a single, or a whole number."""
        text = expression.strip()
        name = text.lstrip("&@")
        try:
            if name != text:
                return self._places[name]
            if kind is ctypes.c_float:
                return float(np.float32(text.removesuffix("f")))
            value = 0
            for part in map(str.strip, text.split("|")):
                value |= constants()[part] if part in constants() else int(part.removesuffix("u"))
        except (KeyError, ValueError) as error:
            raise ExportError(
                f"descriptor: {text!r} cannot be read (got {type(error).__name__}); export again."
            ) from error
        if kind is ctypes.c_void_p:
            return value or None
        if kind(value).value != value:
            raise ExportError(
                f"descriptor: a number does not fit its field of {ctypes.sizeof(kind)} bytes (got "
                f"{text}); choose a smaller table."
            )
        return value

"""What a codec hands to the emitter of C: arrays of codes, and the struct that points at them.

This file knows no C beyond the names of its integer types and float, and how their constants are
written; `emit.source` prints the rest.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lutgen.errors import InputError

# The types of tables and the NumPy types of the same width.
CTYPES: dict[str, type[np.generic]] = {
    "uint8_t": np.uint8,
    "int8_t": np.int8,
    "uint16_t": np.uint16,
    "int16_t": np.int16,
    "uint32_t": np.uint32,
    "int32_t": np.int32,
    "float": np.float32,
}


@dataclass(frozen=True, eq=False)
class CArray:
    """One constant table.

    Parameters
    ----------
    name : str
        Short identifier such as ``codes``; the emitter prefixes it with the export's name.
    ctype : str
        Element type, a key of `CTYPES`; or a struct of smap.h, whose rows `values` then lists
        as C expressions (``"{ @path_1, 3 }"``), where ``@name`` names an array.
    values : array, or sequence of str
        Any shape, C order; integers must fit the type.  float32 for ``float``.
    comment : str
        One line above the table: what it holds, its axes and its unit.
    row : int
        Elements after which a new row starts, 0 for none; rows longer than a line are wrapped.
    rows : sequence of str
        A comment for each row, or nothing.
    chunk : int
        Elements of a chunk where SMAP_GRID_CHUNKS asks for small objects: ``@name`` is then the
        list of the chunks' addresses.  0: one object everywhere.
    """

    name: str
    ctype: str
    values: NDArray[Any] | Sequence[str]
    comment: str = ""
    row: int = 0
    rows: Sequence[str] = field(default=())
    chunk: int = 0

    def __post_init__(self) -> None:
        if self.ctype not in CTYPES:
            return
        want = CTYPES[self.ctype]
        found = np.asarray(self.values)
        exact = np.issubdtype(found.dtype, np.number) and bool(
            np.all(np.isfinite(found)) and np.all(found.astype(want) == found)
        )
        if not exact:
            raise InputError(
                f"table {self.name}: its values do not fit {self.ctype} (got {found.dtype}); "
                "quantise them first."
            )
        object.__setattr__(self, "values", found.astype(want))

    @property
    def plain(self) -> bool:
        """Whether the elements are numbers."""
        return self.ctype in CTYPES

    @property
    def numbers(self) -> NDArray[Any]:
        """The values of a table of numbers, flat."""
        return np.asarray(self.values).reshape(-1)

    @property
    def bytes(self) -> int:
        """Bytes of flash of the numbers; structs count as part of the descriptor."""
        return int(np.asarray(self.values).nbytes) if self.plain else 0


@dataclass(frozen=True)
class CBody:
    """A codec's struct and its tables.

    Parameters
    ----------
    ctype : str
        The struct of smap.h, such as ``smap_grid_t``.
    fields : tuple of (str, str)
        Field name and C expression, in the order of the struct; ``@codes`` stands for the
        emitted table `codes`, wherever it occurs in the expression.
    arrays : tuple of CArray
        In the order of their definition: one that names another follows it.  C has no table
        without elements, so none is emitted for it and ``@name`` is then 0.
    config : tuple of (str, int)
        What these tables need of smap_config.h beyond their codec's own switch and
        SMAP_MAX_PARAMS: sizes such as ``("SMAP_MAX_CONTACTS", 3)`` and further switches such as
        ``("SMAP_CONTACTS_MANY", 0)``.  A switch that no export needs is 0 in its smap_config.h.
    steps : tuple of (str, float)
        Integer arithmetic only: the value of one step of ``"sdg"`` and ``"height"`` in the length
        unit; they become the macros NAME_SDG_STEP and NAME_HEIGHT_STEP.
    """

    ctype: str
    fields: tuple[tuple[str, str], ...]
    arrays: tuple[CArray, ...]
    config: tuple[tuple[str, int], ...] = ()
    steps: tuple[tuple[str, float], ...] = ()

    @property
    def chunked(self) -> bool:
        """Whether a table can be cut into chunks."""
        return any(array.chunk for array in self.arrays)

    @property
    def bytes(self) -> int:
        """Bytes of flash of all tables of numbers."""
        return sum(array.bytes for array in self.arrays)


def literal(value: float | np.generic, ctype: str) -> str:
    """Return a constant of a type as C writes it.

    Examples
    --------
    >>> literal(0.1, "float"), literal(3, "float"), literal(-7, "int8_t")
    ('0.1f', '3.0f', '-7')
    """
    if ctype == "float":
        # NumPy prints the shortest decimal that reads back as the same single.
        return f"{np.float32(value)!s}f"
    if ctype == "uint32_t":
        return f"{int(value)}u"
    return str(int(value))

"""Hold what a codec hands over: its numbers in order, and what reads them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from lutgen.errors import InputError


@dataclass(frozen=True, eq=False)
class CArray:
    """Numbers of one type, such as ``uint8_t`` or ``float``, that stand in the blob in C order.

    `comment` says in one line what they are, their axes and their unit; `table` whether they are
    the robot's own, and no part of the descriptor.
    """

    name: str
    ctype: str
    values: ArrayLike
    comment: str = ""
    table: bool = True

    def __post_init__(self) -> None:
        found = np.asarray(self.values)
        held = found.astype("f4" if self.ctype == "float" else self.ctype.removesuffix("_t"))
        if not (np.isfinite(found).all() and (self.ctype == "float" or (held == found).all())):
            raise InputError(
                f"table {self.name}: its values do not fit {self.ctype} (got {found.dtype}); "
                "quantise them first."
            )
        object.__setattr__(self, "values", held)

    @property
    def packed(self) -> bytes:
        """The values as they stand in flash, little-endian."""
        held = np.asarray(self.values)
        return held.astype(held.dtype.newbyteorder("<")).tobytes()

    @property
    def bytes(self) -> int:
        """Bytes of flash."""
        return int(np.asarray(self.values).nbytes)


@dataclass(frozen=True)
class CBody:
    """A codec's part of a blob, and what reads it.

    `codec` is its number in runtime/smap_map.h, and `contacts` is the number that the runtime asks
    for.  `arrays` follow each other in the order in which the runtime's file for the codec
    describes them, `macros` say how many there are of what, such as ``("SMAP_MAX_ENTRIES", 5)``.
    `pose` are the words of 32 bits of a pose beside the map's address, with both forms and with
    integers alone; `swept` those for a box of postures, as on-board control makes it.  `step` is
    the length of a step of the integer form, `lengths` those of ``"sdg"`` and ``"height"`` where
    they differ; the integer form may read a sine too high by `rounded` 1/32767.
    """

    codec: int
    arrays: tuple[CArray, ...]
    contacts: int = 3
    macros: tuple[tuple[str, int], ...] = ()
    pose: tuple[int, int] = (1, 1)
    step: float = 1.0
    rounded: int = 3
    lengths: tuple[tuple[str, float], ...] | None = None
    swept: int = 1

    @property
    def steps(self) -> dict[str, float]:
        """Value of one step of the integer readings."""
        if self.lengths is None:
            return {"sdg": self.step, "height": self.step}
        return dict(self.lengths)

    @property
    def bytes(self) -> int:
        """Bytes of flash of all tables."""
        return sum(array.bytes for array in self.arrays if array.table)


def literal(value: float | np.generic, ctype: str) -> str:
    """Return a constant of a type as C writes it, such as ``0.1f``."""
    if ctype == "float":
        # NumPy prints the shortest decimal that reads back as the same single.
        return f"{np.float32(value)!s}f"
    return f"{int(value)}u" if ctype == "uint32_t" else str(int(value))

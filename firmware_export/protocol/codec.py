"""Say what a codec is, what it hands over, and what an export of it is: others use only this."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from firmware_export.model import Cells, Model
from firmware_export.protocol.policy import Policy
from lutgen.errors import InputError, reject
from lutgen.recipe import Recipe
from lutgen.vector import Floats


@dataclass(frozen=True, eq=False)
class CArray:
    """Numbers of one type, such as ``uint8_t`` or ``float``, that stand in the blob in C order.

    `comment` says in one line what they are, their axes and their unit; `table` True if they are
    the robot's own, and no part of the descriptor.
    """

    name: str
    ctype: str
    values: ArrayLike
    comment: str = ""
    table: bool = True

    def __post_init__(self) -> None:
        found = np.asarray(self.values)
        kind = np.dtype("f4" if self.ctype == "float" else self.ctype.removesuffix("_t"))
        stored = found.astype(kind.newbyteorder("<"))
        if not (np.isfinite(found).all() and (self.ctype == "float" or (stored == found).all())):
            what, way_out = f"its values do not fit {self.ctype}", "quantise them first"
            reject(f"table {self.name}", what, found.dtype, way_out, InputError)
        object.__setattr__(self, "values", stored)

    @property
    def packed(self) -> bytes:
        """The values as they stand in flash, little-endian."""
        return np.asarray(self.values).tobytes()

    @property
    def bytes(self) -> int:
        """Bytes of flash."""
        return int(np.asarray(self.values).nbytes)


@dataclass(frozen=True)
class CBody:
    """A codec's part of a blob, and what reads it.

    `codec` is its number in runtime/smap_map.h, and `contacts` is the number that the runtime needs
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


def literal(value: float) -> str:
    """Return a float constant as C writes it, such as ``0.1f``."""
    # NumPy prints the shortest decimal that reads back as the same single.
    return f"{np.float32(value)!s}f"


# The names of channels, in the order of `quantities.EXPORTABLE`.
Channels = tuple[str, ...]


class Tables(ABC):
    """An encoded robot.

    `spec` is the size, hashable, of which equal ones give the same tables; `guard` (rad) is
    subtracted from tip_angle, and `guard_text` says in a sentence how it was bounded; `tested`
    tables are never falsely safe by a test on many points, and no bound.
    """

    spec: Any
    guard: float
    guard_text: str
    tested = False

    @abstractmethod
    def body(self, integer: bool) -> CBody:
        """Return the codec's part of the blob, read with floats or without."""

    def cells(self, model: Model) -> Cells | None:
        """Return the knots of the tables, in whose middles errors are largest."""
        return None

    def guarded(self, guard: float) -> Self | None:
        """Return the tables with a larger guard (rad), None if that would prove nothing."""
        return None

    def lowered(self, params: Floats, gravity: Floats, seed: int) -> Self:
        """Return tested tables that call no point of (n, k) and (n, 3) safe."""
        return self


class Codec(ABC):
    """A way to hold a robot.

    Two codecs may share a `name`, by which people call them: then at most one of them holds a given
    robot.
    """

    name: str

    @abstractmethod
    def refusal(self, model: Model, arithmetic: str) -> str | None:
        """Return why the codec cannot hold this robot, in one sentence, or None."""

    @abstractmethod
    def sizes(self, model: Model, channels: Channels, most: int | None = None) -> list[Any]:
        """Return the sizes worth trying, the smallest and least accurate first.

        A codec that takes minutes for one returns the largest whose tables have `most` bytes.
        """

    @abstractmethod
    def encode(self, model: Model, channels: Channels, spec: Any) -> Any:
        """Return tables, fitted and quantised: the same for the same arguments."""

    def export(
        self,
        model: Model,
        name: str,
        channels: Channels,
        arithmetic: str = "float",
        spec: Any = None,
    ) -> "Export":
        """Return an export that is not certified, of the smallest size or a given one."""
        spec = self.sizes(model, channels)[0] if spec is None else spec
        tables = self.encode(model, channels, spec)
        return Export(name, model.recipe, model, self.name, arithmetic, channels, tables)


@dataclass(frozen=True, eq=False)
class Export:
    """A map's tables, chosen and certified, before it becomes C.

    `name` is the C identifier and the stem of the files, `model` the exact function that the tables
    stand for, `channels` a part of `quantities.EXPORTABLE` in that order.  `certificate` is what
    was measured, see `certify.Certificate` (each key may be absent); `policy` is None for an export
    that is only read.
    """

    name: str
    recipe: Recipe
    model: Model
    codec: str
    arithmetic: str
    channels: Channels
    tables: Any
    certificate: dict[str, Any] | None = None
    policy: Policy | None = None

    @property
    def integer(self) -> bool:
        """True if the export answers smap_read_i."""
        return self.arithmetic == "integer"

    @cached_property
    def body(self) -> CBody:
        """The codec's part of the blob, as this export is read."""
        found: CBody = self.tables.body(self.integer)
        return found

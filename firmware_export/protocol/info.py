"""What a codec is to the rest of the export: one `CodecInfo` each, listed in `codecs`.

Owns the protocol.  Whoever chooses, certifies, measures or writes an export asks only what stands
here; everything else about a codec is its room's own.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from firmware_export.protocol.array import CBody
from firmware_export.truth import Cells, Model
from lutgen.vector import Floats


class Tables(ABC):
    """What a codec has encoded.

    Attributes
    ----------
    spec : object
        The size that was asked for: hashable, and two that are equal give the same tables.  Its
        `label` is a short text for tables and reports, such as ``contacts i8 4+4``.
    guard : float
        Angle (rad) that is subtracted from tip_angle.
    guard_text : str
        How it was bounded, one sentence.
    """

    spec: Any
    guard: float
    guard_text: str

    @property
    @abstractmethod
    def bytes(self) -> int:
        """Bytes of all tables of numbers."""

    @property
    def tested(self) -> bool:
        """Whether nothing but many points says that it is never falsely safe."""
        return False

    def lowered(self, params: Floats, gravity: Floats, seed: int) -> "Tables":
        """Return tested tables that call none of some points (n, k) and (n, 3) safe."""
        return self


@dataclass(frozen=True, eq=False)
class CodecInfo:
    """A codec.

    Parameters
    ----------
    name : str
        What people and reports call it.  Two codecs may share a name and the C that reads their
        tables: then at most one of them holds a given robot.
    families : mapping of str to str
        The smallest family of the runtime for each arithmetic that the codec has.
    look : (str, str)
        Colour and marker of its candidates in figures.
    refusal : callable
        (model, arithmetic) -> why the codec cannot hold this robot, in one sentence, or None.
    sizes : callable
        (model, channels, arithmetic) -> the smallest sensible sizes, one for each bit width.
    grow : callable
        (model, spec) -> the next larger sizes, such as one for each axis.
    encode : callable
        (model, channels, spec) -> tables, fitted and quantised; the same for the same arguments.
    c_body : callable
        (tables, integer) -> its part of the blob, read with floats or without.
    read_label : callable
        (label) -> the size with that label.
    bytes : callable, optional
        (spec) -> bytes of the tables at least, known before anything is encoded.
    cells : callable
        (model, tables) -> the knots of the tables, or None where there are none.
    size : callable, optional
        (model, channels, bytes, percent) -> the one size that is worth its minutes of training:
        the largest of so many bytes of tables, or the smallest for an error of |SD_g|.
    exact : callable
        (model) -> whether its answers are exact but for rounding, or all others take far more: then
        no other is tried where it will do.
    guarded : callable, optional
        (tables, guard) -> the tables with another guard (rad) and what is said of it, or None.
    encodings : int
        Encodings that may be spent on one bit width.
    patience, gain : int, float
        Steps in a row that may fail to lower the score to this share of the best before no larger
        size is tried.
    """

    name: str
    families: Mapping[str, str]
    look: tuple[str, str]
    refusal: Callable[[Model, str], str | None]
    sizes: Callable[[Model, tuple[str, ...], str], list[Any]]
    grow: Callable[[Model, Any], list[Any]]
    encode: Callable[[Model, tuple[str, ...], Any], Any]
    c_body: Callable[[Any, bool], CBody]
    read_label: Callable[[str], Any]
    bytes: Callable[[Any], int] | None = None
    cells: Callable[[Model, Any], Cells | None] = lambda model, tables: None
    size: Callable[[Model, tuple[str, ...], int, float | None], Any] | None = None
    exact: Callable[[Model], bool] = lambda model: False
    guarded: Callable[[Any, float], Any] | None = None
    encodings: int = 40
    patience: int = 3
    gain: float = 0.98

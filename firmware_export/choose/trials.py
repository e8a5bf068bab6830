"""One possible export, encoded and measured on the chooser's own sample.

Owns the sample by which candidates are compared: neither the fits nor the certificate use it, so
that choosing the best of many does not flatter the certificate.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from firmware_export.certify import (
    Measured,
    Truth,
    bounded,
    device,
    find_jumps,
    judged_by,
    span_of,
    statistics,
    truth,
)
from firmware_export.emit import flash_bytes
from firmware_export.protocol import CodecInfo, Export
from firmware_export.truth import Model, biased, uniform
from lutgen.errors import InputError

SEED = 501
POINTS = 15_000


@dataclass(frozen=True, eq=False)
class Candidate:
    """An encoded export and what the chooser measured on it.

    Parameters
    ----------
    export : Export
        Without certificate.
    bytes, total : int
        Bytes of tables; and with descriptors and code as far as those are known.
    errors : dict of str to float
        Per length channel its error in percent of the range: the largest, or p99 where |SD_g|
        jumps; for an export of the tip angle alone that of the tip angle.
    false_tip : float
        Share of the standing uniform points that are called tipping.
    false_safe : int
        Points that are called safe and tip; any is a fault.
    """

    export: Export
    bytes: int
    total: int
    errors: dict[str, float]
    false_tip: float
    false_safe: int

    @property
    def label(self) -> str:
        """Short text for tables."""
        return str(self.export.tables.spec.label)

    @property
    def error(self) -> float:
        """The greatest of `errors`, percent."""
        return max(self.errors.values())

    def row(self, chosen: bool) -> dict[str, Any]:
        """Return the row of the table of candidates."""
        return {
            "codec": self.export.codec,
            "label": self.label,
            "bytes": self.bytes,
            "total_bytes": self.total,
            "error": next(iter(self.errors.values())),
            "errors": self.errors,
            "false_tip": self.false_tip,
            "chosen": chosen,
        }


class Trials:
    """Encodes and measures candidates, each once; what it is made of is told in `Export`."""

    def __init__(self, model: Model, name: str, channels: tuple[str, ...], arithmetic: str) -> None:
        self.model, self.name = model, name
        self.channels, self.arithmetic = channels, arithmetic
        self.tried: dict[tuple[CodecInfo, Any], Candidate | None] = {}
        self.refused: dict[str, str] = {}  # by codec what it said last of a size
        self.jumps = find_jumps(model, SEED)

    @cached_property
    def sample(self) -> list[Truth]:
        """The sample: uniform points, then biased ones."""
        integer = self.arithmetic == "integer"
        return [
            truth(self.model, points(self.model, POINTS, SEED), integer)
            for points in (uniform, biased)
        ]

    @property
    def bounded(self) -> tuple[str, ...]:
        """The channels whose errors count."""
        return bounded(self.channels)

    @cached_property
    def ranges(self) -> dict[str, float]:
        """The ranges of the channels that count, over the standing points of the sample."""
        return {channel: span_of(self.sample, channel) for channel in self.bounded}

    @property
    def candidates(self) -> list[Candidate]:
        """What was tried and could be encoded."""
        return [one for one in self.tried.values() if one is not None]

    def try_out(self, codec: CodecInfo, spec: Any) -> Candidate | None:
        """Return a candidate, None for a size that the codec cannot encode."""
        key = (codec, spec)
        if key not in self.tried:
            try:
                tables = codec.encode(self.model, self.channels, spec)
            except InputError as error:
                self.tried[key] = None
                self.refused[codec.name] = str(error)
            else:
                self.tried[key] = self.assess(codec, tables)
        return self.tried[key]

    def bytes_of(self, codec: CodecInfo, tables: Any) -> tuple[Export, int, int]:
        """Return the export of tables, their bytes, and those with descriptors and code."""
        model = self.model
        export = Export(
            *(self.name, model.recipe, model, codec.name, self.arithmetic, self.channels, tables)
        )
        size = flash_bytes(export, codec.c_body(tables, self.arithmetic == "integer"))
        return export, size["tables"], size["total"]

    def assess(self, codec: CodecInfo, tables: Any) -> Candidate:
        """Measure tables."""
        export, size, total = self.bytes_of(codec, tables)
        asked = device(export)
        seen = [asked.compare(known) for known in self.sample]
        return Candidate(
            export,
            size,
            total,
            {channel: self._error(seen, channel) for channel in self.bounded},
            seen[0].false_tip,
            # What is tested is lowered by the certificate, until it finds none.
            0 if tables.tested else sum(int(one.false_safe.sum()) for one in seen),
        )

    def _error(self, seen: list[Measured], channel: str) -> float:
        found = statistics(seen, channel)[judged_by(channel, self.jumps.found)]
        span = self.ranges[channel]
        return 100.0 * found / span if span > 0.0 else 0.0

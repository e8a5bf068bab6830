"""Sizes and error bounds as people write them: ``16KiB``, ``1.4kB``, ``1%``."""

import math
import re
from dataclasses import dataclass

from lutgen.errors import InputError, reject

# k is 1000 as in SI; the smaller reading never promises bytes that are not there.
_FACTORS = {"": 1, "k": 1000, "ki": 1024, "m": 1000_000, "mi": 1024 * 1024}
_SIZE = re.compile(r"([0-9]+(?:\.[0-9]*)?|\.[0-9]+) ?(|k|ki|m|mi)b?", re.IGNORECASE)


def parse_size(text: str | int) -> int:
    """Return a number of bytes.

    Examples
    --------
    >>> [parse_size(text) for text in ("16KiB", "64k", "4096", "1.4kB", 100)]
    [16384, 64000, 4096, 1400, 100]
    """
    match = _SIZE.fullmatch(str(text).strip())
    size = float(match[1]) * _FACTORS[match[2].lower()] if match else 0.0
    if not 1.0 <= size <= 2.0**40:
        what = f"{str(text)!r} is no size of 1 byte or more"
        way_out = "write for example 16KiB, 64k or 4096"
        reject("flash size", what, repr(str(text)), way_out, InputError)
    return int(size)


@dataclass(frozen=True)
class ErrorBound:
    """A largest error of |SD_g|: `value` in percent of its range, or in the length unit."""

    value: float
    relative: bool

    def __str__(self) -> str:
        return f"{self.value:g}{' %' if self.relative else ''}"


def parse_error(text: str | float) -> ErrorBound:
    """Return an error bound.

    Examples
    --------
    >>> parse_error("1%"), parse_error("0.05")
    (ErrorBound(value=1.0, relative=True), ErrorBound(value=0.05, relative=False))
    """
    number, percent, rest = str(text).strip().partition("%")
    try:
        value = float(number)
    except ValueError:
        value = math.nan
    if rest or not (0.0 < value < math.inf):
        what = f"{str(text)!r} is no error above 0"
        way_out = "write for example 1% of the range, or 0.05 in the recipe's length unit"
        reject("largest error", what, repr(str(text)), way_out, InputError)
    return ErrorBound(value, bool(percent))

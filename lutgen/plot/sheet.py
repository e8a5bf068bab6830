"""Sheet: how wide a figure is and in which style it is drawn, where somebody asks.

Every kind of figure has a size of its own, in which its words are legible in a column of a journal.
"""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

from lutgen.errors import InputError

STYLES = ("journal", "slides", "dark")
INCH = 25.4
# mm: narrower a legend has no room, and wider is a poster.
NARROWEST, WIDEST = 80.0, 1000.0
# How many times as many dots a picture for a slide has, each way: a column as wide as a slide.
SLIDE = 2.7


@dataclass(frozen=True)
class Sheet:
    """Width and height in mm, None for the figure's own, and one of `STYLES`."""

    width: float | None = None
    height: float | None = None
    style: str = "journal"

    def size_of(self, own: tuple[float, float]) -> tuple[float, float]:
        """Return the size of a figure in inches, given its own."""
        if self.width is None:
            return own
        wide = self.width / INCH
        return wide, own[1] * wide / own[0] if self.height is None else self.height / INCH


OWN = Sheet()
_sheet: ContextVar[Sheet] = ContextVar("sheet", default=OWN)


def sheet() -> Sheet:
    """Return the sheet that figures are drawn on now."""
    return _sheet.get()


@contextmanager
def on_sheet(size: str | None = None, style: str = "journal") -> Iterator[None]:
    """Draw figures of a size (``"85"`` or ``"85x60"``, mm) and in a style, within a with block.

    Raises
    ------
    InputError
        For a size that is none, or not from 80 to 1000 mm, and for an unknown style.
    """
    if style not in STYLES:
        raise InputError(f"unknown style (got {style!r}); use {', '.join(STYLES)}")
    width = height = None
    if size is not None:
        found = re.fullmatch(r"(\d+(?:\.\d+)?)(?:x(\d+(?:\.\d+)?))?", size.strip())
        if found is None:
            raise InputError(f"a size is WIDTH or WIDTHxHEIGHT in mm (got {size!r}); try 85")
        width, height = (None if part is None else float(part) for part in found.groups())
        for part in (width, height):
            if part is not None and not NARROWEST <= part <= WIDEST:
                raise InputError(
                    f"a figure is {NARROWEST:g} to {WIDEST:g} mm wide and high (got {part:g}); "
                    "85 mm is a column of a journal"
                )
    token = _sheet.set(Sheet(width, height, style))
    try:
        yield
    finally:
        _sheet.reset(token)

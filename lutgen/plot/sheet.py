"""Sheet: how wide a figure is and in which style it is drawn, if that is given."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from lutgen.errors import InputError, reject

STYLES = ("journal", "slides", "dark")
INCH = 25.4
# mm: letters of a narrower figure cannot be read, and a wider one is a poster.
NARROWEST, WIDEST = 80.0, 1000.0


@dataclass(frozen=True)
class Sheet:
    """Width and height in mm, None for the figure's own, and one of `STYLES`."""

    width: float | None = None
    height: float | None = None
    style: str = "journal"


OWN = Sheet()
_sheet: ContextVar[Sheet] = ContextVar("sheet", default=OWN)
# The sheet that figures are drawn on now.
sheet = _sheet.get


@contextmanager
def on_sheet(size: str | None = None, style: str = "journal") -> Iterator[None]:
    """Draw figures of a size (``"85"`` or ``"85x60"``, mm) and in a style, within a with block.

    A figure keeps its shape: with a height it is as large as fits.
    """
    if style not in STYLES:
        reject("style", "unknown style", repr(style), f"use {', '.join(STYLES)}", InputError)
    width = height = None
    if size is not None:
        found = re.fullmatch(r"(\d+(?:\.\d+)?)(?:x(\d+(?:\.\d+)?))?", size.strip())
        if found is None:
            what = "must be WIDTH or WIDTHxHEIGHT in mm"
            reject("size", what, repr(size), "try 85", InputError)
        width, height = (None if part is None else float(part) for part in found.groups())
        for part in (width, height):
            if part is not None and not NARROWEST <= part <= WIDEST:
                what = f"a figure is {NARROWEST:g} to {WIDEST:g} mm wide and high"
                reject("size", what, f"{part:g}", "85 mm is a column of a journal", InputError)
    token = _sheet.set(Sheet(width, height, style))
    try:
        yield
    finally:
        _sheet.reset(token)


def resize(figure: Figure) -> None:
    """Scale a finished figure to the sheet, with its letters and lines."""
    page = sheet()
    if page.width is None:
        return
    width, height = figure.get_size_inches() * INCH
    scale = min(page.width / width, (page.height or np.inf) / height)
    figure.set_size_inches(figure.get_size_inches() * scale)
    ticks = set()
    for axis in (axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)):
        # The short side of a colour bar has no ticks.
        first: list[Any] = axis.get_major_ticks()[:1]
        for tick in first:
            look: dict[str, Any] = {"labelsize": tick.label1.get_fontsize()}
            look |= {"length": tick.tick1line.get_markersize(), "pad": tick.get_pad()}
            look |= {"width": tick.tick1line.get_markeredgewidth()}
            axis.set_tick_params(**{name: scale * value for name, value in look.items()})
        axis.labelpad *= scale
        ticks |= {id(part) for tick in axis.get_major_ticks() for part in tick.findobj()}
    sizes = ("fontsize", "markersize", "markeredgewidth", "linewidth", "mutation_scale")
    every: list[Any] = figure.findobj()
    every += [a.arrow_patch for a in every if getattr(a, "arrow_patch", None) is not None]
    for artist in every:
        if id(artist) in ticks:
            continue
        for name in sizes:
            if hasattr(artist, f"set_{name}") and hasattr(artist, f"get_{name}"):
                value = np.asarray(getattr(artist, f"get_{name}")()) * scale
                getattr(artist, f"set_{name}")(value if value.ndim else float(value))
        if getattr(artist, "anncoords", None) == "offset points":
            artist.xyann = tuple(scale * np.array(artist.xyann))
        for effect in artist.get_path_effects() or ():
            stroke: Any = effect
            wide = scale * stroke._gc["linewidth"]
            artist.set_path_effects([withStroke(**(stroke._gc | {"linewidth": wide}))])

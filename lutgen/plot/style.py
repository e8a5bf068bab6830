"""Look of the figures: type, lines and colours, and how a figure becomes a file.

Everything is set on the figure itself or inside a context, so a program's own matplotlib settings
stay untouched.  It knows nothing of robots.
"""

import functools
import io
import os
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, ParamSpec

import matplotlib.style
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from lutgen.errors import InputError
from lutgen.files import write_bytes
from lutgen.plot.dark import darken
from lutgen.plot.fonts import families, said_once
from lutgen.plot.palette import GREY
from lutgen.plot.sheet import SLIDE, sheet

P = ParamSpec("P")

RESOLUTION = 200
# Of a line of text, times the size of its letters.
LINE = 1.25
SETTINGS: dict[str, Any] = {
    "font.size": 7.5,
    "mathtext.fontset": "dejavusans",
    "axes.labelsize": 7.5,
    "axes.titlesize": 7.5,
    "axes.titlelocation": "left",
    "axes.linewidth": 0.6,
    "figure.titlesize": 7.5,
    "xtick.labelsize": 7,
    "ytick.labelsize": 7,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "grid.linewidth": 0.4,
    "grid.color": "#b0b0b0",
    "legend.fontsize": 7,
    "legend.frameon": False,
    "legend.handlelength": 1.6,
    "lines.linewidth": 1.2,
    "hatch.linewidth": 0.4,
    "hatch.color": GREY,
    "pdf.fonttype": 42,
    "svg.hashsalt": "lutgen",
    # Text that can be searched, read aloud and set in the font of a page.
    "svg.fonttype": "none",
}
# The mark of our files (lutgen/files.py).  Dates would make two runs differ, and the program's name
# two versions of matplotlib.
METADATA: dict[str, dict[str, Any]] = {
    ".png": {"Software": "lutgen"},
    ".svg": {"Date": None, "Creator": "lutgen"},
    ".pdf": {"CreationDate": None, "Creator": "lutgen", "Producer": "lutgen"},
}


def house_style() -> AbstractContextManager[None]:
    """Apply the settings inside a with block, whatever the user's own are."""
    return matplotlib.style.context(["default", {**SETTINGS, "font.family": families()}])


def new_figure(size: tuple[float, float]) -> Figure:
    """Return an empty figure, `size` in inches, that lays itself out."""
    layout = ConstrainedLayoutEngine(w_pad=0.03, h_pad=0.03)
    figure = Figure(figsize=sheet().size_of(size), layout=layout, dpi=RESOLUTION)
    FigureCanvasAgg(figure)
    return figure


def head(figure: Figure, words: str) -> None:
    """Write a title over a figure, which grows by the lines that it has more than two of."""
    figure.suptitle(words, x=0.01, ha="left")
    width, height = figure.get_size_inches()
    more = max(words.count("\n") - 1, 0)
    figure.set_size_inches(width, height + more * LINE * SETTINGS["figure.titlesize"] / 72.0)


def in_house_style(paint: Callable[P, Figure]) -> Callable[P, Figure]:
    """Make a function draw with the settings, and fix the layout of the figure that it returns."""

    @functools.wraps(paint)
    def painted(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with house_style():
            with said_once():
                figure = paint(*args, **kwargs)
                # The layout would move a little with every further drawing, and two savings too.
                figure.draw_without_rendering()
            figure.set_layout_engine("none")
            if sheet().style == "dark":
                darken(figure)
            return figure

    return painted


def known_suffix(path: str | os.PathLike[str], kind: str, known: Iterable[str]) -> str:
    """Return what a name ends in, in small letters; refuse what is not known."""
    suffix = Path(path).suffix.lower()
    *most, last = known
    if suffix not in (*most, last):
        raise InputError(
            f"{path}: unknown kind of {kind} (got {suffix or 'no suffix'!r}); "
            f"end the name in {', '.join(most)} or {last}."
        )
    return suffix


def save(
    figure: Figure, path: str | os.PathLike[str], dpi: int = RESOLUTION, force: bool = False
) -> None:
    """Write a figure as PNG, SVG or PDF, whichever the path ends in.

    The same figure gives the same bytes; the file appears under its name only when it is whole.
    A file that lutgen did not make is replaced with `force` only; InputError is raised otherwise.
    """
    target = Path(path)
    suffix = known_suffix(target, "picture", METADATA)
    picture = io.BytesIO()
    with house_style(), said_once():
        if sheet().style == "slides":
            dpi = round(SLIDE * dpi)
        figure.savefig(picture, dpi=dpi, format=suffix[1:], metadata=METADATA[suffix])
    failed = "the picture cannot be written"
    write_bytes(target, picture.getvalue(), failed=failed, force=force)

"""Style: sizes, colours, letters and pages of all figures, and how a figure becomes a file.

Lengths on a page are inches of a sheet 8 in wide.  A program's own matplotlib settings are neither
read nor changed.
"""

import functools
import io
import logging
import os
import re
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, ParamSpec

import matplotlib.style
import numpy as np
from matplotlib import colormaps, font_manager
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patheffects import AbstractPathEffect, withStroke
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from lutgen.errors import InputError, reject
from lutgen.files import write_bytes
from lutgen.plot.labels import folded

log = logging.getLogger("lutgen")

# DejaVu comes with matplotlib; the others have letters that it lacks, if installed.
KNOWN = (
    *("DejaVu Sans", "Noto Sans CJK SC", "Noto Sans CJK JP", "Noto Sans CJK KR", "Noto Sans SC"),
    *("Noto Sans JP", "Source Han Sans SC", "WenQuanYi Zen Hei", "WenQuanYi Micro Hei"),
    *("IPAGothic", "Unifont", "Droid Sans Fallback", "PingFang SC", "Hiragino Sans"),
    *("Apple SD Gothic Neo", "Microsoft YaHei", "Yu Gothic", "Malgun Gothic", "Arial Unicode MS"),
    *("Noto Sans Devanagari", "Noto Sans Thai", "Noto Sans Bengali", "Noto Sans Tamil"),
)
_MISSING = re.compile(r"Glyph (\d+) .* missing from")
P = ParamSpec("P")

HERE = Path(__file__).parent
WIDTH, RESOLUTION = 8.0, 200
# Larger PNG files (bytes) get a palette.
LARGEST = 250_000
# The mark of our files (lutgen/files.py); dates and versions would make two runs differ.
METADATA: dict[str, dict[str, Any]] = {
    ".png": {"Software": "lutgen"},
    ".svg": {"Date": None, "Creator": "lutgen"},
    ".pdf": {"CreationDate": None, "Creator": "lutgen", "Producer": "lutgen"},
}
STYLES = ("journal", "dark")
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
        sides = [float(part) for part in found.groups() if part] if found else []
        if not (sides and all(NARROWEST <= side <= WIDEST for side in sides)):
            what = f"must be WIDTH or WIDTHxHEIGHT, {NARROWEST:g} to {WIDEST:g} mm each"
            reject("size", what, repr(size), "85 is a column of a journal", InputError)
        width, height = (*sides, None)[:2]
    token = _sheet.set(Sheet(width, height, style))
    try:
        yield
    finally:
        _sheet.reset(token)


@cache
def families() -> tuple[str, ...]:
    """Return the fonts to take letters from, the first that has one."""
    installed = {font.name for font in font_manager.fontManager.ttflist}
    return tuple(name for name in KNOWN if name in installed)


@contextmanager
def said_once() -> Iterator[None]:
    """Say in one sentence which letters drawn within a with block no font has."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield
    missing = set()
    for warning in caught:
        if found := _MISSING.search(str(warning.message)):
            missing.add(chr(int(found[1])))
        else:
            place = (warning.filename, warning.lineno)
            warnings.warn_explicit(warning.message, warning.category, *place)
    if missing:
        letters = "".join(sorted(missing))
        log.warning(
            "no font here has the letters %s, which are drawn as boxes; install one that has, such "
            "as Noto Sans CJK",
            letters if len(letters) < 20 else f"{letters[:20]}...",
        )


@dataclass(frozen=True)
class Colours:
    """The colours of a sheet: paper and ink, accents, and the solids of a robot.

    `blue` is what a figure is about, `red` where the robot tips over first.
    """

    paper: str = "#ffffff"
    ink: str = "#1d2733"
    soft: str = "#5c6975"
    faint: str = "#d3d9e0"
    blue: str = "#0072b2"
    red: str = "#c8102e"
    wash: str = "#eef1f4"
    pale: str = "#c7e0ee"
    body: str = "#c3cdd7"
    track: str = "#8492a0"
    slab: str = "#e3e8ed"
    hatch: str = "#9aa5b1"
    edge: str = "#1d2733"


LIGHT = Colours()
DARK = Colours(
    *("#11161d", "#e6ebf1", "#9fabb8", "#37424f", "#56b4e9", "#ff6b5e", "#1c242e", "#203648"),
    *("#8797a8", "#5c6b7a", "#26303b", "#566373", "#0a0d11"),
)
# Marks on a colour scale look the same on both sheets.
BLACK = "#111820"
# One colour is one angle (deg) in all figures; 60 deg and more look alike.  Bright is good.
TOP = 60.0
ANGLES = colormaps["viridis"]
FACTOR = ListedColormap(colormaps["magma_r"](np.linspace(0.03, 0.85, 256)), "magma_r, 3 to 85 %")


def colours() -> Colours:
    """Return the colours of the sheet that is drawn on."""
    return DARK if sheet().style == "dark" else LIGHT


def house_style() -> AbstractContextManager[None]:
    """Apply the style sheets inside a with block, over the user's own settings."""
    sheets = [HERE / "light.mplstyle"]
    sheets += [HERE / "dark.mplstyle"] if sheet().style == "dark" else []
    own = {"font.family": families(), "hatch.color": colours().hatch}
    return matplotlib.style.context(["default", *sheets, own])


def in_house_style(paint: Callable[P, Figure]) -> Callable[P, Figure]:
    """Make a function draw in the style, and fix the layout and the size of its figure."""

    @functools.wraps(paint)
    def painted(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with house_style(), said_once():
            figure = paint(*args, **kwargs)
            if kwargs.get("ax") is None:
                figure.draw_without_rendering()
                resize(figure)
        return figure

    return painted


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


def new_figure(size: tuple[float, float]) -> Figure:
    """Return an empty figure, `size` in inches."""
    figure = Figure(figsize=size, dpi=RESOLUTION)
    FigureCanvasAgg(figure)
    return figure


def page(height: float, sentence: str, note: str) -> Figure:
    """Return a figure with its answer in bold, and below it what is shown.

    `height` (inches) is that of what is drawn; the page is as much higher as the words need.
    """
    figure, lines = new_figure((WIDTH, height)), []
    title = figure.text(0.03, 1.0, sentence, size=15, weight="bold", va="top")
    below = figure.text(0.03, 1.0, note, size=10.5, va="top", linespacing=1.35)
    below.set_color(colours().soft)
    for text, words, most in ((title, sentence, 66), (below, note, 104)):
        for letters in range(most, 16, -6):
            text.set_text(folded(words, letters))
            if text.get_window_extent().width <= 0.94 * WIDTH * RESOLUTION:
                break
        lines.append(text.get_text().count("\n") + 1)
    first = 0.22 + 0.27 * lines[0]
    whole = height + first + 0.21 * lines[1] + 0.14
    figure.set_size_inches(WIDTH, whole)
    title.set_y(1.0 - 0.20 / whole)
    below.set_y(1.0 - first / whole)
    return figure


def place(figure: Figure, box: tuple[float, float, float, float]) -> Axes:
    """Return axes in a box of the page: left, bottom, width and height in inches."""
    wide, high = figure.get_size_inches()
    left, bottom, width, height = box
    return figure.add_axes((left / wide, bottom / high, width / wide, height / high))


def bare(axes: Axes) -> Axes:
    """Return axes without frame, in equal scales."""
    axes.set_aspect("equal")
    axes.set_axis_off()
    return axes


def halo(width: float = 3.0, colour: Any = None) -> list[AbstractPathEffect]:
    """Return what keeps words legible on lines."""
    return [withStroke(linewidth=width, foreground=colour or colours().paper)]


def ink_on(fill: Any) -> str:
    """Return white or black, whichever is read better on a colour."""
    # Linear light; above this black has the higher contrast.
    bright = np.asarray(fill)[:3] ** 2.2 @ [0.2126, 0.7152, 0.0722]
    return "white" if float(bright) < 0.2 else BLACK


def known_suffix(path: str | os.PathLike[str], kind: str, known: Iterable[str]) -> str:
    """Return the suffix of a name in small letters; refuse an unknown one."""
    suffix = Path(path).suffix.lower()
    *most, last = known
    if suffix not in (*most, last):
        way_out = f"end the name in {', '.join(most)} or {last}"
        reject(path, f"unknown kind of {kind}", repr(suffix or "no suffix"), way_out, InputError)
    return suffix


def save(
    figure: Figure, path: str | os.PathLike[str], dpi: int = RESOLUTION, force: bool = False
) -> None:
    """Write a figure as PNG, SVG or PDF, by the suffix of the path.

    The same figure gives the same bytes; the file appears under its name when it is whole.
    InputError is raised for a file that lutgen did not make, unless `force` is set.
    """
    suffix, picture = known_suffix(path, "picture", METADATA), io.BytesIO()
    with house_style(), said_once():
        figure.savefig(picture, dpi=dpi, format=suffix[1:], metadata=METADATA[suffix])
    if suffix == ".png" and picture.tell() > LARGEST:
        whole, picture, mark = Image.open(picture).convert("RGB"), io.BytesIO(), PngInfo()
        few = whole.quantize(256, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
        # White stays white.
        few.putpalette([255 if part == 254 else part for part in few.getpalette() or []])
        mark.add_text("Software", "lutgen")
        few.save(picture, "PNG", pnginfo=mark)
    failed = "the picture cannot be written"
    write_bytes(Path(path), picture.getvalue(), failed=failed, force=force)

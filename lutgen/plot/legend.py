"""Legend: the samples below a figure, in as many columns as its width has room for."""

from collections.abc import Sequence
from typing import Any

from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.legend import Legend

from lutgen.plot.words import folded

# Between a legend and the edges of the paper (dots), and the letters of a line that are tried.
EDGE, LONGEST, SHORTEST = 6.0, 60, 12


def add_legend(
    figure: Figure,
    handles: Sequence[Artist],
    columns: int = 2,
    place: Any = "outside lower center",
    **look: Any,
) -> Legend:
    """Add a legend that stays on the paper: of fewer columns, or with long words folded."""
    look = {"columnspacing": 1.2, **look}
    room = figure.bbox.width - 2.0 * EDGE
    legend: Legend
    for count in range(columns, 0, -1):
        legend = figure.legend(handles=list(handles), loc=place, ncols=count, **look)
        if _width(figure, legend) <= room:
            return legend
        if count > 1:
            legend.remove()
    words = [text.get_text() for text in legend.get_texts()]
    for longest in range(LONGEST, SHORTEST, -4):
        for text, whole in zip(legend.get_texts(), words, strict=True):
            text.set_text(folded(whole, longest))
        if _width(figure, legend) <= room:
            break
    return legend


def _width(figure: Figure, legend: Legend) -> float:
    """Return how wide a legend is (dots)."""
    canvas: Any = figure.canvas
    return float(legend.get_window_extent(canvas.get_renderer()).width)

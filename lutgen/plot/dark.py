"""Dark: a finished figure in pale ink on black.

Greys change places, black with white; colours stay, but for those that are too deep to be seen on
black.  What lies on a colour scale is marked as `ON_COLOURS` and keeps its ink.
"""

from typing import Any

import numpy as np
from matplotlib import patheffects
from matplotlib.artist import Artist
from matplotlib.collections import Collection
from matplotlib.colors import ListedColormap, to_hex, to_rgba, to_rgba_array
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Text

from lutgen.plot.palette import BLUE, ON_COLOURS, RED

# Black paper is a little grey, which is easier on the eyes.
PAPER, INK = 0.07, 0.95
# Deep colours, and those that stand for them.
PALER = {BLUE.lower(): "#4da3e0", RED.lower(): "#ff6b7a"}
SHADE = "#121212"
# Channels that differ by no more make a grey.
GREY = 0.06


def darken(figure: Figure) -> None:
    """Turn a figure's greys round, in place."""
    for artist in figure.findobj():
        if artist.get_gid() != ON_COLOURS:
            _turn(artist)
    for axes in figure.axes:
        if axes.name != "3d":
            continue
        box: Any = axes
        for axis in (box.xaxis, box.yaxis, box.zaxis):
            axis.set_pane_color((0.13, 0.13, 0.13, 1.0))
            axis._axinfo["grid"]["color"] = "#4d4d4d"
            axis.line.set_color("white")


def _swapped(colour: Any) -> tuple[float, float, float, float]:
    """Return what stands for a colour on black."""
    red, green, blue, alpha = to_rgba(PALER.get(to_hex(colour), colour))
    if max(red, green, blue) - min(red, green, blue) <= GREY:
        red = green = blue = INK - (INK - PAPER) * (red + green + blue) / 3.0
    return red, green, blue, alpha


def _turn(artist: Artist) -> None:
    """Change the colours of one artist."""
    names: tuple[str, ...] = ("color",)
    if isinstance(artist, Text):
        if artist.get_path_effects():
            artist.set_path_effects([patheffects.withStroke(linewidth=1.8, foreground=SHADE)])
    elif isinstance(artist, Line2D):
        names = ("color", "markerfacecolor", "markeredgecolor")
    elif isinstance(artist, Patch | Collection):
        names = ("facecolor", "edgecolor", "hatchcolor")
        if isinstance(artist, ContourSet):
            if artist.colors is None:
                return  # a colour scale
            # It colours itself from a list again whenever it is drawn.
            given: Any = artist.cmap
            artist.set_cmap(ListedColormap([_swapped(colour) for colour in given.colors]))
            names = ("hatchcolor",)
    else:
        return
    # All are read before one is changed: those of markers may follow that of the line.
    seen = {name: getattr(artist, f"get_{name}")() for name in names}
    for name, colours in seen.items():
        if isinstance(artist, Collection):
            if np.size(colours):
                artist.set(**{name: [_swapped(colour) for colour in to_rgba_array(colours)]})
        elif not (isinstance(colours, str) and colours == "none"):
            artist.set(**{name: _swapped(colours)})

"""Key: the scale of colours of a channel, and at most four samples, at the right of a figure."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import FuncFormatter, MaxNLocator

from lutgen.plot.labels import channel_label, folded, given
from lutgen.plot.style import ANGLES, BLACK, FACTOR, TOP, colours, place
from lutgen.plot.view import View
from lutgen.quantities import QUANTITIES
from lutgen.vector import Floats

STAR: dict[str, Any] = {
    **{"linestyle": "none", "marker": "*", "markersize": 20, "markerfacecolor": "white"},
    **{"markeredgecolor": BLACK, "markeredgewidth": 1.2, "zorder": 8, "clip_on": False},
}


class Scale:
    """Colours of a channel in bands (`bounds`) with lines at `levels`, as shown.

    Angles have bands of 5 deg up to 60 deg in all figures.
    """

    def __init__(self, view: View, values: Floats) -> None:
        self.view, self.channel = view, view.channel
        self.unit = QUANTITIES[view.channel].shown_unit("1")
        known = values[np.isfinite(values)]
        ends = [*known, *(view.scale or ())] if known.size else [0.0, 1.0]
        low, high = float(np.min(ends)), float(np.max(ends))
        if not high - low > 1e-9 * max(abs(low), abs(high)):
            low, high = min(low, 0.0), max(high, 0.0) or 1.0
        found = MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
        angles = self.channel == "tip_angle"
        levels = np.arange(0.0, TOP + 1.0, 10.0) if angles else np.asarray(found)
        self.low, self.high = float(levels[0]), float(levels[-1])
        self.bounds = np.linspace(self.low, self.high, 2 * len(levels) - 1)
        self.levels = levels[1:-1]
        self.cmap = FACTOR if view.channel in ("sdg", "height") else ANGLES

    def share(self, values: Any) -> Any:
        """Return where values lie on the scale, from 0 to 1."""
        return np.clip((np.asarray(values) - self.low) / (self.high - self.low), 0.0, 1.0)

    def colour(self, value: float) -> Any:
        """Return the colour of a value."""
        return self.cmap(float(self.share(value)))

    def text(self, value: float) -> str:
        """Return a value with its unit, as on the scale."""
        return given(float(value), self.unit)

    def picture(self, axes: Axes, shown: Floats, extent: tuple[float, float, float, float]) -> None:
        """Colour a raster in bands; NaN is left out."""
        inside = np.clip(shown, self.low, self.high - 1e-6 * (self.high - self.low))
        look: dict[str, Any] = {"cmap": self.cmap, "norm": BoundaryNorm(self.bounds, 256)}
        look |= {"origin": "lower", "interpolation": "nearest", "aspect": axes.get_aspect()}
        axes.imshow(inside, extent=extent, zorder=1, **look)

    def bar(self, figure: Figure, left: float, top: float) -> None:
        """Draw the scale, `top` inches above the foot of the page, its name above it."""
        axes = place(figure, (left, top - 2.1, 0.2, 2.1))
        colour = ScalarMappable(BoundaryNorm(self.bounds, 256), self.cmap)
        bar: Any = figure.colorbar(colour, cax=axes, ticks=self.bounds[::2])
        bar.outline.set_visible(False)
        bar.minorticks_off()
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: self.text(value)))
        axes.tick_params(length=0, pad=4)
        label = QUANTITIES[self.channel].label
        name = label if self.unit == "deg" else channel_label(self.view.recipe, self.channel)
        axes.set_title(folded(name, 16), size=10, loc="left", pad=8, linespacing=1.2)


def add_key(figure: Figure, entries: Sequence[tuple[str, str]], left: float, top: float) -> None:
    """Draw samples (kind, words) below each other; `kind` is "jump" or "hatch"."""
    axes = place(figure, (left, top - 1.4, 1.4, 1.4))
    axes.set(xlim=(0, 1.4), ylim=(0, 1.4))
    axes.set_axis_off()
    y = 1.3
    for kind, words in entries:
        y -= 0.08 * words.count("\n")
        if kind == "hatch":
            box = Rectangle((0, y - 0.08), 0.26, 0.16, facecolor=colours().wash, hatch="////")
            axes.add_patch(box).set(edgecolor=colours().soft, linewidth=0.5)
        else:
            axes.plot([0, 0.26], [y, y], color=colours().ink, linewidth=2.2)
        axes.text(0.36, y, words, size=10, va="center", linespacing=1.2)
        y -= 0.27 + 0.09 * words.count("\n")

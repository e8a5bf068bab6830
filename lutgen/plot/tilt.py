"""Tilt charts: how far a posture may be tilted in each heading, `limits` and `polar`."""

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from scipy.ndimage import grey_closing
from scipy.ndimage import label as connected

from lutgen.analysis import (
    Posture,
    PostureLimits,
    SweepLimits,
    hold_limits,
    posture_limits,
    roll_limits,
    slide_limits,
    tilt_limits,
)
from lutgen.plot import disc
from lutgen.plot.labels import HEADINGS, angle, named
from lutgen.plot.painter import arrow
from lutgen.plot.style import bare, colours, halo, in_house_style, page, place
from lutgen.plot.view import View
from lutgen.recipe import Recipe
from lutgen.vector import Floats

# Headings (deg) and tilts (deg) of a limit.
Line = tuple[Floats, Floats]

# Deg: headings of the outline.  A gap in it narrower than CRACK is drawn as a tick.
FINE, CRACK, DEEP = 0.05, 2.0, 1.0
AROUND = np.arange(0.0, 360.0, FINE)
# Every fifth degree, so that sideways is among them.
COARSE = np.linspace(0.0, 360.0, 73)
BOX = (0.75, 0.2, 6.5, 6.4)
FROM = {"plane": "where it stands on level ground", "body": "a level body"}
# Where lines are named: headings away from the worst one.
BESIDE = (180.0, 0.0, 125.0, 235.0, 55.0, 305.0)


def draw_polar(view: View) -> Figure:
    """Return the figure of tilts from a level body, with the tilts at which wheels roll away."""
    posture = Posture(view.recipe, view.params)
    found = posture_limits(posture, "body")
    figure, axes = view.page(6.6, BOX, *_words(view.recipe, found))
    _Chart(axes, view.recipe, found).draw(_sliding(view.recipe, found) | _rolling(posture))
    return figure


@in_house_style
def draw_limits(
    recipe: Recipe, posture: PostureLimits, swept: SweepLimits | None = None, *, worst: bool = True
) -> Figure:
    """Draw the largest tilt of the body before it tips over in each heading.

    One posture has its outline, its worst heading, and the tilts from which it slides.  All
    postures, `swept`, have the best of them in each heading, and with `worst` the worst.
    """
    figure = page(6.6, *_words(recipe, posture))
    lines = _sliding(recipe, posture)
    if swept is not None:
        lines["best posture"] = (np.degrees(swept.headings), np.degrees(swept.most))
        if worst:
            lines["worst posture"] = (np.degrees(swept.headings), np.degrees(swept.least))
    _Chart(place(figure, BOX), recipe, posture).draw(lines)
    return figure


def _words(recipe: Recipe, found: PostureLimits) -> tuple[str, str]:
    """Return the answer, and what is shown."""
    least = math.degrees(found.worst.tilt)
    sentence = f"Leans at least {angle(least)} in any direction before it tips over"
    sentence = "It never tips over" if least > 179.99 else sentence
    sentence = sentence if found.stands else "It tips over untilted"
    start = f"tilted from {FROM[found.convention]}; nose at the top."
    return sentence, f"{named(recipe, found.params)}\nThe further out, the more it is {start}"


def _sliding(recipe: Recipe, found: PostureLimits) -> dict[str, Line]:
    """Return the tilts at which friction gives way."""
    if recipe.friction is None:
        return {}
    posture, around = Posture(recipe, found.params), AROUND[::10]
    slides = np.degrees(slide_limits(posture, np.radians(around), found.convention))
    known = slides[np.isfinite(slides)]
    return {f"slides at {angle(known.min())}": (around, slides)} if known.size else {}


def _rolling(posture: Posture) -> dict[str, Line]:
    """Return the tilts at which contacts that roll give way, if the robot has any.

    A second line is where it ceases to hold under every load, if that is earlier.  Under forces
    nothing is known of rolling.
    """
    lines: dict[str, Line] = {}
    rolling = any(contact.rolling for contact in posture.recipe.contacts)
    if not rolling or posture.recipe.has_wrench:
        return lines
    limit, sure = (np.degrees(f(posture, np.radians(COARSE))) for f in (roll_limits, hold_limits))
    if np.isfinite(limit).any():
        name = "rolls away" if np.nanmax(limit) > 0.1 else "rolls on any slope"
        lines[name] = (COARSE, limit)
    if np.isfinite(sure).any() and not np.allclose(sure, limit, atol=0.1, equal_nan=True):
        lines["may roll away"] = (COARSE, sure)
    return lines


class _Chart:
    """A disc of tilts: `exact` (deg) is the limit in each heading, `most` without its gaps."""

    def __init__(self, axes: Axes, recipe: Recipe, found: PostureLimits) -> None:
        self.axes, self.recipe, self.found = bare(axes), recipe, found
        limit = tilt_limits(recipe, found.params, np.radians(AROUND), found.convention)
        self.exact = np.degrees(limit)
        self.most = grey_closing(self.exact, int(CRACK / FINE), mode="wrap")
        self.rim = 90.0 if self.exact.max() <= 90.0 else 180.0
        self.least = math.degrees(found.worst.tilt)
        self.heading = math.degrees(found.worst.heading) % 360.0
        self.names: list[Floats] = []

    def at(self, heading: Any, tilt: Any) -> Floats:
        """Return places (2, n) of tilts (deg)."""
        return disc.at(heading, np.minimum(np.asarray(tilt) / self.rim, 1.0))

    def draw(self, lines: dict[str, Line]) -> None:
        """Draw everything; `lines` are other limits by what they are called."""
        axes, look = self.axes, colours()
        axes.add_patch(Circle((0, 0), 1.0, facecolor=look.wash, edgecolor="none", zorder=0))
        rim = Circle((0, 0), 1.0, fill=False, edgecolor=look.hatch, linewidth=0.8)
        axes.add_patch(rim).set(hatch="//", zorder=0.5)
        edge = self.at(AROUND, self.most)
        axes.add_patch(Polygon(edge.T, facecolor=look.pale, edgecolor="none", zorder=1.1))
        axes.plot(*np.append(edge, edge[:, :1], 1), color=look.blue, label="tips over", zorder=4)
        disc.ruler(axes, lambda tilt, rim: tilt / rim, self.rim)
        self._ticks()
        disc.top_view(axes, self.recipe, self.found.params, 0.21)
        spots = [h for h in BESIDE if _apart(h, self.heading) > 40.0]
        inner = [self._line(name, lines[name], h) for name, h in zip(lines, spots, strict=False)]
        self._name_worst()
        x, y = np.meshgrid(*(np.linspace(-1.0, 1.0, 300),) * 2)
        psi, radius = np.degrees(np.arctan2(-x, y)) % 360.0, np.hypot(x, y)
        limit = np.interp(psi, AROUND, self.exact / self.rim, period=360.0)
        core = np.interp(psi, AROUND, np.max([np.full(len(AROUND), 0.25), *inner], 0), period=360.0)
        clear = (radius < limit) & (radius > core) & (_apart(psi, self.heading) > 25.0)
        for spot in self.names:
            clear &= np.hypot((x - spot[0]) / 2.0, y - spot[1]) > 0.09
        disc.write_in(axes, clear, "stands", look.pale, look.blue)
        beyond = (radius < 1.0) & (radius > limit) & (radius > 0.25)
        disc.write_in(axes, beyond, "tips over", look.wash)
        for heading, name in HEADINGS.items():
            near = bool(_apart(heading, self.heading) < 8.0)
            tilt = self.least if near else float(self.exact[round(heading / FINE)])
            self._beside(heading, name, angle(tilt), near)

    def _ticks(self) -> None:
        """Draw a tick where the robot tips over earlier in a gap too narrow to be seen."""
        groups, count = connected(self.most - self.exact > DEEP)
        look: dict[str, Any] = {"color": colours().blue, "linewidth": 1.2, "zorder": 4}
        for k in range(1, count + 1):
            spot = np.flatnonzero(groups == k)
            deep = int(spot[np.argmin(self.exact[spot])])
            ends = self.at([AROUND[deep]] * 2, [self.most[deep], self.exact[deep]])
            self.axes.plot(*ends, **look)
        if count:
            self.axes.plot([-1.27, -1.21], [disc.RULER] * 2, **look)
            text = self.axes.text(-1.18, disc.RULER, "narrow gap: it\ntips over earlier", size=9.5)
            text.set(color=colours().soft, va="center", linespacing=1.2)

    def _line(self, name: str, line: Line, h: float) -> Floats:
        """Draw a limit, named at heading `h`; return where it is (in radii) on `AROUND`."""
        headings, tilts = line
        x, y = self.at(np.append(headings, headings[0]), np.append(tilts, tilts[0]))
        self.axes.plot(x, y, label=name, color=colours().ink, lw=1.3, ls=(0, (1.2, 2.2)), zorder=5)
        known = np.isfinite(tilts)
        whole = np.interp(AROUND, headings[known], tilts[known], period=360.0) / self.rim
        radius = float(np.interp(h, AROUND, whole))
        below = radius > 0.42
        spot = disc.at(h, max(radius - 0.05 if below else radius + 0.05, 0.3))
        va = "top" if (spot[1] > 0.0) == below else "bottom"
        self.names.append(spot)
        text = self.axes.text(spot[0], spot[1], name, size=10, ha="center", va=va, zorder=7)
        text.set_path_effects(halo(3.0, colours().pale))
        return np.asarray(np.where(whole < self.most / self.rim, whole, 0.0))

    def _name_worst(self) -> None:
        """Draw an arrow to the worst heading, and its angle unless a heading's name has it."""
        if not math.isfinite(self.heading) or self.least < 0.3 * self.rim:
            return
        start, stop = disc.at(self.heading, 0.235), self.at(self.heading, self.least)
        arrow(self.axes, start, stop, colours().red, 1.2)
        if min(_apart(h, self.heading) for h in HEADINGS) >= 8.0:
            x, y = disc.at(self.heading + 24.0, max(0.75 * self.least / self.rim, 0.36))
            text = self.axes.text(x, y, f"worst\n{angle(self.least)}", color=colours().red)
            text.set(ha="center", va="center", zorder=7, path_effects=halo(3.0, colours().pale))
            text.set(weight="bold", size=12)

    def _beside(self, heading: float, name: str, number: str, worst: bool) -> None:
        """Write a heading and its limit around the disc, the worst one in red."""
        x, y = disc.at(heading, 1.05)
        colour = colours().red if worst else colours().ink
        bold: dict[str, Any] = {"size": 17 if worst else 13, "weight": "bold", "color": colour}
        if abs(x) < 0.3:
            va = "bottom" if y > 0 else "top"
            self.axes.text(x - 0.02, y, name, ha="right", va=va, color=colour)
            self.axes.text(x + 0.02, y, number, ha="left", va=va, **bold)
            return
        ha, words = "left" if x > 0 else "right", name.replace(" side", "\nside")
        self.axes.text(x, y + 0.015, words, ha=ha, va="bottom", color=colour, linespacing=1.2)
        self.axes.text(x, y - 0.005, number, ha=ha, va="top", **bold)


def _apart(one: Any, other: float) -> Any:
    """Return the angle between headings, deg; 180 if there is no other."""
    return np.nan_to_num(np.abs((one - other + 180.0) % 360.0 - 180.0), nan=180.0)

"""Disc: tilts of the body on the paper, nose down at the top and left side down at the left."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.patches import Circle
from numpy.typing import ArrayLike
from scipy.ndimage import distance_transform_edt, minimum_filter

from lutgen.analysis import tilted
from lutgen.arrays import Bools, Floats
from lutgen.plot.key import Scale
from lutgen.plot.labels import HEADINGS, given
from lutgen.plot.painter import Camera, paint
from lutgen.plot.solids import solids_of
from lutgen.plot.style import bare, colours, halo, ink_on
from lutgen.recipe import Recipe

# The ray (deg of heading) along which lines are labelled: right side down, a little to the nose.
LABELLED = 278.0
RULER = -1.24
ABOVE = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def spread(tilt: ArrayLike, rim: float) -> Any:
    """Return where a tilt (deg) lies between the middle (0) and the rim (1): in equal areas."""
    return np.sin(np.radians(tilt) / 2.0) / math.sin(math.radians(rim) / 2.0)


def at(heading: ArrayLike, radius: Any) -> Floats:
    """Return the places (2, n) of headings (deg)."""
    psi = np.radians(heading)
    return np.array([-radius * np.sin(psi), radius * np.cos(psi)])


def raster(pixels: int, rim: float) -> tuple[Floats, Bools, Floats]:
    """Return a raster of the tilts up to the `rim` (deg): its axis, what is inside, directions."""
    line = np.linspace(-1.0, 1.0, pixels)
    x, y = np.meshgrid(line, line)
    inside = np.hypot(x, y) <= 1.0
    tilt = 2.0 * np.arcsin(np.hypot(x, y)[inside] * math.sin(math.radians(rim) / 2.0))
    return line, inside, tilted(tilt, np.arctan2(-x[inside], y[inside]))


def filled(inside: Bools, values: ArrayLike) -> Floats:
    """Return values of what is inside on the whole raster, NaN outside."""
    result = np.full(inside.shape, np.nan)
    result[inside] = values
    return result


def name_headings(axes: Axes) -> None:
    """Write the names of the four headings around a disc."""
    for heading, name in HEADINGS.items():
        x, y = at(heading, 1.05)
        side = abs(x) > 0.5
        ha = ("left" if x > 0 else "right") if side else "center"
        va = "center" if side else "bottom" if y > 0 else "top"
        words = name.replace(" side", "\nside") if side else name
        axes.text(x, y, words, size=10.5, ha=ha, va=va, linespacing=1.2)


def ruler(axes: Axes, place: Callable[[float, float], Any], rim: float) -> None:
    """Draw the scale of tilt below a disc, from its middle to its rim, and rings in it."""
    look: dict[str, Any] = {"color": colours().soft, "linewidth": 0.8}
    words: dict[str, Any] = {"color": colours().soft, "size": 9.5}
    axes.plot([0.0, 1.0], [RULER] * 2, **look)
    for tilt in np.unique([*np.arange(0.0, rim, 30.0 if rim <= 90.0 else 60.0), rim]):
        x = float(place(tilt, rim))
        axes.plot([x, x], [RULER, RULER + 0.025], **look)
        axes.text(x, RULER - 0.02, given(round(tilt), "deg"), ha="center", va="top", **words)
        if 0.0 < tilt < rim:
            ring = Circle((0, 0), x, fill=False, edgecolor=colours().soft, alpha=0.4)
            axes.add_patch(ring).set(linewidth=0.7, zorder=2.5)
    axes.text(-0.04, RULER, "tilt of the body", ha="right", va="center", **words)
    axes.set(xlim=(-1.42, 1.42), ylim=(-1.36, 1.2))


def top_view(axes: Axes, recipe: Recipe, params: Floats, radius: float) -> None:
    """Draw the robot from above, its nose up, in a circle around the middle."""
    solids, camera = solids_of(recipe, params), Camera(-90.0, 89.9, ABOVE)
    flat = np.concatenate([camera.flat(solid.points) for solid in solids])
    camera.basis *= radius / np.linalg.norm(flat, axis=1).max()
    paint(axes, solids, camera, 0.45, 5.0)


def write_in(axes: Axes, region: Bools, words: str, back: str, colour: str = "") -> None:
    """Write words where a region of a raster is clearest, if it has room for them."""
    n = len(region)
    size = (int(0.035 * n), int((0.010 * len(words) + 0.08) * n))
    box = minimum_filter(distance_transform_edt(region), size=size, mode="constant")
    if box.max() < 1.0:
        return
    row, column = np.unravel_index(int(np.argmax(box)), box.shape)
    x, y = 2.0 * column / (n - 1) - 1.0, 2.0 * row / (n - 1) - 1.0
    text = axes.text(x, y, words, size=12, weight="bold", color=colour or colours().ink)
    text.set(ha="center", va="center", zorder=7, path_effects=halo(4.0, back))


def colour_disc(axes: Axes, line: Floats, values: Floats, tips: Floats, scale: Scale) -> None:
    """Colour a disc by values (as shown), hatch what `tips` (1 or 0); NaN is outside."""
    look = colours()
    bare(axes).add_patch(Circle((0, 0), 1.0, facecolor=look.wash, edgecolor="none", zorder=0))
    shown = np.where(tips == 0.0, values, np.nan)
    scale.picture(axes, shown, (-1.0, 1.0, -1.0, 1.0))
    known = np.nan_to_num(values, nan=-999.0) if scale.channel == "tip_angle" else shown
    if np.isfinite(known).any():
        inks = [ink_on(scale.colour(level)) for level in scale.levels]
        axes.contour(line, line, known, levels=scale.levels, colors=inks, linewidths=0.8, zorder=2)
    hatch_where(axes, line, line, tips)
    axes.add_patch(Circle((0, 0), 1.0, fill=False, edgecolor=look.soft, linewidth=0.8, zorder=4))


def hatch_where(axes: Axes, x: Floats, y: Floats, tips: ArrayLike) -> None:
    """Hatch what tips over (1, not 0), with a line around it."""
    region = np.asarray(tips, np.float64)
    if not (region == 1.0).any():
        return
    with rc_context({"hatch.color": colours().hatch}):
        axes.contourf(x, y, region, levels=[0.5, 1.5], colors="none", hatches=["//"], zorder=1.5)
    if (region == 0.0).any():
        look: dict[str, Any] = {"colors": [colours().ink], "linewidths": 1.4, "zorder": 3}
        axes.contour(x, y, region, levels=[0.5], **look)


def name_lines(axes: Axes, values: Floats, scale: Scale) -> None:
    """Write values on the lines of a disc, along one ray, if they are far enough apart."""
    radius = np.linspace(0.12, 0.97, 400)
    x, y = at(LABELLED, radius)
    column, row = (np.rint((part + 1.0) / 2.0 * (len(values) - 1)).astype(int) for part in (x, y))
    along, last = values[row, column], -1.0
    for level in scale.levels:
        cross = np.flatnonzero(np.diff(np.sign(along - level)) != 0)
        if len(cross) and abs(radius[cross[0]] - last) > 0.09:
            last, back = radius[cross[0]], scale.colour(level)
            text = axes.text(x[cross[0]], y[cross[0]], scale.text(level), size=9.5)
            text.set(ha="center", va="center", zorder=6, color=ink_on(back))
            text.set_path_effects(halo(3.0, back))

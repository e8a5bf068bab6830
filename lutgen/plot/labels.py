"""Words of the figures: names with units, numbers, and the line that says what is shown.

Owns every text that depends on the robot; angles become degrees here.
"""

import math
from typing import Any

import numpy as np
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike

from lutgen.analysis import FOUR, rounded_down
from lutgen.parts import Parameter
from lutgen.plot.view import View
from lutgen.plot.words import folded, printed
from lutgen.quantities import QUANTITIES
from lutgen.recipe import Recipe

GREEK = (
    *("alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa"),
    *("lambda", "mu", "nu", "xi", "pi", "rho", "sigma", "tau", "phi", "chi", "psi", "omega"),
)
# Headings in deg, from 0 up.
HEADINGS = {round(math.degrees(heading)) % 360: name for name, heading in FOUR.items()}
# Characters on a line of a figure one column wide, along a short axis, and of a note.
COLUMN, SLANTED, NOTE = 52, 22, 34
DEGREE = "\N{DEGREE SIGN}"
MINUS = "\N{MINUS SIGN}"
DIMENSIONLESS = "\N{EN DASH}"


def parameter_text(parameter: Parameter) -> str:
    """Return a parameter's name for print; a Greek letter's name becomes the letter."""
    if parameter.name in GREEK:
        return rf"$\{parameter.name}$"
    return parameter.name.replace("_", " ")


def axis_label(parameter: Parameter, longest: int = SLANTED) -> str:
    """Return the label of a parameter's axis, with its unit, in lines of so many characters."""
    return folded(unit_label(parameter_text(parameter), parameter.display_unit), longest)


def name_axes(axes: Any, view: View, *shown: ArrayLike) -> None:
    """Label and limit the axes of the parameters that a figure varies, by their values as shown."""
    for place, (letter, values) in enumerate(zip("xy", shown, strict=False)):
        parameter = view.parameter(place)
        low, high = np.asarray(values)[[0, -1]]
        # The side of a picture is shorter than its foot, and that of a box in perspective, too.
        short = letter == "y" or view.kind == "surface"
        words = axis_label(parameter, SLANTED if short else COLUMN - 16)
        axes.set(**{f"{letter}label": words, f"{letter}lim": (low, high)})
        # Degrees that divide a turn, where there are many.
        turns = parameter.display_unit == "deg" and high - low > 100.0
        box = view.kind == "surface"
        if turns or box:
            steps = [1, 1.5, 3, 4.5, 6, 9, 10] if turns else [1, 2, 2.5, 5, 10]
            # The last labels of two axes would meet in a corner of the box.
            locator = MaxNLocator(7 if turns else 5, steps=steps, prune="both" if box else None)
            getattr(axes, f"{letter}axis").set_major_locator(locator)


def channel_label(recipe: Recipe, channel: str) -> str:
    """Return the label of a channel's axis, with its unit."""
    return unit_label(QUANTITIES[channel].label, QUANTITIES[channel].shown_unit(recipe.length_unit))


def unit_label(name: str, unit: str) -> str:
    """Return the label of an axis, with its unit."""
    return f"{name} ({DIMENSIONLESS if unit == '1' else unit})"


def heading_text(heading: float) -> str:
    """Return a heading in deg in words: one of the four, or its angle from the nose."""
    turn = round(heading, 1) % 360.0
    if turn in HEADINGS:
        return HEADINGS[int(turn)]
    side, away = ("left", turn) if turn < 180.0 else ("right", 360.0 - turn)
    return f"{angle_text(away)} {side} of the nose"


def slide_label(recipe: Recipe) -> str:
    """Return a legend's words for the limit of friction."""
    return rf"slides ($\mu$ = {number(recipe.friction or 0.0)})"


def optimum_text(
    view: View, value: float, among: ArrayLike, place: ArrayLike = (), joint: str = " at "
) -> str:
    """Return the words for the optimum: its value among others and where it is.

    All in display units; `place` has one number per axis of the figure.
    """
    one = QUANTITIES[view.channel]
    unit, end = one.shown_unit(view.recipe.length_unit), str(one.better)[:3]
    where = []
    for i, at in enumerate(np.atleast_1d(place)):
        parameter = view.parameter(i)
        text = measured(float(at), view.shown(i, view.ends(i)), parameter.display_unit)
        where.append(f"{parameter_text(parameter)} = {text}")
    words = f"{end} {measured(value, among, unit)}"
    return f"{words}{joint}{', '.join(where)}" if where else words


def measured(value: float, among: ArrayLike, unit: str) -> str:
    """Return a number with its unit, to about a thousandth of the range that it is among."""
    spread = float(np.nanmax(among) - np.nanmin(among))
    if not spread > 0.0:
        return with_unit(value, unit)
    decimals = max(3 - math.floor(math.log10(spread)), 0)
    return _joined(f"{value:.{decimals}f}".replace("-", MINUS), unit)


def number(value: float) -> str:
    """Return a number with three significant digits, in print typography."""
    if not math.isfinite(value):
        return "none"
    if value != 0.0 and abs(value) < 1e-3:
        mantissa, exponent = f"{value:.1e}".split("e")
        return rf"${mantissa} \times 10^{{{int(exponent)}}}$"
    text = f"{value:.3g}"
    return (f"{value:.0f}" if "e" in text else text).replace("-", MINUS)


def with_unit(value: float, unit: str) -> str:
    """Return a number with its unit."""
    return _joined(number(value), unit)


def angle_text(degrees: float) -> str:
    """Return an angle that was computed, to a tenth of a degree."""
    return _joined(f"{degrees:.1f}".replace("-", MINUS), "deg")


def limit_text(degrees: float) -> str:
    """Return a limit to a tenth of a degree, rounded down, so that what is printed holds, too."""
    return angle_text(rounded_down(degrees, 1))


def _joined(text: str, unit: str) -> str:
    if unit == "deg":
        return f"{text}{DEGREE}"
    return text if unit == "1" else f"{text} {unit}"


def attitude(tilt: float, heading: float) -> str:
    """Return in words how the body is tilted (rad)."""
    degrees = math.degrees(tilt)
    if degrees < 0.05:
        return "body level"
    return f"tilted {angle_text(degrees)}, {heading_text(math.degrees(heading))}"


def gravity_text(view: View) -> str:
    """Return where gravity points, as tilt and heading; a plane's tilt is that of the ground."""
    x, y, z = view.gravity_dir
    tilt = math.degrees(math.atan2(math.hypot(x, y), -z))
    words = f"{angle_text(tilt)}, {heading_text(math.degrees(math.atan2(y, x)))}"
    if view.convention == "plane" and view.kind != "robot":
        return "on level ground" if tilt < 0.005 else f"on ground that slopes {words}"
    if tilt < 0.005:
        return "body level"
    if tilt > 179.995:
        return "body upside down"
    return f"body tilted {words}"


def title(view: View, *, gravity: bool, more: str = "") -> str:
    """Return the title: robot, what is fixed, and `more`, on as few lines as fit a column."""
    fixed = [
        f"{parameter_text(p)} = {with_unit(float(p.shown(view.params[i])), p.display_unit)}"
        for i, p in enumerate(view.recipe.parameters)
        if i not in view.axes
    ]
    parts = [*fixed, *([gravity_text(view)] if gravity else []), *([more] if more else [])]
    lines = [view.recipe.name]
    for i, part in enumerate(parts):
        longer = f"{lines[-1]}{', ' if i else ': '}{part}"
        if printed(longer) > COLUMN:
            lines.append(part)
        else:
            lines[-1] = longer
    return "\n".join(folded(line, COLUMN) for line in lines)

"""Labels: names, numbers and angles in words, and words in lines.

Angles that were computed are whole degrees, rounded down, so that what is printed holds.
"""

import math
import re
import textwrap
import unicodedata
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.ticker import FuncFormatter, MaxNLocator
from numpy.typing import ArrayLike

from lutgen.analysis import FOUR, rounded_down
from lutgen.parts import Parameter
from lutgen.quantities import QUANTITIES
from lutgen.recipe import Recipe

GREEK = (
    *("alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa"),
    *("mu", "nu", "xi", "pi", "rho", "sigma", "tau", "phi", "chi", "psi", "omega"),
)
# Headings in deg, from 0 up.
HEADINGS = {round(math.degrees(heading)) % 360: name for name, heading in FOUR.items()}
DEGREE, MINUS, DIMENSIONLESS = "\N{DEGREE SIGN}", "\N{MINUS SIGN}", "\N{EN DASH}"
COUNTS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
NAMES = {"disc": "wheels", "point": "feet", "sphere": "balls"}


def folded(text: str, longest: int) -> str:
    r"""Return a text in lines of at most so many characters; longer words are cut.

    Examples
    --------
    >>> folded("front left wheel", 11)
    'front left\nwheel'
    """
    lines = (textwrap.wrap(line, longest, break_on_hyphens=False) for line in text.split("\n"))
    return "\n".join("\n".join(line) for line in lines)


def plain(name: str) -> str:
    """Return a name for print: one line, without marks of formulas and of joined words."""
    letters = (" " if unicodedata.category(c)[0] == "C" or c == "_" else c for c in name)
    return " ".join("".join(letters).split()).replace("$", r"\$")


def parameter_text(parameter: Parameter) -> str:
    """Return a parameter's name for print; the name of a Greek letter becomes the letter."""
    if parameter.name in GREEK:
        return unicodedata.lookup(f"GREEK SMALL LETTER {parameter.name.upper()}")
    return plain(parameter.name)


def name_axis(axis: Any, parameter: Parameter, ends: Sequence[float], longest: int) -> None:
    """Name an axis of a parameter, with what its values mean, and choose its numbers."""
    axis.set_label_text(axis_label(parameter, longest))
    turns = parameter.display_unit == "deg" and ends[1] - ends[0] > 100.0
    steps = [1, 1.5, 3, 4.5, 6, 9, 10] if turns else [1, 2, 2.5, 5, 10]
    axis.set_major_locator(MaxNLocator(5 if turns else 6, steps=steps))
    if parameter.display_unit == "deg":
        axis.set_major_formatter(FuncFormatter(lambda value, _: given(value, "deg")))


def axis_label(parameter: Parameter, longest: int) -> str:
    """Return the label of a parameter's axis, in lines of so many letters."""
    unit, name, words = parameter.display_unit, parameter_text(parameter), plain(parameter.meaning)
    if unit == "deg":
        words = re.sub(r"(?<![\w.])-?\d+(\.\d+)?(?=:)", rf"\g<0>{DEGREE}", words)
        return folded(f"{name} ({words.replace('-', MINUS)})" if words else name, longest)
    return folded(f"{unit_label(name, unit)}{f': {words}' if words else ''}", longest)


def channel_label(recipe: Recipe, channel: str) -> str:
    """Return the label of a channel's axis, with its unit."""
    return unit_label(QUANTITIES[channel].label, QUANTITIES[channel].shown_unit(recipe.length_unit))


def unit_label(name: str, unit: str) -> str:
    """Return the label of an axis, with its unit."""
    return f"{name} ({DIMENSIONLESS if unit == '1' else unit})"


def number(value: float) -> str:
    """Return a number with three significant digits, in print typography."""
    text = f"{value:.3g}"
    if "e-" in text:
        mantissa, exponent = f"{value:.1e}".split("e")
        # Without spaces, so that lines do not break in it.
        return rf"${mantissa}\times10^{{{int(exponent)}}}$"
    return (f"{value:.0f}" if "e" in text else text).replace("-", MINUS)


def given(value: float, unit: str) -> str:
    """Return a number with its unit."""
    text = number(round(value, 9) + 0.0 if unit == "deg" else value)
    return f"{text}{DEGREE}" if unit == "deg" else text if unit == "1" else f"{text} {unit}"


def angle(degrees: float) -> str:
    """Return an angle that was computed: whole degrees, rounded down."""
    return given(rounded_down(degrees, 0), "deg")


def quantity_text(recipe: Recipe, channel: str, value: float) -> str:
    """Return a value of a channel (display unit), with its unit."""
    unit = QUANTITIES[channel].shown_unit(recipe.length_unit)
    return angle(value) if unit == "deg" else given(value, unit)


def found_text(parameter: Parameter, value: float, ends: Sequence[float]) -> str:
    """Return a parameter and where along it (as shown) something was: to 1 % of its range."""
    decimals = max(1 - math.floor(math.log10(max(abs(ends[1] - ends[0]), 1e-300))), 0)
    near = round(value, decimals) + 0.0
    unit = parameter.display_unit
    return f"{parameter_text(parameter)} {given(near, unit)}"


def named(recipe: Recipe, params: ArrayLike, without: Sequence[int] = (), more: str = "") -> str:
    """Return a sentence: the robot, its posture (k,) (rad or length) but some columns, and more."""
    parts = [plain(recipe.title or recipe.name) or "robot"]
    for i, (p, value) in enumerate(zip(recipe.parameters, np.asarray(params), strict=True)):
        if i not in without:
            parts.append(f"{parameter_text(p)} {given(float(p.shown(value)), p.display_unit)}")
    return f"{', '.join([*parts, more] if more else parts)}."


def gravity_text(gravity_dir: ArrayLike, convention: str) -> str:
    """Return where gravity points: on which ground the robot stands, or how its body is tilted."""
    x, y, z = (float(part) for part in np.asarray(gravity_dir))
    tilt, turn = math.degrees(math.atan2(math.hypot(x, y), -z)), math.degrees(math.atan2(y, x))
    if tilt < 0.05:
        return "on level ground" if convention == "plane" else "body level"
    if tilt > 179.95:
        return "upside down"
    turn = round(turn) % 360
    side, away = ("left", turn) if turn < 180 else ("right", 360 - turn)
    where = HEADINGS.get(turn, f"{away}{DEGREE} to the {side} of its nose down")
    slope = given(tilt, "deg")
    return f"on a slope of {slope}, {where}" if convention == "plane" else f"{where} by {slope}"


def counted(kinds: Sequence[str]) -> str:
    """Return how many contacts there are of which kinds: "three wheels"."""
    found = {NAMES[kind] for kind in kinds}
    count = COUNTS[len(kinds)] if len(kinds) < len(COUNTS) else str(len(kinds))
    return f"{count} {found.pop() if len(found) == 1 else 'contacts'}"

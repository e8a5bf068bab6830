"""Write a weighed mass and centre of mass into the text of a recipe."""

import re

from lutgen.analysis.weighing import Weighed
from lutgen.errors import RecipeError, reject
from lutgen.recipe import Recipe, parse_recipe
from lutgen.recipe.load import toml

# Digits that are written: a part in 1e9 is finer than any scale.
DIGITS = 9
# The com is within so many standard deviations in 19 of 20 cases and more.
DEVIATIONS = 2.0
_HEAD = re.compile(r"^\s*\[\s*robot\s*\]\s*(#.*)?$")
_TABLE = re.compile(r"^\s*\[")


def correction(recipe: Recipe, found: Weighed) -> dict[str, float | list[float]]:
    """Return the keys of `[robot]` that make the recipe the robot that was weighed.

    `mass` is left out where the recipe has no masses, or the readings do not tell it, and
    `com_uncertainty` where they leave a part of the com open.
    """
    shift = [float(f"{x:.{DIGITS}g}") for x in found.com_shift + recipe.com_offset]
    keys: dict[str, float | list[float]] = {}
    if found.mass_std < float("inf") and any(link.mass for link in recipe.links):
        keys["mass"] = float(f"{found.mass:.{DIGITS}g}")
    keys["com_offset"] = shift
    if found.spread < float("inf"):
        keys["com_uncertainty"] = float(f"{DEVIATIONS * found.spread:.3g}")
    return keys


def correction_lines(keys: dict[str, float | list[float]]) -> list[str]:
    """Return the keys as lines of TOML."""
    return [f"{key} = {toml(value)}" for key, value in keys.items()]


def corrected(recipe: Recipe, found: Weighed) -> str:
    """Return the recipe's text with the correction below its `[robot]`; all else stays.

    A text where the keys cannot be replaced is refused with the lines to write by hand.
    """
    keys = correction(recipe, found)
    lines, result, inside, written = recipe.text.splitlines(), [], False, False
    for line in lines:
        if _HEAD.match(line) and not written:
            inside = written = True
            result += [line, *correction_lines(keys)]
            continue
        inside = inside and not _TABLE.match(line)
        if inside and re.match(rf"\s*({'|'.join(keys)})\s*=", line):
            continue
        result.append(line)
    text = "\n".join([*result, ""])
    try:
        made = parse_recipe(text, recipe.source, inert=True, urdf=recipe.urdf)
        good = list(made.com_offset) == keys["com_offset"]
    except RecipeError:
        good = False
    if not good:
        what, got = "the keys of [robot] are not where they can be replaced", "no good recipe"
        reject(recipe.source, what, got, f"write {'; '.join(correction_lines(keys))} there by hand")
    return text

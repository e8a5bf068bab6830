"""What commands print: a report as JSON or as lines, numbers for either, columns.

Owns how a number that is none is said: null in JSON, a dash in text.
"""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import click

from lutgen.quantities import QUANTITIES

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from lutgen.analysis import Posture
    from lutgen.recipe import Recipe

# Exit code of a question whose answer is no.
NO = 1
# Exit code of a verdict that a robot does not stand, or that nobody can tell; of every command that
# has one (docs/guide/commands.md).
TIPS = 3


def show(
    report: Mapping[str, Any],
    lines: Iterable[str],
    as_json: bool,
    answer: bool = True,
    no: int = NO,
) -> None:
    """Print a report: as JSON, or the lines that say the same; exit with `no` where `answer` is."""
    for line in [json.dumps(report, indent=2, allow_nan=False)] if as_json else lines:
        click.echo(line)
    if not answer:
        click.get_current_context().exit(no)


def number(value: float) -> float | None:
    """Return a number for JSON, which knows neither NaN nor infinity."""
    return float(value) if math.isfinite(value) else None


def degrees(value: float | None) -> float | None:
    """Return an angle (rad) in deg for JSON."""
    return None if value is None else number(math.degrees(value))


def channel_entries(values: Mapping[str, float]) -> dict[str, Any]:
    """Return channels or metrics under their names in a report; tip-over angles in deg.

    A channel of words comes as a word.
    """
    entries: dict[str, Any] = {}
    for name, value in values.items():
        one = QUANTITIES.get(name)
        if one is None:
            # The force-angle measure is no channel.
            entries[f"{name}_rad"] = number(value)
        elif one.words:
            entries[name] = one.word(value)
        else:
            entries[one.json] = int(value) if one.unit == "1" else number(one.shown(value))
    return entries


def by_unit(recipe: "Recipe", params: "NDArray[np.float64]", ending: str = "") -> dict[str, Any]:
    """Return parameters (..., k) in their display units, named with them: numbers or lists."""
    entries = {}
    for i, p in enumerate(recipe.parameters):
        unit = "" if p.display_unit == "1" else f"_{p.display_unit}"
        entries[f"{p.name}{ending}{unit}"] = p.shown(params[..., i]).tolist()
    return entries


def posture_entries(posture: "Posture", source: str) -> dict[str, Any]:
    """Return what `--json` says of a posture that `options.posture_source` filled; else nothing."""
    if not source:
        return {}
    return {"posture": by_unit(posture.recipe, posture.params), "posture_from": source}


def posture_text(posture: dict[str, float]) -> str:
    """Return a posture as text."""
    parts = []
    for key, value in posture.items():
        name, _, unit = key.rpartition("_")
        known = unit in ("deg", "rad", "m", "cm", "mm") and name
        parts.append(f"{name} = {value:.6g} {unit}" if known else f"{key} = {value:.6g}")
    return ", ".join(parts) or "-"


def unit_text(unit: str) -> str:
    """Return what follows a length; those of unit 1 are ratios."""
    return "" if unit == "1" else f" {unit}"


def cell(value: float | None, form: str = ".6g", unit: str = "") -> str:
    """Return a number as text, a dash where there is none."""
    return "-" if value is None else f"{value:{form}}{unit}"


def even(value: float | None, rounding: float = 1e-12) -> float | None:
    """Return a number for people: what rounding leaves of zero is zero, and zero has no sign."""
    return 0.0 if value is not None and abs(value) < rounding else value


def aligned(rows: Sequence[Sequence[str]], forms: Sequence[str] = ()) -> list[str]:
    """Return rows as lines with a column each under `forms`, by default as wide as they need."""
    if not forms:
        forms = [f"<{max(map(len, column))}" for column in zip(*rows, strict=True)]
    # A row may end early.
    return [
        "  ".join(f"{text:{form}}" for text, form in zip(row, forms, strict=False)).rstrip()
        for row in rows
    ]

"""Output of commands: a report as JSON or in words, numbers for either, columns."""

import itertools
import json
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import click

from lutgen.cli.lazy import Floats, figures, robots
from lutgen.cli.options import Assignments, FigureOptions, posture_source
from lutgen.errors import one_line
from lutgen.files import check_target, csv_text, plain, write_text
from lutgen.parts import to_display
from lutgen.quantities import QUANTITIES

# Exit code of a question whose answer is no.
NO = 1
# Exit code of a verdict that a robot tips over, or that it is unknown; of every command that has
# one (docs/guide/commands.md).
TIPS = 3
# The words of a verdict, by the status of a report.
VERDICTS = {"stands": "stands", "rocks": "rocks", "tips": "tips over"}


def show(
    report: Mapping[str, Any],
    lines: Callable[[dict[str, Any]], Iterable[Sequence[str]]],
    code: int = 0,
) -> None:
    """Print a report as JSON, or the lines that say the same; exit with the code of its answer.

    Among the lines may be rows of cells; those that follow each other are a table.
    """
    values, context = plain(report), click.get_current_context()
    if context.params["as_json"]:
        click.echo(json.dumps(values, indent=2, allow_nan=False))
    else:
        for of_text, group in itertools.groupby(lines(values), lambda one: isinstance(one, str)):
            for line in map(str, group) if of_text else aligned(group):
                # A name may hold characters that a terminal obeys, or another line.
                click.echo(one_line(line))
    if code:
        context.exit(code)


def degrees(value: Any) -> Any:
    """Return angles (rad) in deg."""
    return None if value is None else to_display(value, "deg")


def entries(value: Any, names: str) -> dict[str, Any]:
    """Return attributes of a value under their names, or under KEY for ``KEY=NAME``.

    A key that ends in ``_deg`` or ``_deg_s`` is for an angle (rad) whose name lacks that ending.
    """
    found = {}
    for name in names.split():
        key, _, attribute = name.partition("=")
        stem = re.sub("_deg(_s)?$", "", key)
        one = getattr(value, attribute or stem)
        found[key] = one if stem == key else degrees(one)
    return found


def channel_entries(values: Mapping[str, float]) -> dict[str, Any]:
    """Return channels or metrics under their names in a report; tip-over angles in deg.

    A channel of words comes as a word.
    """
    entries: dict[str, Any] = {}
    for name, value in values.items():
        one = QUANTITIES.get(name)
        if one is None:
            # The force-angle measure is no channel.
            entries[f"{name}_rad"] = value
        elif one.words:
            entries[name] = one.word(value)
        else:
            entries[one.json] = one.shown(value) if one.better else int(value)
    return entries


def by_unit(recipe: "robots.Recipe", params: "Floats", ending: str = "") -> dict[str, Any]:
    """Return parameters (..., k) in their display units, named with them: numbers or lists."""
    entries = {}
    for i, p in enumerate(recipe.parameters):
        unit = "" if p.display_unit == "1" else f"_{p.display_unit}"
        entries[f"{p.name}{ending}{unit}"] = p.shown(params[..., i]).tolist()
    return entries


def posture_entries(
    recipe: "robots.Recipe", params: "Floats", given: Assignments
) -> dict[str, Any]:
    """Return what a report says of a posture that was not given whole; else nothing."""
    source = posture_source(recipe, given)
    return {"posture": by_unit(recipe, params), "posture_from": source} if source else {}


def posture_text(posture: Mapping[str, float]) -> str:
    """Return a posture as text."""
    parts = []
    for key, value in posture.items():
        name, _, unit = key.rpartition("_")
        known = unit in ("deg", "rad", "m", "cm", "mm") and name
        parts.append(f"{name} = {value:.6g} {unit}" if known else f"{key} = {value:.6g}")
    return ", ".join(parts) or "-"


def posture_lines(report: Mapping[str, Any]) -> list[str]:
    """Return the line of `posture_entries`, or none."""
    if "posture_from" not in report:
        return []
    return [f"{posture_text(report['posture'])} ({report['posture_from']})"]


def unit_text(unit: str) -> str:
    """Return what follows a length; those of unit 1 are ratios."""
    return "" if unit == "1" else f" {unit}"


def cell(value: float | None, form: str = ".6g", unit: str = "") -> str:
    """Return a number as text, or a dash.

    A remainder of rounding is zero, and zero has no sign.
    """
    if value is None:
        return "-"
    return f"{0.0 if abs(value) < 1e-12 else value:{form}}{unit}"


def aligned(rows: Iterable[Sequence[str]], numbers: Iterable[int] = ()) -> list[str]:
    """Return rows as lines of columns, each as wide as it needs; those of numbers to the right."""
    rows = [*rows]
    right, count = set(numbers), max(map(len, rows), default=0)
    # A row may end early.
    width = [max(len(row[i]) for row in rows if i < len(row)) for i in range(count)]
    return [
        "  ".join(
            f"{text:{'>' if i in right else '<'}{width[i]}}" for i, text in enumerate(row)
        ).rstrip()
        for row in rows
    ]


def file_size(count: float) -> str:
    """Return a number of bytes as people read it."""
    unit = "B"
    for larger in ("KiB", "MiB", "GiB"):
        if count < 1024.0:
            break
        count, unit = count / 1024.0, larger
    return f"{count:.0f} B" if unit == "B" else f"{count:.1f} {unit}"


def check_outputs(force: bool, *paths: str | None) -> None:
    """Refuse, before the work, to write figures and films where lutgen made nothing."""
    for path in paths:
        if path is not None:
            check_target(path, force)


def save_figure(draw: Callable[[Any], Any], path: str | None, options: FigureOptions) -> None:
    """Let a figure be drawn by `lutgen.plot` and write it, if it has a path."""
    if path is not None:
        with figures.on_sheet(options.size, options.style):
            figures.save(draw(figures), path, force=options.force)


def save_columns(columns: Mapping[str, Sequence[Any]], path: str | None, force: bool) -> None:
    """Write columns of equal length as CSV, if there is a path."""
    if path is not None:
        text = csv_text(list(columns), zip(*columns.values(), strict=True))
        write_text(path, text, force)

"""NAME_report.md: the report as a page for people, from the content of NAME_report.json alone."""

from collections.abc import Iterable, Sequence
from typing import Any

from firmware_export.emit.facts import (
    MEANING,
    axis_range,
    channel_unit,
    chart_text,
    error_texts,
    movement,
    number,
    share,
)
from firmware_export.emit.size import TARGET
from firmware_export.protocol import CBody, Export

__all__ = ["page", "pareto_rows"]


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Return a Markdown table."""
    lines = [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    for row in rows:
        cells = [cell.replace("|", "\\|") for cell in row]
        lines.append(f"| {' | '.join(cells)} |")
    return [*lines, ""]


def _count(value: int | None) -> str:
    return "not measured" if value is None else f"{value:,}"


def pareto_rows(pareto: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the candidates from the smallest to the largest."""
    return sorted(
        pareto,
        key=lambda row: (
            row.get("total_bytes") or row["bytes"],
            row["error"] if row.get("error") is not None else float("inf"),
            str(row.get("label", "")),
        ),
    )


def page(export: Export, body: CBody, content: dict[str, Any], picture: str | None) -> str:
    """Return NAME_report.md.

    Parameters
    ----------
    export, body
        The export and its tables.
    content : dict
        See `report.report`.
    picture : str, optional
        File name of the plot of bytes against error.
    """
    recipe = export.recipe
    lines = [
        f"# Firmware export {export.name}",
        "",
        f"Stability map of the robot {' '.join(recipe.name.split())}, codec `{export.codec}` "
        f"({content['spec']}), {export.arithmetic} arithmetic.",
        "",
        "## Flash",
        "",
    ]
    sizes = content["bytes"]
    rows = [(part, _count(sizes[part])) for part in ("tables", "descriptors", "code", "total")]
    lines += _table((f"part ({TARGET})", "bytes"), rows)
    lines += _table(
        ("table", "type", "elements", "holds"),
        [(a.name, a.ctype, f"{len(a.values):,}", a.comment) for a in body.arrays if not a.plain]
        + [(a.name, a.ctype, f"{a.numbers.size:,}", a.comment) for a in body.arrays if a.plain],
    )
    lines += _counts(content["counts"])
    lines += ["## Parameters and directions", ""]
    lines += _table(
        ("parameter", "range", "what it does"),
        [(p.name, axis_range(p), movement(p, recipe)) for p in recipe.parameters],
    )
    lines += [f"Gravity: {chart_text(recipe)}.", "", "## Accuracy", ""]
    lines += _accuracy(export, content)
    if export.pareto:
        lines += _choice(export, picture)
    lines += ["## Provenance", ""]
    lines += [
        f"Recipe sha256 `{content['recipe_sha256']}`, lutgen {content['lutgen_version']}, "
        f"smap {content['smap_version']}.",
        "",
    ]
    return "\n".join(lines)


def _counts(counts: list[dict[str, Any]] | None) -> list[str]:
    """Return the table of what a read costs, or a line that says that it was not counted."""
    lines = ["## Cost of a read", ""]
    if counts is None:
        return [*lines, "Not measured for these tables.", ""]
    rows = [
        (f"{c['target']}, {c['option']}", c["unit"], f"{c['median']:,}", f"{c['max']:,}")
        for c in counts
    ]
    lines += ["On emulators, over 256 queries; instructions are not cycles.", ""]
    return lines + _table(("target", "unit", "median", "most"), rows)


def _accuracy(export: Export, content: dict[str, Any]) -> list[str]:
    """Return the lines on errors and on the verdict."""
    recipe, lines = export.recipe, []
    rows = []
    for channel in export.channels:
        entry = content["channels"][channel]["error"]
        errors = (
            error_texts(channel, entry, recipe.length_unit) if entry else ("not measured", "", "")
        )
        unit = channel_unit(channel, recipe)
        rows.append((f"`{channel}`", MEANING[channel], unit, *errors))
    lines += _table(("channel", "meaning", "unit", "largest error", "p99", "RMS"), rows)
    if content["points"]:
        lines.append(f"Measured on {content['points']:,} points that the fit has not seen.")
    certificate = export.certificate or {}
    if certificate.get("beyond") is not None:
        lines.append(f"Share of points beyond the error asked for: {share(certificate['beyond'])}.")
    lines += [str(text) for text in certificate.get("text", ())]
    lines += ["", "The verdict:", ""]
    unsafe = content["false_safe"]
    lines += [
        f"- answered safe where the robot tips: "
        f"{'not measured' if unsafe is None else f'{unsafe:,} points'}",
        f"- guard subtracted from `tip_angle`: {number(content['guard_deg'])} deg "
        f"({content['guard_text']})",
        f"- standing configurations given up: {share(content['given_up'])}",
        "",
    ]
    return lines


def _choice(export: Export, picture: str | None) -> list[str]:
    """Return the table of candidates and the plot."""
    lines = ["## What it was chosen from", ""]
    rows = []
    for row in pareto_rows(export.pareto or ()):
        mark = "**chosen**" if row.get("chosen") else ""
        error = row.get("error")
        rows.append(
            (
                str(row.get("label", "")),
                _count(row["bytes"]),
                _count(row.get("total_bytes")),
                "-" if error is None else f"{number(error, 3)} %",
                mark,
            )
        )
    kind = "p99" if (export.certificate or {}).get("jumps") else "largest"
    lines += _table(("candidate", "bytes of tables", "with code", f"{kind} error of sdg", ""), rows)
    if picture:
        lines += [f"![Bytes against error]({picture})", ""]
    return lines

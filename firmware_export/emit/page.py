"""NAME_report.md: the report as a page for people, from the content of NAME_report.json alone.

Names come from a recipe that anybody may have written: no markup of theirs is markup on the page.
"""

import re
from collections.abc import Iterable, Sequence
from typing import Any

from firmware_export.emit.words import (
    FALSE_TIP,
    axis_range,
    chart_text,
    errors_of,
    number,
    share,
)
from firmware_export.protocol import CBody
from lutgen.quantities import QUANTITIES

# What takes flash.
PARTS = ("tables", "descriptors", "code", "control", "policy", "total")
# What was counted, in words.
COST = {
    "pose": "`smap_pose`",
    "both": "`smap_pose`, both forms",
    "form_i": "the integer form alone",
    "at": "`smap_at`",
    "at_i": "`smap_at_i`",
    "read": "whole read",
}


def literal(text: str) -> str:
    r"""Return a text of one line that Markdown and HTML show as it is.

    Examples
    --------
    >>> print(literal("<b>front</b> [x](y)"))
    &lt;b&gt;front&lt;/b&gt; \[x\](y)
    """
    escaped = re.sub(r"([\\`*\[\]!])", r"\\\1", " ".join(text.split()))
    return escaped.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """Return a Markdown table."""
    lines = [f"| {' | '.join(head)} |", f"|{'---|' * len(head)}"]
    for row in rows:
        cells = [cell.replace("|", "\\|") for cell in row]
        lines.append(f"| {' | '.join(cells)} |")
    return [*lines, ""]


def _count(value: int | None) -> str:
    return "not measured" if value is None else f"{value:,}"


def page(content: dict[str, Any], body: CBody, picture: str | None) -> str:
    """Return NAME_report.md from the content of NAME_report.json and its tables.

    `picture` is the file name of the plot of bytes against error.
    """
    sizes, tables = content["bytes"], [array for array in body.arrays if array.table]
    lines = [
        f"# Firmware export {content['name']}",
        "",
        f"Stability map of the robot {literal(content['robot'])}, codec "
        f"`{content['codec']}` ({content['spec']}), {content['arithmetic']} arithmetic.",
        "",
        "## Flash",
        "",
    ]
    rows = [(part, _count(sizes[part])) for part in PARTS if part in sizes]
    how = "measured" if sizes["measured"] else "at most"
    lines += _table((f"part ({sizes['target']})", f"bytes, {how}"), rows)
    lines += _table(
        ("table", "type", "elements", "holds"),
        [
            (array.name, array.ctype, f"{array.numbers.size:,}", literal(array.comment))
            for array in tables
            if array.bytes
        ],
    )
    lines += _counts(content["counts"])
    lines += ["## Parameters and directions", ""]
    lines += _table(
        ("parameter", "range", "what it does"),
        [(literal(p["name"]), axis_range(p), literal(p["meaning"])) for p in content["parameters"]],
    )
    lines += [f"Gravity: {chart_text(content['chart'])}.", "", "## Accuracy", ""]
    lines += _accuracy(content)
    if content["pareto"]:
        lines += _choice(content, picture)
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
        (
            f"{c['target']}, {c['option']}",
            COST[c["call"]],
            c["unit"],
            f"{c['median']:,}",
            f"{c['max']:,}",
            "-" if c["stack"] is None else f"{c['stack']:,}",
        )
        for c in counts
    ]
    lines += [
        "On emulators, over 256 queries; instructions are not cycles. The stack is in bytes, "
        "without the compiler's own arithmetic and interrupts; a whole read has its pose there.",
        "",
    ]
    return lines + _table(("target", "call", "unit", "median", "most", "stack"), rows)


def _accuracy(content: dict[str, Any]) -> list[str]:
    """Return the lines on errors and on the verdict."""
    certificate, unsafe = content["certificate"] or {}, content["false_safe"]
    rows = [
        (f"`{name}`", QUANTITIES[name].in_c, content["channels"][name]["unit"], *texts)
        for name, texts in errors_of(content).items()
        for texts in [texts or ("not measured", "", "")]
    ]
    guard = f"guard subtracted from `tip_angle`: {number(content['guard_deg'])} deg"
    lines = _table(("channel", "meaning", "unit", "largest error", "p99", "RMS"), rows)
    if content["points"]:
        lines.append(f"Measured on {content['points']:,} points that the fit has not seen.")
    if certificate.get("beyond") is not None:
        lines.append(f"Share of points beyond the error asked for: {share(certificate['beyond'])}.")
    return [
        *lines,
        *certificate.get("text", ()),
        "",
        "The verdict:",
        "",
        f"- answered safe where the robot tips: "
        f"{'not measured' if unsafe is None else f'{unsafe:,} points'}",
        f"- {guard} ({content['guard_text']})",
        f"- {FALSE_TIP}: {share(content['false_tip'])}",
        "",
    ]


def _choice(content: dict[str, Any], picture: str | None) -> list[str]:
    """Return the table of candidates and the plot."""
    rows = [
        (
            str(row.get("label", "")),
            _count(row["bytes"]),
            _count(row.get("total_bytes")),
            "-" if row.get("error") is None else f"{number(row['error'], 3)} %",
            "**chosen**" if row.get("chosen") else "",
        )
        for row in content["pareto"]
    ]
    kind = "p99" if (content["certificate"] or {}).get("jumps") else "largest"
    head = ("candidate", "bytes of tables", "with code", f"{kind} error of sdg", "")
    lines = ["## What it was chosen from", "", *_table(head, rows)]
    if picture:
        lines += [f"![Bytes against error]({picture})", ""]
    return lines

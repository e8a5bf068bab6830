"""Fill the templates of an export folder from the content of its report."""

import json
import math
import re
import textwrap
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from firmware_export.emit import facts
from firmware_export.emit.names import macro
from firmware_export.emit.runtime import LICENCE, control_text, runtime_text
from firmware_export.host import family_of
from firmware_export.protocol import Export, describe, literal, turns
from lutgen._version import __version__
from lutgen.quantities import QUANTITIES

STATUSES = {
    "SMAP_OK": "stands",
    "SMAP_ROCKS": "rocks between two rests, but does not tip over",
    "SMAP_TIPS": "tips over",
    "SMAP_OFF_CHART": "unknown: the map holds no such direction",
    "SMAP_OFF_RANGE": "unknown: a joint is beyond its axis",
    "SMAP_CORRUPT": "the map is damaged",
    "SMAP_INVALID": "no valid query",
}
# The counts, in words.
COST = {
    "pose": "`smap_pose`",
    "both": "`smap_pose`, both forms",
    "form_i": "the integer form alone",
    "at": "`smap_at`",
    "at_i": "`smap_at_i`",
    "read": "whole read",
}
# avr-gcc makes no object of more bytes.
LARGEST_AVR = 32767


def texts(export: Export, content: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the name and the text of each file of an export but its report for programs."""
    name = export.name
    listed = {
        f"{name}.h": "header.h",
        f"{name}.c": "source.c",
        "examples/read.c": "read.c",
        "examples/alarm.c": "alarm.c",
        f"examples/{name}/{name}.ino": "control.ino" if export.policy else "sketch.ino",
        "CMakeLists.txt": "CMakeLists.txt",
        "library.json": "library.json",
        "library.properties": "library.properties",
        "zephyr/module.yml": "module.yml",
        "zephyr/CMakeLists.txt": "zephyr.cmake",
        f"{name}_report.md": "report.md",
    }
    if export.policy is not None:
        listed["examples/control.c"] = "control.c"
    if not export.integer:
        listed["examples/ros2_node.cpp"] = "ros2_node.cpp"
    context = _context(content) | _source(export)
    for file, template in listed.items():
        yield file, _environment().get_template(f"{template}.j2").render(context)


@cache
def _environment() -> Environment:
    """Return the templates; « and » stand in no C, and in no CMake."""
    made = Environment(
        loader=PackageLoader("firmware_export.emit"),
        variable_start_string="«",
        variable_end_string="»",
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        undefined=StrictUndefined,
    )
    filters: list[Callable[..., Any]] = [block_comment, columns, defines, json.dumps, literal]
    filters += [middle, posture, facts.bytes_text, facts.chart_text, facts.escaped]
    filters += [facts.number, facts.share]
    made.filters |= {one.__name__: one for one in filters}
    made.globals |= {"FALSE_TIP": facts.FALSE_TIP, "COST": COST}
    made.globals |= {"licence": LICENCE, "statuses": STATUSES}
    return made


def _context(content: dict[str, Any]) -> dict[str, Any]:
    """Return the report, and what the templates make of it."""
    numbers = [int(part) for part in __version__.split("+")[0].split(".") if part.isdigit()]
    pose, policy = content["pose"], content["policy"]
    integer, stem = content["arithmetic"] == "integer", macro(content["name"])
    sizes, unit = content["bytes"], content["length_unit"]
    pose_bytes = 4 * pose["integer" if integer else "both"] + 4
    what = f"{'bytes, measured' if sizes['measured'] else 'bytes at most'}"
    errors = facts.errors_of(content)
    return content | {
        "certificate": {"text": ()} | (content["certificate"] or {}),
        "MACRO": stem,
        "integer": integer,
        "count": max(len(content["parameters"]), 1),
        "pose_bytes": pose_bytes,
        # Arduino and PlatformIO insist on three numbers.
        "package_version": ".".join(map(str, [*numbers, 0, 0, 0][:3])),
        "sentence": f"Stability map of the robot {plain_text(content['robot'])}, read from flash",
        "axes": [
            (p["macro"], facts.axis_range(p), facts.slack_text(p), p["meaning"])
            for p in content["parameters"]
        ],
        "readings": [_reading(content, channel) for channel in content["channels"]],
        "errors": [(name, *said) for name, said in errors.items() if said],
        "accuracy": [
            (f"`{name}`", QUANTITIES[name].in_c, content["channels"][name]["unit"])
            + (said or ("not measured", "", ""))
            for name, said in errors.items()
        ],
        "macros": [
            (f"{stem}_PARAMS", str(len(content["parameters"])), "number of geometry parameters"),
            *(
                (p["macro"], str(i), f"{p['name']}, {p['unit']}")
                for i, p in enumerate(content["parameters"])
            ),
            (f"{stem}_FLASH", f"{sizes['total']}u", f"{what}: {sizes['target']}"),
            (f"{stem}_POSE_BYTES", f"{pose_bytes}u", "RAM of a pose, addresses of 4 bytes"),
            (f"{stem}_STACK", f"{sizes['stack']}u", f"{what}: the deepest call"),
            (f"{stem}_GAPS", str(int(content["gaps"])), "1: it may rock from rest to rest"),
        ],
        "steps_macros": [
            (
                f"{stem}_{channel.upper()}_STEP",
                literal(step),
                f"{'ratio' if unit == '1' else unit} in one step",
            )
            for channel, step in content["steps"].items()
        ],
        "milliseconds": max(1, math.floor(1000.0 * policy["cycle_s"] + 0.5)) if policy else None,
    }


def middle(parameter: dict[str, Any]) -> float:
    """Return the middle of an axis."""
    return float(0.5 * (parameter["min"] + parameter["max"]))


def posture(parameter: dict[str, Any]) -> str:
    """Return the middle of an axis as people write it."""
    value, unit = middle(parameter), parameter["display_unit"]
    shown = math.degrees(value) if unit == "deg" else value
    unit = "" if unit == "1" else f" {unit}"
    return plain_text(f"{parameter['name']:<13}{shown:.6g}{unit}".strip())


def _reading(content: dict[str, Any], channel: str) -> tuple[str, str]:
    """Return the member of the reading that holds a channel, and what it means."""
    unit = content["channels"][channel]["unit"]
    unit = "ratio of lengths" if unit == "1" else unit
    said = QUANTITIES[channel].in_c
    if content["arithmetic"] == "float":
        return channel, f"{said} ({unit})"
    if channel == "tip_angle":
        return "tip", "sine of the angle until the robot tips, guard subtracted (1/32767)"
    return channel, f"{said} ({macro(content['name'])}_{channel.upper()}_STEP, {unit})"


def _source(export: Export) -> dict[str, Any]:
    """Return what NAME.c holds beside the report: the runtime and the tables."""
    name, policy, blob = export.name, export.policy, describe(export)
    family = family_of(blob.codec, blob.integer)
    counts: dict[str, Any] = {
        "SMAP_OWN_BLOB": f"{name}_tables",
        "SMAP_OWN_BYTES": len(blob.bytes),
        "SMAP_MAX_PARAMS": max(export.model.k, 1),
        "SMAP_SERIES": 0,
        "SMAP_TURNS": int(any(turns(export.model, i) for i in range(export.model.k))),
        **dict(export.body.macros),
    }
    found = {
        "runtime": runtime_text(family),
        "too_large_for_avr": len(blob.bytes) > LARGEST_AVR,
        "tables_text": bytes_array("SMAP_OWN_BLOB", blob.bytes, blob.sections),
        "counts_text": counts,
    }
    if policy is not None:
        packed = policy.packed(blob.bytes)
        counts |= {"SMAP_CONTROL": 1, "SMAP_OWN_POLICY": f"{name}_policy"}
        counts["SMAP_OWN_POLICY_BYTES"] = len(packed)
        nodes, _, joints = policy.codes.shape
        table = f"table: u, v, joint; {nodes} x {nodes} x {joints} codes"
        sections = ((0, "checksums and settings"), (len(packed) - policy.table_bytes, table))
        found["control"] = control_text(family)
        found["policy_text"] = bytes_array("SMAP_OWN_POLICY", packed, sections)
    return found


# Lines of C have at most so many characters.
WIDTH = 100


def plain_text(text: str) -> str:
    """Return a text that can stand in a comment of any compiler: ASCII, no comment marks."""
    # A backslash at the end of a line would continue it, and ??/ is one for old compilers.
    text = re.sub(r"[^ -~]", "?", text.replace("°", " deg").replace("\\", "/"))
    return re.sub(r"\?(?=\?)", "? ", text).replace("*/", "* /").replace("/*", "/ *")


def block_comment(text: str) -> str:
    """Return lines as a comment; a long line is wrapped under its own indentation."""
    out: list[str] = []
    for number, line in enumerate(text.strip("\n").split("\n")):
        margin = re.match(r" *", line)
        rest = " " * (len(margin[0]) if margin else 0)
        wrapped = textwrap.wrap(
            plain_text(line),
            WIDTH - 6,
            subsequent_indent=rest + ("  " if rest else ""),
            break_long_words=False,
            break_on_hyphens=False,
        )
        for part in wrapped or [""]:
            out.append(f"{'/*' if not (number or out) else ' *'} {part}".rstrip())
    return "\n".join(out) + "\n */"


def columns(rows: Sequence[Sequence[str]], margin: str = "  ", gap: str = "  ") -> list[str]:
    """Return rows with their columns under one another."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        margin + gap.join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]


def defines(rows: Sequence[tuple[str, str, str]]) -> list[str]:
    """Return aligned #define lines of rows of name, value and comment."""
    return columns([(n, v, f"/* {note} */") for n, v, note in rows], "#define ", " ")


def bytes_array(name: str, packed: bytes, sections: Sequence[tuple[int, str]]) -> str:
    """Return bytes as C, each section behind a comment that says what it is."""
    ends = [at for at, _ in sections[1:]] + [len(packed)]
    lines = [f"const SMAP_FLASH uint8_t {name}[{len(packed)}] = {{"]
    fit = (WIDTH - 2) // 4
    for (begin, meaning), end in zip(sections, ends, strict=True):
        said = textwrap.wrap(f"{begin} {meaning}", WIDTH - 6)
        lines += [f"  /* {plain_text(part)} */" for part in said]
        for at in range(begin, end, fit):
            lines.append(f"  {','.join(map(str, packed[at : min(at + fit, end)]))},")
    return "\n".join([*lines, "};"])

"""Gather the facts of an export: the content of NAME_report.json, and its numbers in words.

The header, the examples, the page and the command line print nothing else.
"""

import base64
import math
import re
from typing import Any

from firmware_export.emit.names import macro
from firmware_export.emit.size import counted, flash_bytes
from firmware_export.model import sensor_tolerance
from firmware_export.protocol import VERSION, Export, describe, turns
from lutgen._version import __version__
from lutgen.files import plain
from lutgen.parts import Parameter
from lutgen.quantities import QUANTITIES
from lutgen.recipe import Recipe

FORMAT = 2
MARKER = "lutgen_export"
FALSE_TIP = "stable configurations reported unsafe"
OWN_MACROS = ("H", "PARAMS", "SDG_STEP", "HEIGHT_STEP", "FLASH", "POSE_BYTES", "STACK", "GAPS")
# The parts that take flash.
KINDS = ("tables", "descriptors", "code", "control", "policy")


def axis_macros(export: Export) -> tuple[str, ...]:
    """Return the macro of each parameter's index, all different."""
    stem = macro(export.name)
    taken = {f"{stem}_{word}" for word in OWN_MACROS}
    names: list[str] = []
    for index, parameter in enumerate(export.recipe.parameters):
        name = f"{stem}_{macro(parameter.name)}"
        # Names that differ in case only, or that are another macro.
        if {name, f"{name}_Q"} & taken:
            name = f"{stem}_PARAM_{index}_{macro(parameter.name)}"
        taken |= {name, f"{name}_Q"}
        names.append(name)
    return tuple(names)


def _movement(parameter: Parameter, recipe: Recipe) -> str:
    """Return what a parameter does to the robot."""
    parts = []
    for kind, verb in (("revolute", "turns"), ("prismatic", "shifts")):
        moved = [
            link.name
            for link in recipe.links
            if link.joint and (link.joint.kind, link.joint.parameter) == (kind, parameter.name)
        ]
        if moved:
            parts.append(f"{verb} {', '.join(moved)}")
    return " and ".join(parts) or "parameter of the recipe's own function"


def report(export: Export) -> dict[str, Any]:
    """Return the content of NAME_report.json but for its files; all other texts follow from it."""
    body, recipe, model, tables = export.body, export.recipe, export.model, export.tables
    certificate = export.certificate or {}
    errors = certificate.get("channels", {})
    content = {
        MARKER: FORMAT,
        "name": export.name,
        "robot": recipe.name,
        "lutgen_version": __version__,
        "smap_version": VERSION,
        "recipe_sha256": recipe.digest,
        "recipe": {"text": recipe.text, "urdf": recipe.urdf},
        "length_unit": recipe.length_unit,
        "gaps": recipe.rock_angle > 0.0 and len(recipe.contacts) > 3,
        "codec": export.codec,
        "spec": tables.spec.label,
        "arithmetic": export.arithmetic,
        "parameters": [
            {
                "name": parameter.name,
                "macro": name,
                "unit": parameter.unit,
                "display_unit": parameter.display_unit,
                "min": parameter.minimum,
                "max": parameter.maximum,
                "slack": None if turns(model, index) else sensor_tolerance(parameter),
                "meaning": _movement(parameter, recipe),
            }
            for index, (parameter, name) in enumerate(
                zip(recipe.parameters, axis_macros(export), strict=True)
            )
        ],
        "chart": {
            "kind": recipe.chart.kind,
            "faces": model.faces,
            "max_tilt_deg": math.degrees(recipe.chart.max_tilt)
            if recipe.chart.kind == "cone"
            else None,
        },
        "channels": {
            channel: {
                "unit": QUANTITIES[channel].stored_unit(recipe.length_unit),
                "error": errors.get(channel),
            }
            for channel in export.channels
        },
        "steps": {name: step for name, step in body.steps.items() if name in export.channels},
        "pose": {"both": body.pose[0], "integer": body.pose[1]},
        "policy": _policy(export),
        "bytes": flash_bytes(export),
        "counts": counted(export),
        "guard_deg": math.degrees(float(tables.guard)),
        "guard_text": tables.guard_text,
        "false_tip": certificate.get("false_tip"),
        "false_safe": certificate.get("false_safe"),
        "points": certificate.get("points"),
        "certificate": certificate or None,
    }
    result: dict[str, Any] = plain(content)
    return result


def _policy(export: Export) -> dict[str, Any] | None:
    """Return what is known of the policy, and its bytes, or None."""
    body, policy = export.body, export.policy
    if policy is None:
        return None
    packed = policy.packed(describe(export).bytes)
    # Behind an address: joints, some numbers, the pose with its address, the pose of a box.
    state = 4 * max(export.model.k, 1) + 16 + 3 + body.pose[0] + body.swept + 2
    return {
        "bytes": len(packed),
        "table_bytes": policy.table_bytes,
        "nodes": len(policy.codes),
        "state_words": state,
        "home": list(export.recipe.home_params),
        "cycle_s": policy.cycle,
        "latency_s": policy.latency,
        "margin_deg": math.degrees(policy.margin),
        "levels_deg": [math.degrees(level) for level in policy.levels],
        "blob": base64.b64encode(packed).decode("ascii"),
    }


def escaped(text: str) -> str:
    r"""Return a text of one line that Markdown and HTML show as it is.

    Examples
    --------
    >>> print(escaped("<b>front</b> [x](y)"))
    &lt;b&gt;front&lt;/b&gt; \[x\](y)
    """
    marked = re.sub(r"([\\`*\[\]!])", r"\\\1", " ".join(text.split()))
    return marked.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def number(value: float, digits: int = 4) -> str:
    """Return a number with a few significant digits, a dash if it is not known."""
    if not math.isfinite(value):
        return "-"
    return f"{value:.0f}" if abs(value) >= 10.0**digits else f"{value:.{digits}g}"


def axis_range(parameter: dict[str, Any]) -> str:
    """Return the range of a report's parameter in the unit of the C code, and in deg."""
    unit = "" if parameter["unit"] == "1" else f" {parameter['unit']}"
    low, high = parameter["min"], parameter["max"]
    text = f"{number(low, 7)} .. {number(high, 7)}{unit}"
    if parameter["unit"] == "rad":
        text += f" ({number(math.degrees(low))} .. {number(math.degrees(high))} deg)"
    return text


def slack_text(parameter: dict[str, Any]) -> str:
    """Return how far beyond its axis a parameter is read."""
    if parameter["slack"] is None:
        return "turns all the way round"
    if parameter["unit"] == "rad":
        return f"+- {number(math.degrees(parameter['slack']), 2)} deg"
    return f"+- {number(parameter['slack'], 2)}"


def chart_text(chart: dict[str, Any]) -> str:
    """Return which directions the map holds."""
    if chart["kind"] == "sphere":
        return "every direction"
    return f"up to {number(chart['max_tilt_deg'])} deg of pitch and of roll from straight down"


def share(value: float | None) -> str:
    """Return a share 0..1 in percent."""
    return "not measured" if value is None else f"{100.0 * value:.3g} %"


def errors_of(content: dict[str, Any]) -> dict[str, tuple[str, ...] | None]:
    """Return maximum, 99th percentile and RMS error of each channel of a report, with units.

    None stands for what was not measured.
    """
    unit = "" if content["length_unit"] == "1" else f" {content['length_unit']}"
    return {
        name: tuple(_error_text(name, channel["error"], key, unit) for key in ("max", "p99", "rms"))
        if channel["error"]
        else None
        for name, channel in content["channels"].items()
    }


def _error_text(channel: str, entry: dict[str, Any], key: str, unit: str) -> str:
    # A channel that jumps has no largest error, only a largest one that was seen.
    seen = ""
    if key == "max" and entry.get("max") is None:
        key, seen = "largest_seen", "no bound, seen: "
    value, percent = entry.get(key), entry.get(f"{key}_percent")
    if value is None:
        return "-"
    if channel == "tip_angle":
        return f"{seen}{number(math.degrees(value))} deg"
    extra = "" if percent is None else f" ({number(percent, 3)} %)"
    return f"{seen}{number(value)}{unit}{extra}"


def bytes_text(sizes: dict[str, Any]) -> str:
    """Return the bytes of flash in words; `sizes` is of `flash_bytes`."""
    parts = ", ".join(f"{sizes[kind]:,} of {kind}" for kind in KINDS if kind in sizes)
    total, how = f"{sizes['total']:,} bytes", f"on {sizes['target']}: {parts}"
    if sizes["measured"]:
        return f"{total}, measured {how}"
    return f"at most {total}, the largest of its family {how}"

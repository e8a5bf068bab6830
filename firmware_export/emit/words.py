"""The content of a report in words: one wording for the header, the page and the command line."""

import math
import re
from typing import Any

FALSE_TIP = "stable configurations reported unsafe"
# What takes flash.
KINDS = ("tables", "descriptors", "code", "control", "policy")
PARTS = (*KINDS, "total")


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
    """Return a number with a few significant digits; a dash for what is not known.

    Examples
    --------
    >>> number(0.0123456), number(1234567.0), number(math.nan)
    ('0.01235', '1234567', '-')
    """
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
    """Return a share 0..1 in percent.

    Examples
    --------
    >>> share(0.0123), share(0.0), share(None)
    ('1.23 %', '0 %', 'not measured')
    """
    return "not measured" if value is None else f"{100.0 * value:.3g} %"


def error_texts(channel: str, entry: dict[str, Any], length_unit: str) -> tuple[str, str, str]:
    """Return maximum, 99th percentile and RMS error of a channel, with units."""
    unit = "" if length_unit == "1" else f" {length_unit}"
    texts = []
    for name in ("max", "p99", "rms"):
        # A channel that jumps has no largest error, only a largest one that was seen.
        key = "largest_seen" if name == "max" and entry.get("max") is None else name
        value = entry.get(key)
        if value is None:
            texts.append("-")
            continue
        seen = "no bound, seen: " if key == "largest_seen" else ""
        if channel == "tip_angle":
            texts.append(f"{seen}{number(math.degrees(value))} deg")
            continue
        percent = entry.get(f"{key}_percent")
        extra = "" if percent is None else f" ({number(percent, 3)} %)"
        texts.append(f"{seen}{number(value)}{unit}{extra}")
    return texts[0], texts[1], texts[2]


def errors_of(content: dict[str, Any]) -> dict[str, tuple[str, str, str] | None]:
    """Return `error_texts` of each channel of a report, None for what was not measured."""
    return {
        name: error_texts(name, channel["error"], content["length_unit"])
        if channel["error"]
        else None
        for name, channel in content["channels"].items()
    }


def bytes_text(sizes: dict[str, Any]) -> str:
    """Return the bytes of flash in words; `sizes` is of `facts.flash_bytes`.

    Examples
    --------
    >>> known = {"tables": 66, "descriptors": 60, "code": 1200, "total": 1326, "target": "M4"}
    >>> bytes_text({**known, "measured": True})
    '1,326 bytes, measured on M4: 66 of tables, 60 of descriptors, 1,200 of code'
    """
    parts = ", ".join(f"{sizes[kind]:,} of {kind}" for kind in KINDS if kind in sizes)
    total, how = f"{sizes['total']:,} bytes", f"on {sizes['target']}: {parts}"
    if sizes["measured"]:
        return f"{total}, measured {how}"
    return f"at most {total}, the largest of its family {how}"

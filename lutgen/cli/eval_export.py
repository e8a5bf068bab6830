"""`lutgen eval EXPORT_DIR`: the C runtime is asked, with the tables of an export."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lutgen.cli.options import Assignments, internal_values, log
from lutgen.cli.table import channel_entries
from lutgen.quantities import EXPORTABLE

if TYPE_CHECKING:
    from firmware_export.device import ExportFolder

STATUS = {
    0: "SMAP_OK",
    1: "SMAP_ROCKS",
    2: "SMAP_TIPS",
    3: "SMAP_OFF_CHART",
    4: "SMAP_OFF_RANGE",
    5: "SMAP_CORRUPT",
    6: "SMAP_INVALID",
}
# Answers with which the robot is said not to tip; nothing is known off the chart or the axes.
STANDS, UNKNOWN = ("SMAP_OK", "SMAP_ROCKS"), ("SMAP_OFF_CHART", "SMAP_OFF_RANGE")
# What smap_read_i calls a channel that is not held, and its full scale.
NOT_HELD, FULL_SCALE = 65535, 32767


def export_report(
    directory: Path, assignments: Assignments, gravity: Sequence[float]
) -> dict[str, Any]:
    """Return the report on one point of an export, a folder of `lutgen export`.

    Values are assigned in the units that the recipe gave the parameters; gravity (3,) points down.
    """
    from firmware_export.device import ExportFolder

    folder = ExportFolder(directory)
    content = folder.report
    units = {p["name"]: p["display_unit"] for p in content["parameters"]}
    values = internal_values(str(directory), units, assignments)
    for parameter, value in zip(content["parameters"], values, strict=True):
        if not parameter["min"] <= value <= parameter["max"]:
            log.warning("parameter %s is outside the export's range", parameter["name"])
    if folder.integer:
        status, channels = _read_integer(folder, values, gravity)
    else:
        codes, readings = folder.host.read([values], [gravity])
        status = STATUS[int(codes[0])]
        channels = dict(zip(EXPORTABLE, map(float, readings[0]), strict=True))
    known = status not in UNKNOWN
    return {
        "robot": content["robot"],
        "source": "compiled",
        "length_unit": content["length_unit"],
        "status": status,
        "on_chart": status != "SMAP_OFF_CHART",
        "standing": status in STANDS if known else None,
        **channel_entries(
            {name: channels[name] if known else math.nan for name in content["channels"]}
        ),
    }


def _read_integer(
    folder: "ExportFolder", values: Sequence[float], gravity: Sequence[float]
) -> tuple[str, dict[str, float]]:
    """Ask smap_read_i; return the status and the channels in rad and length."""
    row = []
    for parameter, value in zip(folder.report["parameters"], values, strict=True):
        low, high = parameter["min"], parameter["max"]
        code = round((value - low) / (high - low) * FULL_SCALE)
        # Above the upper end there are no steps: off range.
        row.append(max(code, -FULL_SCALE - 1) if value <= high else -FULL_SCALE - 1)
    down = np.asarray(gravity, dtype=np.float64)
    # The longest vector of the same direction that fits resolves it best.
    down = np.rint(down / np.abs(down).max() * FULL_SCALE)
    codes, readings = folder.host.read_i([row], [down])
    sdg, tip, height = (int(value) for value in readings[0])
    steps = folder.report["steps"]
    lengths = {
        name: math.nan if code == NOT_HELD else code * steps.get(name, math.nan)
        for name, code in (("sdg", sdg), ("height", height))
    }
    sine = max(-1.0, min(1.0, tip / FULL_SCALE))
    return STATUS[int(codes[0])], {**lengths, "tip_angle": math.asin(sine)}

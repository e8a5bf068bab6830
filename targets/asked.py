"""What counts are wanted: medians and largest of calls on chips, and how far a run is from them."""

from dataclasses import dataclass
from typing import Any

from targets.baseline import flat
from targets.tables import columns


@dataclass(frozen=True)
class Asked:
    """A number that is asked for, with `-O2`; `largest` None where only the median is."""

    row: str
    board: str
    call: str
    median: int
    largest: int | None = None


ASKED = (
    Asked("marv", "m4f", "pose", 3_000, 4_500),
    Asked("marv", "m4f", "form_i", 1_200),
    Asked("marv", "m4f", "at", 500, 1_100),
    Asked("marv", "m3", "at_i", 210, 420),
    Asked("marv", "m0", "at_i", 330, 680),
    Asked("absolem", "m4f", "pose", 10_000, 20_000),
    Asked("absolem", "m4f", "at", 1_200, 3_000),
    Asked("absolem", "m3", "at_i", 400, 900),
    Asked("excavator", "m3", "at_i", 140),
    Asked("articulated", "m4f", "pose", 30_000, 60_000),
    Asked("articulated", "m3", "at_i", 300, 800),
    Asked("quadruped", "m4f", "pose", 12_000, 25_000),
    Asked("quadruped", "m3", "at_i", 150, 300),
    Asked("paper_two", "m4f", "read", 270, 300),
    Asked("paper_two_grid_integer", "m3", "read", 400),
    Asked("car_grid_float", "m4f", "read", 120),
    Asked("car_grid_integer", "m4f", "read", 110),
    Asked("car_grid_integer", "m3", "read", 110),
)
# Bytes on a Cortex-M4F: of code with -Os, of the deepest stack (that of integers alone) and of
# a pose with floats, of a pose in both forms and of integers alone.
BYTES = {
    "marv": {
        "code": 3_000,
        "stack": 500,
        "pose stack": 500,
        "pose_bytes": 900,
        "pose_i_bytes": 500,
    },
    "absolem": {
        "code": 3_000,
        "stack": 500,
        "pose stack": 500,
        "pose_bytes": 2_500,
        "pose_i_bytes": 1_200,
    },
}


def table(content: dict[str, Any]) -> str:
    """Return what was counted beside what is asked, of the rows and boards that are there."""
    lines = list[list[str]]()
    for one in ASKED:
        cell = content["rows"].get(one.row, {}).get("boards", {}).get(one.board, {}).get("-O2", {})
        found = cell.get("calls", {}).get(one.call)
        if found:
            wanted = f"{one.median:,}" + (f" / {one.largest:,}" if one.largest else "")
            met = found["median"] <= one.median and found["max"] <= (one.largest or found["max"])
            said = f"{found['median']:,} / {found['max']:,}"
            lines.append([f"{one.row} {one.board} {one.call}", said, wanted, "" if met else "more"])
    for name, sizes in BYTES.items():
        cell = content["rows"].get(name, {}).get("boards", {}).get("m4f", {}).get("-Os", {})
        for key, most in sizes.items():
            size = flat(cell).get(key)
            if size is not None:
                label = f"{name} m4f -Os {key.replace('_', ' ')}"
                lines.append([label, f"{size:,}", f"{most:,}", "" if size <= most else "more"])
    return columns(["what", "counted", "asked", ""], lines) if lines else "nothing of it was run"

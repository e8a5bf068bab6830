"""What `lutgen limits` says: the JSON, and the text made of it."""

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from lutgen.analysis import HeadingLimit, PostureLimits, SweepLimits
    from lutgen.recipe import Recipe


def _number(value: float) -> float | None:
    """Return degrees for JSON, which knows no NaN."""
    return math.degrees(value) if math.isfinite(value) else None


def _posture(recipe: "Recipe", params: "NDArray[np.float64]") -> dict[str, float]:
    """Return a posture in display units, named with them."""
    entries = {}
    for p, value in zip(recipe.parameters, params.tolist(), strict=True):
        unit = "" if p.display_unit == "1" else f"_{p.display_unit}"
        entries[f"{p.name}{unit}"] = math.degrees(value) if p.display_unit == "deg" else value
    return entries


def _heading(row: "HeadingLimit") -> dict[str, Any]:
    return {
        "name": row.name,
        "heading_deg": _number(row.heading),
        "tilt_deg": math.degrees(row.tilt),
        "contacts": list(row.contacts),
        "slides_first": row.slides,
    }


def report(
    recipe: "Recipe",
    found: "PostureLimits",
    swept: "SweepLimits | None",
    over_all: bool,
    best: int,
) -> dict[str, Any]:
    """Return what `--json` prints; null where there is no value.

    `best` is the number of headings to print the best posture of; `swept` has a multiple of it.
    """
    mu = recipe.friction
    told: dict[str, Any] = {
        "robot": recipe.name,
        "length_unit": recipe.length_unit,
        "convention": found.convention,
        "posture": _posture(recipe, found.params),
        "friction": mu,
        "friction_angle_deg": None if mu is None else math.degrees(math.atan(mu)),
        "limits": [_heading(row) for row in found.headings],
        "guaranteed_tilt_deg": math.degrees(found.guaranteed),
    }
    if swept is not None and over_all:
        told["all_postures"] = _all(recipe, swept)
    if swept is not None and best:
        step = len(swept.headings) // best
        told["best_postures"] = [
            {
                "heading_deg": math.degrees(swept.headings[i]),
                "tilt_deg": math.degrees(swept.most[i]),
                "posture": _posture(recipe, swept.params[swept.most_at[i]]),
            }
            for i in range(0, len(swept.headings), step)
        ]
    return told


def _all(recipe: "Recipe", swept: "SweepLimits") -> dict[str, Any]:
    """Return the limits over all postures: in the four headings, and in the worst of each."""
    from lutgen.analysis import FOUR, WORST

    rows = []
    for i, name in enumerate(FOUR):
        # The headings go round evenly from the nose to the left.
        at = i * len(swept.headings) // len(FOUR)
        least, most = int(swept.least_at[at]), int(swept.most_at[at])
        rows.append((name, swept.least[at], least, swept.most[at], most))
    weakest, strongest = swept.weakest, swept.strongest
    guaranteed = swept.guaranteed
    rows.append((WORST, guaranteed[weakest], weakest, guaranteed[strongest], strongest))
    return {
        "postures": len(swept.params),
        "tip_on_level_ground": int((guaranteed <= 0.0).sum()),
        "limits": [
            {
                "name": name,
                "least_tilt_deg": math.degrees(least),
                "least_at": _posture(recipe, swept.params[least_at]),
                "largest_tilt_deg": math.degrees(most),
                "largest_at": _posture(recipe, swept.params[most_at]),
            }
            for name, least, least_at, most, most_at in rows
        ],
    }


def _words(posture: dict[str, float]) -> str:
    """Return a posture as text."""
    parts = []
    for key, value in posture.items():
        name, _, unit = key.rpartition("_")
        known = unit in ("deg", "rad", "m", "cm", "mm") and name
        parts.append(f"{name} = {value:.6g} {unit}" if known else f"{key} = {value:.6g}")
    return ", ".join(parts)


def _table(rows: list[list[str]]) -> list[str]:
    """Return rows with their columns aligned."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]


def _angle(degrees: float | None) -> str:
    if degrees is None:
        return "-"
    return "never" if degrees >= 180.0 else f"{degrees:.2f} deg"


def _event(row: dict[str, Any]) -> list[str]:
    """Return what happens at a limit: over which axis, and whether it has slid before."""
    over = " - ".join(row["contacts"]) or "-"
    if row["slides_first"] is None:
        return [over]
    return [over, "slides first" if row["slides_first"] else "tips first"]


def lines(told: dict[str, Any]) -> list[str]:
    """Return the report as text."""
    posture = _words(told["posture"])
    tilted = {"plane": "ground", "body": "body"}[told["convention"]]
    text = [f"{told['robot']}: tilt of the {tilted} from level until the robot tips over"]
    if posture:
        text.append(posture)
    width = 1 + (told["friction"] is not None)
    head = ["heading", "", "tilt", "turns over", "friction"]
    rows = [head[: 3 + width]]
    for row in told["limits"]:
        event = _event(row)
        event += ["-"] * (width - len(event))
        heading = row["heading_deg"]
        shown = "-" if heading is None else f"{heading:.1f} deg"
        rows.append([row["name"], shown, _angle(row["tilt_deg"]), *event])
    text += _table(rows)
    if told["guaranteed_tilt_deg"] <= 0.0:
        text.append("it tips over on level ground")
    else:
        # Rounded down: what is printed holds, too.
        guaranteed = math.floor(100.0 * told["guaranteed_tilt_deg"]) / 100.0
        text.append(f"guaranteed in every heading: {_angle(guaranteed)}")
    if told["friction"] is not None:
        text.append(
            f"slides on slopes above {told['friction_angle_deg']:.2f} deg "
            f"(friction {told['friction']:g})"
        )
    if "all_postures" in told:
        text += ["", *_all_lines(told["all_postures"])]
    if "best_postures" in told:
        rows = [["heading", "tilt", "best posture"]]
        rows += [
            [
                f"{row['heading_deg']:.1f} deg",
                _angle(row["tilt_deg"]),
                _words(row["posture"]) or "-",
            ]
            for row in told["best_postures"]
        ]
        text += ["", *_table(rows)]
    return text


def _all_lines(told: dict[str, Any]) -> list[str]:
    """Return the limits over all postures as text."""
    text = [f"over {told['postures']} postures of the sweep"]
    tipping = told["tip_on_level_ground"]
    if tipping:
        text[0] += f", of which {tipping} tip over on level ground"
    rows = [["heading", "least", "at", "largest", "at"]]
    for row in told["limits"]:
        ends = [
            cell
            for end in ("least", "largest")
            for cell in (_angle(row[f"{end}_tilt_deg"]), _words(row[f"{end}_at"]) or "-")
        ]
        rows.append([row["name"], *ends])
    text += _table(rows)
    best = told["limits"][-1]
    where = _words(best["largest_at"])
    if where:
        text.append(f"best posture: {where}")
    return text

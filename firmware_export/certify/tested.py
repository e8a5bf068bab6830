"""The certificate of a table that is tested, not proved: fresh points, half beside the boundary.

One half of the points is uniform.  The other lies beside the boundary and at the ends of axes.
A point that is falsely safe ends a test: the table is lowered, and other points judge it.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from firmware_export.certify.answers import Reader
from firmware_export.certify.certifier import Certificate
from firmware_export.quantity import ErrorBound
from firmware_export.truth import biased, uniform
from lutgen.vector import Floats

# Points of a test for one of another codec's certificate: 10 million.  Points of each half of a
# part, after which it may end.
TIMES, PART = 20, 500_000
# Tip angle (rad) up to which tables tell it.
MOST = math.radians(30.0)
# Events that a rate has caused with a probability of 95 % if none was seen.
EXCLUDED = 3.0


def put_to_test(
    reader: Reader,
    channels: Sequence[str],
    bound: ErrorBound | None,
    points: int,
    seed: int,
) -> Certificate:
    """Compare an export with the truth on `TIMES` as many points, or until one is falsely safe."""
    parts = max(1, points * TIMES // (2 * PART))
    size = max(1, points * TIMES // (2 * parts))
    lost: list[Floats] = []
    errors: dict[str, list[Floats]] = {name: [] for name in channels if name != "tip_angle"}
    ends = {name: [math.inf, -math.inf] for name in errors}
    asked = standing = refused = 0
    wrong: list[tuple[Floats, Floats]] = []
    for part in range(parts):
        seen = reader.measure(uniform(reader.model, size, 1000 * seed + part))
        stands = seen.standing
        both = stands & seen.answers.stands
        lost.append((np.minimum(seen.exact.tip_angle, MOST) - seen.answers.tip_angle)[both])
        for name, found in errors.items():
            value = getattr(seen.exact, name)
            found.append(np.abs(getattr(seen.answers, name) - value)[both])
            low, high = ends[name]
            ends[name] = [min(low, np.nanmin(value)), max(high, np.nanmax(value))]
        standing += int(stands.sum())
        refused += int((stands & ~seen.answers.stands).sum())
        for one in (seen, reader.measure(biased(reader.model, size, 1000 * seed + part))):
            at = np.argwhere(one.false_safe)
            wrong.append((one.sample.params[at[:, 0]], one.sample.gravity[at[:, 0], at[:, 1]]))
            asked += one.sample.points
        if any(len(one[0]) for one in wrong):
            break
    q, g = (np.concatenate([one[at] for one in wrong]) for at in (0, 1))
    table = (
        {"tip_angle": _channel(np.concatenate(lost), 2.0 * MOST)} if "tip_angle" in channels else {}
    )
    for name, found in errors.items():
        table[name] = _channel(np.concatenate(found), ends[name][1] - ends[name][0])
        for key in ("max", "max_percent"):
            table[name][key.replace("max", "largest_seen")] = table[name].pop(key)
    beyond = None
    if bound is not None and "sdg" in errors:
        limit = bound.value * (table["sdg"]["range"] / 100.0 if bound.relative else 1.0)
        beyond = float(np.mean(np.concatenate(errors["sdg"]) > limit))
    return Certificate(
        points=asked,
        standing=standing,
        channels={name: table[name] for name in channels},
        false_safe=len(q),
        false_tip=refused / max(standing, 1),
        jumps="sdg" in errors,
        beyond=beyond,
        nearest=0.0,
        searched=0,
        seed=seed,
        text=tuple(_sentences(np.concatenate(lost), asked)),
        witness=(q[0], g[0], 0.0, -math.nan) if len(q) else None,
        wrong=(q, g) if len(q) else None,
    )


def _channel(error: Floats, span: float) -> dict[str, Any]:
    """Return the entry of a channel, see `Certificate`; what jumps has no largest error."""
    size = np.abs(error)
    entry = {"max": float(size.max(initial=0.0)), "rms": float(np.sqrt(np.mean(size * size)))}
    entry["p99"] = float(np.quantile(size, 0.99))
    entry |= {"p99_uniform": entry["p99"], "rms_uniform": entry["rms"], "range": span}
    scale = 100.0 / span if span > 0.0 else 0.0
    return entry | {
        f"{key}_percent": value * scale for key, value in entry.items() if key != "range"
    }


def _sentences(lost: Floats, points: int) -> list[str]:
    """Return what people should know beside the numbers."""
    half, most = np.degrees(np.quantile(lost, [0.5, 0.9])) if len(lost) else (0.0, 0.0)
    above = lost < -1e-9
    worst = math.degrees(-float(lost.min(initial=0.0)))
    return [
        f"tip_angle: half of the angles are low by less than {half:.2g} deg, 9 of 10 by less than "
        f"{most:.2g} deg, and above 30 deg it says 30; {100.0 * float(np.mean(above)):.2g} % are "
        f"above the truth, by {worst:.2g} deg at most.",
        f"Tested, not proved: of {points:,} fresh points, half of them beside the boundary, none "
        f"was falsely safe; that excludes a rate above {EXCLUDED / points:.1g}.",
    ]

"""Certify an export: measure its errors, and attack its verdict.

No fit and no choice has seen the points.  On them every answer is compared with the exact model;
then a search from the worst points finds the largest error, and a point that is called safe and
tips.  A trained table is tested on many more points instead, half of them beside the boundary.
"""

import math
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from firmware_export.certify import attack
from firmware_export.certify.answers import Reader, Witness, numbers_of, span_of, statistics
from firmware_export.model import Cells, biased, uniform
from firmware_export.quantity import ErrorBound
from lutgen.errors import ExportError, reject
from lutgen.vector import Floats

# Points of a certificate, half of them uniform and half where tables err most; starts of each half
# and kind of search, and rounds of each, in proportion to the points, and the least of both.
POINTS, STARTS, ROUNDS, LEAST = 500_000, 24, 40, 15
# Fits and choices use seeds below 1000.
SEED = 1001
# Points of a test for one of another codec's certificate: 10 million.  Points of each half of a
# part, after which it may end.
TIMES, PART = 20, 500_000
# Tip angle (rad) up to which trained tables store it.
MOST = math.radians(30.0)
# Events that a rate has caused with a probability of 95 % if none was seen.
EXCLUDED = 3.0


@dataclass(frozen=True)
class Certificate:
    """Measurements of an export: `points` are compared, `standing` of them stand.

    `channels` have ``max`` (absent where |SD_g| jumps: then ``largest_seen``), ``p99``, ``rms`` in
    the channel's unit over all points, ``p99_uniform`` and ``rms_uniform`` over the uniform half;
    also ``range`` and the same in percent of it, ``..._percent``.  `false_safe` counts points, also
    of the search, that are called safe and tip; `false_tip` is the share of the standing points of
    the uniform half that are called tipping, and `beyond` of those whose |SD_g| error is beyond the
    bound requested.  By `nearest` (rad) the search failed to find a false safe; `wrong`, parameters
    (n, k) and gravity (n, 3), are all that a test found.
    """

    points: int
    standing: int
    channels: dict[str, dict[str, float]]
    false_safe: int
    false_tip: float
    jumps: bool
    beyond: float | None
    nearest: float = 0.0
    searched: int = 0
    seed: int = SEED
    text: tuple[str, ...] = ()
    witness: Witness | None = field(default=None, compare=False)
    wrong: tuple[Floats, Floats] | None = field(default=None, compare=False)

    def as_dict(self) -> dict[str, Any]:
        """Return what the header and the report print; plain numbers and texts."""
        content = dict(vars(self))
        del content["witness"], content["wrong"]
        content["nearest_false_safe_rad"] = content.pop("nearest")
        return content | {"text": list(self.text)}

    def error_of(self, channel: str, relative: bool) -> float:
        """Return the largest error of a channel, or p99 where |SD_g| jumps.

        In percent of its range, or in its unit.
        """
        name = "p99" if self.jumps and channel != "tip_angle" else "max"
        return self.channels[channel][f"{name}_percent" if relative else name]

    def error(self, relative: bool) -> float:
        """Return what is compared with a bound."""
        return max(self.error_of(channel, relative) for channel in bounded(self.channels))

    def refuse_false_safe(self, label: str) -> None:
        """Raise ExportError if a point is called safe where the robot tips."""
        if not self.false_safe:
            return
        where = ""
        if self.witness is not None:
            params, gravity, said, true = self.witness
            where = (
                f", for one at parameters {np.round(params, 7).tolist()} and gravity "
                f"{np.round(gravity, 7).tolist()}: {said:.3g} rad for {true:.3g}"
            )
        fault = "nothing was written: this is a fault of the codec's guard"
        way_out = f"{fault}, choose another with --codec and report it"
        what = "the certificate found the robot called safe where it tips"
        reject(label, what, f"{self.false_safe} points{where}", way_out, ExportError)


def bounded(channels: Iterable[str]) -> tuple[str, ...]:
    """Return the channels that a bound is for: lengths, or the tip angle where it is alone."""
    return tuple(name for name in channels if name != "tip_angle") or ("tip_angle",)


def _entry(
    every: dict[str, float], even: dict[str, float], span: float, jumps: bool
) -> dict[str, float]:
    """Return the entry of a channel, see `Certificate`; what jumps has no largest error."""
    entry = every | {f"{key}_uniform": even[key] for key in ("p99", "rms")}
    # A value that never changes has no range to take a percentage of.
    scale = 100.0 / span if span > 0.0 else 0.0
    entry |= {f"{key}_percent": value * scale for key, value in entry.items()}
    entry["range"] = span
    if jumps:
        for key in ("max", "max_percent"):
            entry[key.replace("max", "largest_seen")] = entry.pop(key)
    return entry


def _beyond(errors: Floats, bound: ErrorBound | None, span: float) -> float | None:
    """Return the share of errors beyond a bound."""
    if bound is None:
        return None
    limit = bound.value * (span / 100.0 if bound.relative else 1.0)
    return float(np.mean(~(errors <= limit))) if len(errors) else 0.0


def certify(
    reader: Reader,
    channels: Sequence[str],
    cells: Cells | None = None,
    bound: ErrorBound | None = None,
    points: int = POINTS,
    seed: int = SEED,
) -> Certificate:
    """Measure what answers for an export; with `false_safe` above 0 it must not be used.

    `cells` are the knots of its table, in whose middles errors are largest; `bound` is the error
    requested, to count the points beyond it; `seed` is one that no fit and no choice has used.
    """
    model, half, worst = reader.model, -(-points // 2), None
    share = min(1.0, points / POINTS)
    count, rounds = (max(LEAST, round(share * most)) for most in (STARTS, ROUNDS))
    # Two at a time that do not depend on each other: what Python does in one waits for no core.
    with ThreadPoolExecutor(1) as pool:
        near = pool.submit(biased, model, half, seed, cells)
        even = reader.measure(uniform(model, half, seed))
        height = attack.largest_jump(model)
        seen = [even, reader.measure(near.result())]
        attacked = pool.submit(attack.worst_false_safe, reader, seen, count, rounds, seed)
        if "sdg" in channels:
            begin = attack.starts(seen, (attack.sdg_error,), count)
            worst = attack.climb(reader, begin, attack.sdg_error, rounds, seed)
        nearest = attacked.result()
    table = {}
    for name in channels:
        every, span = statistics(seen, name), span_of(seen, name)
        if name == "sdg" and worst is not None:
            every["max"] = max(every["max"], float(worst.value.max(initial=0.0)))
        jumps = height > 0.0 and name != "tip_angle"
        table[name] = _entry(every, statistics([even], name), span, jumps)
    searches = [search for search in (worst, nearest) if search is not None]
    witnesses = [*(one.witness() for one in seen), *(search.witness for search in searches)]
    has_sdg, text = "sdg" in channels, tuple[str, ...]()
    beyond = _beyond(even.errors("sdg"), bound, table["sdg"]["range"]) if has_sdg else None
    if height > 0.0 and has_sdg:
        text = tuple(_about_jumps(model.recipe.length_unit, height, beyond, bound))
    return Certificate(
        points=sum(one.sample.points for one in seen),
        standing=sum(int(one.standing.sum()) for one in seen),
        channels=table,
        false_safe=sum(int(one.false_safe.sum()) for one in seen)
        + sum(search.false_safe for search in searches),
        false_tip=even.false_tip,
        jumps=height > 0.0,
        beyond=beyond,
        nearest=-float(nearest.value.max(initial=-np.inf)),
        searched=sum(search.points for search in searches),
        seed=seed,
        text=text,
        witness=next((one for one in witnesses if one is not None), None),
    )


def _about_jumps(
    unit: str, height: float, beyond: float | None, bound: ErrorBound | None
) -> Iterable[str]:
    """Return what people should know beside the numbers."""
    length = "" if unit == "1" else f" {unit}"
    yield (
        f"|SD_g| jumps where the support facet changes (by up to {height:.3g}{length} seen), "
        "so its largest error has no bound: judge by p99."
    )
    if beyond is not None:
        yield (
            f"The requested bound, {bound}, holds for p99; {100.0 * beyond:.2g} % of the standing "
            "configurations are beyond it."
        )


def put_to_test(
    reader: Reader, channels: Sequence[str], bound: ErrorBound | None, points: int, seed: int
) -> Certificate:
    """Compare a trained table with exact answers at `TIMES` as many points, or until one is wrong.

    Then the table is lowered, and other points judge it.
    """
    model, tested, wrong = reader.model, 0, list[tuple[Floats, Floats]]()
    parts = max(1, points * TIMES // (2 * PART))
    size = max(1, points * TIMES // (2 * parts))
    kept: list[dict[str, Floats]] = []
    standing = refused = 0
    for part in range(parts):
        even = reader.measure(uniform(model, size, 1000 * seed + part))
        both = even.standing & even.answers.stands
        kept.append({name: getattr(even.exact, name)[even.standing] for name in channels})
        kept[-1] |= {f"{name} off": even.errors(name) for name in channels}
        said = even.answers.tip_angle[both]
        kept[-1]["tip_angle off"] = np.minimum(even.exact.tip_angle[both], MOST) - said
        standing += int(even.standing.sum())
        refused += int((even.standing & ~even.answers.stands).sum())
        for one in (even, reader.measure(biased(model, size, 1000 * seed + part))):
            at = np.argwhere(one.false_safe)
            wrong.append((one.sample.params[at[:, 0]], one.sample.gravity[at[:, 0], at[:, 1]]))
            tested += one.sample.points
        if any(len(one[0]) for one in wrong):
            break
    every = {name: np.concatenate([one[name] for one in kept]) for name in kept[0]}
    q, g = (np.concatenate(one) for one in zip(*wrong, strict=True))
    table = {}
    for name in channels:
        numbers = numbers_of(every[f"{name} off"], standing > 0)
        tip = name == "tip_angle"
        span = 2.0 * MOST if tip else float(np.ptp(every[name])) if standing else 0.0
        table[name] = _entry(numbers, numbers, span, not tip)
    has_sdg = "sdg" in channels
    return Certificate(
        points=tested,
        standing=standing,
        channels=table,
        false_safe=len(q),
        false_tip=refused / max(standing, 1),
        jumps=len(channels) > 1,
        beyond=_beyond(every["sdg off"], bound, table["sdg"]["range"]) if has_sdg else None,
        seed=seed,
        text=_about_test(every["tip_angle off"], tested),
        witness=(q[0], g[0], 0.0, -math.nan) if len(q) else None,
        wrong=(q, g) if len(q) else None,
    )


def _about_test(lost: Floats, points: int) -> tuple[str, ...]:
    """Return what people should know beside the numbers; `lost` is below 0 above the exact ones."""
    half, most = np.degrees(np.quantile(lost, [0.5, 0.9])) if len(lost) else (0.0, 0.0)
    above = 100.0 * float(np.mean(lost < -1e-9)) if len(lost) else 0.0
    worst = math.degrees(-float(lost.min(initial=0.0)))
    return (
        f"tip_angle: half of the angles are low by less than {half:.2g} deg, 9 of 10 by less than "
        f"{most:.2g} deg, and above 30 deg it says 30; {above:.2g} % are above the exact ones, by "
        f"{worst:.2g} deg at most.",
        f"Tested, not proved: of {points:,} fresh points, half of them beside the boundary, none "
        f"was falsely safe; that excludes a rate above {EXCLUDED / points:.1g}.",
    )

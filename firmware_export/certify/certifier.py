"""The certificate of an export: its errors, and its verdict under attack, measured independently.

The points are none that a fit or a choice has seen.  On them every answer is compared with the
exact model; then the largest error is sought from the worst points, and a point that is called safe
and tips is sought wherever the two come close.  Nothing here knows how a codec works.
"""

import math
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from firmware_export.certify.answers import Measured, Reader, Truth
from firmware_export.certify.jumps import Jumps, find_jumps
from firmware_export.certify.search import (
    Walk,
    climb,
    sdg_error,
    starts,
    witness,
    worst_false_safe,
)
from firmware_export.quantity import ErrorBound
from firmware_export.truth import Cells, biased, uniform
from lutgen.errors import ExportError
from lutgen.vector import Floats

POINTS = 500_000
# Fits and choices use seeds below 1000.
SEED = 1001
# Part of the largest value by which a channel that never changes does so in double precision.
ROUNDED = 1e-9


class Effort(NamedTuple):
    """Points compared, of each half those to climb from and starts for false safes, and rounds.

    At least so many points are compared, half of them uniform and half where tables err most.
    """

    points: int = POINTS
    worst: int = 100
    starts: int = 120
    rounds: int = 40

    @classmethod
    def of(cls, points: int) -> "Effort":
        """Return an effort in proportion to the sample, full for POINTS and above."""
        share = min(1.0, points / POINTS)
        return cls(points, *(max(15, round(share * most)) for most in cls()[1:]))


@dataclass(frozen=True)
class Certificate:
    """What was measured on an export.

    Parameters
    ----------
    points : int
        Points compared, those of the two searches not counted; `standing` of them stand.
    channels : dict
        Per channel ``max`` (absent where |SD_g| jumps: then ``largest_seen``), ``p99``, ``rms`` in
        the channel's unit over all points, ``p99_uniform`` and ``rms_uniform`` over the uniform
        half; also ``range`` and the same in percent of it, ``..._percent``.
    false_safe : int
        Points of the sample and of the search that are called safe and tip.
    false_tip : float
        Share of the standing points of the uniform half that are called tipping.
    jumps : bool
        Whether |SD_g| jumps, so that its error has no bound; see `find_jumps`.
    beyond : float, optional
        Share of the standing uniform points whose |SD_g| error is beyond the bound asked for.
    nearest : float
        rad by which the search failed to find a false safe: the least by which the answer to a
        point that tips was below 0.
    searched : int
        Points that the searches tried.
    witness : tuple, optional
        Parameters, gravity, answered and true tip angle of a false safe.
    wrong : tuple, optional
        Parameters (n, k) and gravity (n, 3) of all that a test found.
    """

    points: int
    standing: int
    channels: dict[str, dict[str, float]]
    false_safe: int
    false_tip: float
    jumps: bool
    beyond: float | None
    nearest: float
    searched: int
    seed: int
    text: tuple[str, ...] = ()
    witness: tuple[Floats, Floats, float, float] | None = field(default=None, compare=False)
    wrong: tuple[Floats, Floats] | None = field(default=None, compare=False)

    def as_dict(self) -> dict[str, Any]:
        """Return what the header and the report print; plain numbers and texts."""
        names = {"nearest": "nearest_false_safe_rad"}
        content = {
            names.get(name, name): value
            for name, value in vars(self).items()
            if name not in ("witness", "wrong")
        }
        return content | {"text": list(self.text)}

    @property
    def bounded(self) -> tuple[str, ...]:
        """The channels that a bound is for."""
        return bounded(self.channels)

    def error_of(self, channel: str, relative: bool) -> float:
        """Return the largest error of a channel, or p99 where |SD_g| jumps.

        In percent of its range, or in its unit.
        """
        name = judged_by(channel, self.jumps)
        return self.channels[channel][f"{name}_percent" if relative else name]

    def error(self, relative: bool) -> float:
        """Return what is compared with a bound."""
        return max(self.error_of(channel, relative) for channel in self.bounded)

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
        raise ExportError(
            f"{label}: the certificate found the robot called safe where it tips (got "
            f"{self.false_safe} points{where}); nothing was written: this is a fault of the "
            "codec's guard, choose another with --codec and report it."
        )


def bounded(channels: Iterable[str]) -> tuple[str, ...]:
    """Return the channels that a bound is for: lengths, or the tip angle where it is alone."""
    return tuple(name for name in channels if name != "tip_angle") or ("tip_angle",)


def judged_by(channel: str, jumps: bool) -> str:
    """Return which of the `statistics` is compared with a bound."""
    return "p99" if jumps and channel != "tip_angle" else "max"


def span_of(seen: Sequence[Measured] | Sequence[Truth], channel: str) -> float:
    """Return the range of a channel over the points that stand; 0 where it changes by rounding."""
    exact = [one.exact for one in seen]
    values = np.concatenate([getattr(one, channel)[one.tip_angle >= 0.0] for one in exact])
    span = float(values.max() - values.min()) if len(values) else 0.0
    return span if span > ROUNDED * float(np.abs(values).max(initial=0.0)) else 0.0


def statistics(seen: Sequence[Measured], channel: str) -> dict[str, float]:
    """Return max, p99 and rms of a channel's errors over points that stand and are said to.

    Infinite for an answer that is no number, and where nothing that stands is said to.
    """
    error = np.concatenate([one.errors(channel) for one in seen])
    if len(error) == 0:
        none = math.inf if any(one.standing.any() for one in seen) else 0.0
        return {"max": none, "p99": none, "rms": none}
    error = np.nan_to_num(error, nan=math.inf, posinf=math.inf)
    return {
        "max": float(error.max()),
        "p99": float(np.quantile(error, 0.99, method="higher")),
        "rms": float(np.sqrt(np.mean(error * error))),
    }


def _channel(name: str, seen: Sequence[Measured], jumps: bool, climbed: float) -> dict[str, float]:
    """Return the entry of a channel, see `Certificate`; seen[0] is the uniform half."""
    entry = statistics(seen, name)
    even = statistics(seen[:1], name)
    entry["max"] = max(entry["max"], climbed)
    entry |= {"p99_uniform": even["p99"], "rms_uniform": even["rms"]}
    span = span_of(seen, name)
    # What never changes has no range to take a percentage of.
    scale = 100.0 / span if span > 0.0 else 0.0
    entry |= {f"{key}_percent": value * scale for key, value in entry.items()}
    entry["range"] = span
    if jumps and name != "tip_angle":
        for key in ("max", "max_percent"):
            entry[key.replace("max", "largest_seen")] = entry.pop(key)
    return entry


def certify(
    reader: Reader,
    channels: Sequence[str],
    cells: Cells | None = None,
    bound: ErrorBound | None = None,
    effort: Effort | None = None,
    seed: int = SEED,
    jumps: Jumps | None = None,
) -> Certificate:
    """Measure an export.

    Parameters
    ----------
    reader : Reader
        What answers.
    channels : sequence of str
        What it holds.
    cells : Cells, optional
        Knots of its table, in whose middles errors are largest.
    bound : ErrorBound, optional
        The largest error asked for, to count the points beyond it.
    effort : Effort, optional
        Points, and what the searches may take.
    seed : int
        Of the points: a number that no fit and no choice has used.
    jumps : Jumps, optional
        What `find_jumps` said, if it was asked before.

    Returns
    -------
    Certificate
        With `false_safe` above 0 the export must not be used: see `refuse_false_safe`.
    """
    model = reader.model
    effort = effort or Effort()
    half = -(-effort.points // 2)
    worst = None
    # Two at a time that do not depend on each other: what Python does in one waits for no core.
    with ThreadPoolExecutor(1) as pool:
        near = pool.submit(biased, model, half, seed, cells)
        even = reader.measure(uniform(model, half, seed))
        found = jumps if jumps is not None else find_jumps(model, seed)
        seen = [even, reader.measure(near.result())]
        attacked = pool.submit(worst_false_safe, reader, seen, effort.starts, effort.rounds, seed)
        if "sdg" in channels:
            begin = starts(seen, (sdg_error,), effort.worst)
            worst = climb(reader, *begin, sdg_error, Walk(effort.rounds, seed))
        attack = attacked.result()
    climbed = float(worst.value.max(initial=0.0)) if worst is not None else 0.0
    table = {
        name: _channel(name, seen, found.found, climbed if name == "sdg" else 0.0)
        for name in channels
    }
    searches = [search for search in (worst, attack) if search is not None]
    wrong = sum(int(one.false_safe.sum()) for one in seen)
    wrong += sum(search.false_safe for search in searches)
    example = next((w for w in (witness(one) for one in seen) if w is not None), None)
    example = example or next((s.witness for s in searches if s.witness is not None), None)
    beyond = None
    if bound is not None and "sdg" in channels:
        limit = bound.value * (table["sdg"]["range"] / 100.0 if bound.relative else 1.0)
        error = even.errors("sdg")
        beyond = float(np.mean(~(error <= limit))) if len(error) else 0.0
    return Certificate(
        points=sum(one.sample.points for one in seen),
        standing=sum(int(one.standing.sum()) for one in seen),
        channels=table,
        false_safe=wrong,
        false_tip=even.false_tip,
        jumps=found.found,
        beyond=beyond,
        nearest=-float(attack.value.max(initial=-np.inf)),
        searched=sum(search.points for search in searches),
        seed=seed,
        text=tuple(_sentences(model.recipe.length_unit, found, table, beyond, bound)),
        witness=example,
    )


def _sentences(
    unit: str,
    jumps: Jumps,
    table: dict[str, dict[str, float]],
    beyond: float | None,
    bound: ErrorBound | None,
) -> list[str]:
    """Return what people should know beside the numbers."""
    if not jumps.found or "sdg" not in table:
        return []
    length = "" if unit == "1" else f" {unit}"
    text = [
        f"|SD_g| jumps where the support facet changes (by up to {jumps.height:.3g}{length} seen), "
        "so its largest error has no bound: judge by p99.",
    ]
    if bound is not None and beyond is not None:
        text.append(
            f"The bound asked for, {bound}, is held to p99; {100.0 * beyond:.2g} % of the standing "
            "configurations are beyond it."
        )
    return text

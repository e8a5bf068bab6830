"""The choice: which codec at which size meets a limit of flash, of error, or of both.

A codec lists its sizes, the smallest first; the smallest is tried, and the others by halves.  Sizes
are measured on a sample that neither the fits nor the certificate use, so that choosing the best of
many does not flatter the certificate.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from firmware_export.certify.answers import (
    Expected,
    Measured,
    device,
    expected,
    span_of,
    statistics,
)
from firmware_export.certify.certificate import bounded, judged_by
from firmware_export.certify.jumps import largest_jump
from firmware_export.emit import code_bytes, flash_bytes
from firmware_export.model import Model, biased, uniform
from firmware_export.protocol import Codec, Export
from firmware_export.quantity import ErrorBound
from lutgen.errors import ExportError, InputError

SEED, POINTS = 501, 15_000
# Percent: the default aim.
KNEE = ErrorBound(1.0, relative=True)
# Share of the stable configurations that an export should report unsafe at most.
MOST_FALSE_TIP = 0.05
# Bytes beyond which no size is tried when flash has no limit.
LARGEST = 1 << 18


@dataclass(frozen=True, eq=False)
class Candidate:
    """An encoded export without certificate, and what the chooser measured on it.

    `total` are the bytes of tables, descriptors and code as far as those are known; `errors`
    (percent of the range) of each length channel the largest, or p99 where |SD_g| jumps, of an
    export of the tip angle alone that of the tip angle; `false_tip` the share of the standing
    uniform points that are called tipping; `false_safe` the points that are called safe and tip.
    """

    export: Export
    total: int
    errors: dict[str, float]
    false_tip: float
    false_safe: int

    @property
    def label(self) -> str:
        """Short text for tables."""
        return str(self.export.tables.spec.label)

    @property
    def error(self) -> float:
        """The greatest of `errors`, percent."""
        return max(self.errors.values())


@dataclass(frozen=True)
class Goal:
    """Limits of an export: most bytes, code included, and greatest error in percent of the range.

    By `margin` the chooser's own measurement must stay below that: the certificate looks at more
    points and searches for the worst.
    """

    flash: int | None
    percent: float | None
    margin: float = 1.3

    @property
    def aim(self) -> float:
        """The error to reach on the chooser's sample, percent."""
        return math.inf if self.percent is None else self.percent / self.margin

    def holds(self, one: Candidate) -> bool:
        """Return True if a candidate is accurate enough."""
        return one.false_safe == 0 and one.error <= self.aim

    def fits(self, one: Candidate) -> bool:
        """Return True if a candidate is small enough."""
        return one.false_safe == 0 and (self.flash is None or one.total <= self.flash)


class Trials:
    """Encodes and measures candidates, each once; `Export` describes its parts."""

    def __init__(self, model: Model, name: str, channels: tuple[str, ...], arithmetic: str) -> None:
        self.model, self.name = model, name
        self.channels, self.arithmetic = channels, arithmetic
        self.tried: dict[tuple[Codec, Any], Candidate | None] = {}
        self.refused: dict[str, str] = {}  # by codec what it said last of a size
        self.bounded = bounded(channels)  # those whose errors count
        self.jump = largest_jump(model, SEED)

    @cached_property
    def sample(self) -> list[Expected]:
        """The sample: uniform points, then biased ones."""
        integer = self.arithmetic == "integer"
        return [
            expected(self.model, points(self.model, POINTS, SEED), integer)
            for points in (uniform, biased)
        ]

    @cached_property
    def ranges(self) -> dict[str, float]:
        """The ranges of the channels that count, over the standing points of the sample."""
        return {channel: span_of(self.sample, channel) for channel in self.bounded}

    def try_out(self, codec: Codec, spec: Any) -> Candidate | None:
        """Return a candidate, None for a size that the codec cannot encode."""
        key = (codec, spec)
        if key not in self.tried:
            self.tried[key] = None
            try:
                made = codec.export(self.model, self.name, self.channels, self.arithmetic, spec)
                self.tried[key] = self._assessed(made)
            except InputError as error:
                self.refused[codec.name] = str(error)
        return self.tried[key]

    def _assessed(self, export: Export) -> Candidate:
        """Measure an export: its bytes, with descriptors and code, and its answers."""
        reader = device(export)
        seen = [reader.compare(known) for known in self.sample]
        # The certificate lowers tested tables until it finds none.
        wrong = 0 if export.tables.tested else sum(int(one.false_safe.sum()) for one in seen)
        return Candidate(
            export,
            int(flash_bytes(export)["total"]),
            {channel: self._error(seen, channel) for channel in self.bounded},
            seen[0].false_tip,
            wrong,
        )

    def _error(self, seen: list[Measured], channel: str) -> float:
        found = statistics(seen, channel)[judged_by(channel, self.jump > 0.0)]
        span = self.ranges[channel]
        return 100.0 * found / span if span > 0.0 else 0.0


def choose(trials: Trials, codecs: Sequence[Codec], goal: Goal) -> Candidate:
    """Return the best candidate of some codecs; ExportError says what comes nearest to the goal.

    With a percentage in the goal the smallest that is accurate enough; without it the most accurate
    that fits.  Candidates that report at most MOST_FALSE_TIP of what is stable as unsafe
    go before others.
    """
    good: list[Candidate] = []
    for codec in codecs:
        try_sizes(trials, codec, goal)
        tried = [one for (own, _), one in trials.tried.items() if one and own in codecs]
        good = [one for one in tried if goal.holds(one) and goal.fits(one)]
        if good and codec.exact(trials.model):
            break
    if not good:
        raise _refusal(trials, tried, goal)
    generous = [one for one in good if one.false_tip <= MOST_FALSE_TIP]
    if not generous:
        return min(good, key=lambda one: (one.false_tip, one.total, one.label))
    if goal.percent is None:
        return min(generous, key=lambda one: (one.error, one.total, one.label))
    return min(generous, key=lambda one: (one.total, one.error, one.label))


def try_sizes(trials: Trials, codec: Codec, goal: Goal) -> None:
    """Try the smallest size, then by halves look for the one from which on the goal is met.

    With a percentage that is the first that is accurate enough; else the last that fits.
    """
    ceiling = goal.flash if goal.flash is not None else LARGEST
    most = ceiling - code_bytes(codec.families[trials.arithmetic])
    sizes = codec.sizes(trials.model, trials.channels, most)

    def larger(spec: Any) -> bool:
        """Return True if sizes beyond this one are of use."""
        one = trials.try_out(codec, spec)
        if one is None or one.total > ceiling:
            return False
        served = goal.percent is not None and goal.holds(one) and one.false_tip <= MOST_FALSE_TIP
        return not served

    if not sizes or not larger(sizes[0]):
        return
    low, high = 1, len(sizes)
    while low < high:
        middle = (low + high) // 2
        low, high = (middle + 1, high) if larger(sizes[middle]) else (low, middle)


def _refusal(trials: Trials, tried: list[Candidate], goal: Goal) -> ExportError:
    """Return the error that says what comes nearest to a goal that nothing meets."""
    where = trials.model.recipe.source
    faults = [one for one in tried if one.false_safe]
    usable = [one for one in tried if one.false_safe == 0 and math.isfinite(one.error)]
    if faults and not usable:
        return ExportError(
            f"{where}: every candidate calls some point safe where the robot tips (got "
            f"{faults[0].false_safe} points for {faults[0].label}); this is a fault of the codec's "
            "guard: choose another with --codec and report it."
        )
    if not usable:
        said = [
            f"{name}: {reason.removeprefix(f'{where}: ')}"
            for name, reason in trials.refused.items()
        ]
        got = "; ".join(said).rstrip(".") or f"{len(tried)} candidates without an answer"
        return ExportError(
            f"{where}: no codec could encode the robot (got {got}); choose another codec."
        )
    limits, nearest = [], []
    if goal.flash is not None:
        limits.append(f"{goal.flash:,} bytes of flash")
    if goal.percent is not None:
        limits.append(f"an error of {goal.percent:.3g} % of the range")
    fitting = [one for one in usable if goal.fits(one)]
    if fitting:
        one = min(fitting, key=lambda one: one.error)
        estimate = one.error * goal.margin
        nearest.append(f"{estimate:.3g} % in {one.total:,} bytes ({one.label})")
    else:
        one = min(usable, key=lambda one: one.total)
        nearest.append(f"{one.total:,} bytes is the smallest there is ({one.label})")
    accurate = [one for one in usable if goal.holds(one)]
    if goal.percent is not None and accurate:
        one = min(accurate, key=lambda one: one.total)
        nearest.append(f"{one.total:,} bytes are needed for that error ({one.label})")
    return ExportError(
        f"{where}: no export meets the request (got {' and '.join(limits)}); the nearest that "
        f"can be had: {'; '.join(nearest)}."
    )

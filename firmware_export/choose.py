"""The choice: which codec at which size meets a limit of flash, of error, or of both.

A codec lists its sizes, the smallest first; the smallest is tried, and the others by halves.  Each
that is tried gets a short certificate, of points that neither the fits nor the final one use, so
that choosing the best of many does not flatter that.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

from firmware_export.certify import certificate
from firmware_export.certify.answers import device
from firmware_export.certify.certificate import Certificate, certify, put_to_test
from firmware_export.emit import family_row, flash_bytes
from firmware_export.model import Model
from firmware_export.protocol import Codec, Export
from firmware_export.quantity import ErrorBound
from lutgen.errors import ExportError, InputError, reject

SEED, POINTS = 501, 30_000
# Percent: the default aim.
KNEE = ErrorBound(1.0, relative=True)
# Share of the stable configurations that an export should report unsafe at most.
MOST_FALSE_TIP = 0.05
# Bytes beyond which no size is tried when flash has no limit.
LARGEST = 1 << 18


@dataclass(frozen=True, eq=False)
class Candidate:
    """An encoded export, its bytes of tables, descriptors and code, and a short certificate."""

    export: Export
    total: int
    certificate: Certificate

    @property
    def label(self) -> str:
        """Short text for tables."""
        return str(self.export.tables.spec.label)

    @property
    def false_tip(self) -> float:
        """Share of what stands that is called tipping."""
        return self.certificate.false_tip


@dataclass(frozen=True)
class Goal:
    """Limits of an export: most bytes, code included, and greatest error.

    By `margin` the error of a short certificate must stay below that: the final one looks at more
    points.
    """

    flash: int | None
    bound: ErrorBound | None
    margin: float = 1.1

    def error(self, one: Candidate) -> float:
        """Return the error of a candidate as the bound has it."""
        return one.certificate.error(self.bound is None or self.bound.relative)

    def holds(self, one: Candidate) -> bool:
        """Return True if a candidate is accurate enough."""
        return self.bound is None or self.error(one) <= self.bound.value / self.margin

    def fits(self, one: Candidate) -> bool:
        """Return True if a candidate is small enough."""
        return self.flash is None or one.total <= self.flash


class Trials:
    """Encodes and measures candidates, each once; `Export` describes its parts."""

    def __init__(self, model: Model, name: str, channels: tuple[str, ...], arithmetic: str) -> None:
        self.model, self.name = model, name
        self.channels, self.arithmetic = channels, arithmetic
        self.tried: dict[tuple[Codec, Any], Candidate | None] = {}
        self.refused: dict[str, str] = {}  # by codec what it said last of a size

    def try_out(self, codec: Codec, spec: Any) -> Candidate | None:
        """Return a candidate, None for a size that the codec cannot encode."""
        key = (codec, spec)
        if key not in self.tried:
            self.tried[key] = None
            try:
                made = codec.export(self.model, self.name, self.channels, self.arithmetic, spec)
                measured = examine(made, None, POINTS, SEED)
                self.tried[key] = Candidate(made, int(flash_bytes(made)["total"]), measured)
            except InputError as error:
                self.refused[codec.name] = str(error)
        return self.tried[key]


def examine(
    export: Export, bound: ErrorBound | None, points: int, seed: int = certificate.SEED
) -> Certificate:
    """Certify one export."""
    reader = device(export)
    if export.tables.tested:
        return put_to_test(reader, export.channels, bound, points, seed)
    cells = export.tables.cells(export.model)
    return certify(reader, export.channels, cells, bound, points, seed)


def choose(trials: Trials, codecs: Sequence[Codec], goal: Goal) -> Candidate:
    """Return the best candidate of the first codec that meets a goal.

    With a bound in the goal the smallest that is accurate enough; without it the most accurate
    that fits.  Those that report at most MOST_FALSE_TIP of what is stable as unsafe go before
    others.  ExportError says what of all codecs comes nearest to the goal.
    """
    good: list[Candidate] = []
    for codec in codecs:
        try_sizes(trials, codec, goal)
        tried = [one for (own, _), one in trials.tried.items() if one and own in codecs]
        good = [one for one in tried if goal.holds(one) and goal.fits(one)]
        if good:
            break
    if not good:
        _refuse(trials, tried, goal)
    generous = [one for one in good if one.false_tip <= MOST_FALSE_TIP]
    if not generous:
        return min(good, key=lambda one: (one.false_tip, one.total, one.label))
    if goal.bound is None:
        return min(generous, key=lambda one: (goal.error(one), one.total, one.label))
    return min(generous, key=lambda one: (one.total, goal.error(one), one.label))


def try_sizes(trials: Trials, codec: Codec, goal: Goal) -> None:
    """Try the smallest size, then by halves look for the one from which on the goal is met.

    With a bound that is the first that is accurate enough; else the last that fits.
    """
    ceiling = goal.flash if goal.flash is not None else LARGEST
    # Only a trained table asks how many bytes it may have.
    sizes = codec.sizes(trials.model, trials.channels, ceiling - family_row("grid", {})["code"])

    def larger(spec: Any) -> bool:
        """Return True if sizes beyond this one are of use."""
        one = trials.try_out(codec, spec)
        if one is None or one.total > ceiling:
            return False
        served = goal.bound is not None and goal.holds(one) and one.false_tip <= MOST_FALSE_TIP
        return not served

    if not sizes or not larger(sizes[0]):
        return
    low, high = 1, len(sizes)
    while low < high:
        middle = (low + high) // 2
        low, high = (middle + 1, high) if larger(sizes[middle]) else (low, middle)


def _refuse(trials: Trials, tried: list[Candidate], goal: Goal) -> NoReturn:
    """Say what comes nearest to a goal that nothing meets."""
    where = trials.model.recipe.source
    usable = [one for one in tried if math.isfinite(goal.error(one))]
    if not usable:
        said = [
            f"{name}: {reason.removeprefix(f'{where}: ')}"
            for name, reason in trials.refused.items()
        ]
        got = "; ".join(said).rstrip(".") or f"{len(tried)} candidates without an answer"
        reject(where, "no codec could encode the robot", got, "choose another codec", ExportError)
    limits, nearest = [], []
    if goal.flash is not None:
        limits.append(f"{goal.flash:,} bytes of flash")
    unit = " %" if goal.bound is None or goal.bound.relative else ""
    if goal.bound is not None:
        limits.append(f"an error of {goal.bound}{' of the range' if unit else ''}")
    fitting = [one for one in usable if goal.fits(one)]
    if fitting:
        one = min(fitting, key=goal.error)
        estimate = goal.error(one) * goal.margin
        nearest.append(f"{estimate:.3g}{unit} in {one.total:,} bytes ({one.label})")
    else:
        one = min(usable, key=lambda one: one.total)
        nearest.append(f"{one.total:,} bytes is the smallest there is ({one.label})")
    accurate = [one for one in usable if goal.holds(one)]
    if goal.bound is not None and accurate:
        one = min(accurate, key=lambda one: one.total)
        nearest.append(f"{one.total:,} bytes are needed for that error ({one.label})")
    way_out = f"the nearest that can be had: {'; '.join(nearest)}"
    reject(where, "no export meets the request", " and ".join(limits), way_out, ExportError)

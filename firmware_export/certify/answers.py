"""Query an export at given points, beside the exact answers.

Points become queries of the target: single precision, or the integers of
smap_read_i.  Exact answers are computed at the query itself, so that rounding a point is no error.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_export.host import FULL_SCALE, STANDS, Host, in_units
from firmware_export.model import Exact, Model, Sample
from firmware_export.protocol import Export, describe
from lutgen.arrays import Bools, Floats
from lutgen.errors import ExportError

# Part of the largest value by which a channel that never changes does so in double precision.
ROUNDED = 1e-9

# Parameters, gravity, answered and true tip angle of a false safe.
Witness = tuple[Floats, Floats, float, float]
# (n, k) and (n, 3) queries -> status (n,), reading (n, 3): sdg, tip_angle, height.
Read = Callable[[NDArray[Any], NDArray[Any]], tuple[NDArray[Any], NDArray[Any]]]


class Answers(NamedTuple):
    """Answers to m postures under d directions, each (m, d).

    `stands`: the verdict.  `sdg` and `height` (length unit, NaN where not held) and `tip_angle`
    (rad, guard subtracted; negative where the robot is said to tip).
    """

    stands: Bools
    sdg: Floats
    tip_angle: Floats
    height: Floats


class Measured(NamedTuple):
    """What the queries of a sample stand for (rad or length), the answers and the exact ones."""

    sample: Sample
    answers: Answers
    exact: Exact

    @property
    def false_safe(self) -> Bools:
        """Points (m, d) that are said to stand where the robot tips."""
        return np.asarray(self.answers.stands & (self.exact.tip_angle < 0.0))

    @property
    def standing(self) -> Bools:
        """Points (m, d) where the robot stands."""
        return np.asarray(self.exact.tip_angle >= 0.0)

    @property
    def false_tip(self) -> float:
        """Share of the standing points that are said to tip."""
        standing = self.standing
        return int((standing & ~self.answers.stands).sum()) / max(int(standing.sum()), 1)

    def witness(self) -> Witness | None:
        """Return the false safe that is answered most safely, if any."""
        if not self.false_safe.any():
            return None
        said = np.where(self.false_safe, self.answers.tip_angle, -np.inf)
        m, d = np.unravel_index(int(said.argmax()), said.shape)
        params, gravity = self.sample.params[m], self.sample.gravity[m, d]
        return params, gravity, float(said[m, d]), float(self.exact.tip_angle[m, d])

    def errors(self, channel: str) -> Floats:
        """Return the errors (n,) of a channel where the robot stands and is said to."""
        counts = self.standing & self.answers.stands
        return np.asarray(
            np.abs(getattr(self.answers, channel)[counts] - getattr(self.exact, channel)[counts])
        )


class Reader:
    """Anything that answers queries about a model's robot, in floats or, with `steps`, in integers.

    `steps` has the value of one step of the integer channels sdg and height.
    """

    def __init__(self, model: Model, read: Read, steps: dict[str, float] | None = None) -> None:
        self.model, self.read, self.steps = model, read, steps

    def measure(self, sample: Sample) -> Measured:
        """Query the points of a sample, and compute the exact answers to these queries."""
        params: NDArray[Any]
        if self.steps is None:
            params, gravity = (one.astype(np.float32) for one in sample)
            near = Sample(params.astype(np.float64), gravity.astype(np.float64))
        else:
            low, high = self.model.lower, self.model.upper
            share = (sample.params - low) / (high - low)
            params = np.rint(share * FULL_SCALE).astype(np.int16)
            gravity = np.rint(sample.gravity * FULL_SCALE).astype(np.int16)
            near = Sample(self.model.at(params / FULL_SCALE), gravity.astype(np.float64))
        m, d = gravity.shape[:2]
        status, reading = self.read(np.repeat(params, d, axis=0), gravity.reshape(-1, 3))
        values = reading.astype(np.float64) if self.steps is None else in_units(reading, self.steps)
        answers = Answers(np.isin(status, STANDS).reshape(m, d), *values.T.reshape(3, m, d))
        return Measured(near, answers, self.model.exact(*near))


def device(export: Export) -> Reader:
    """Return what answers as the microcontroller will: the C that ships, with these tables."""
    host = Host(describe(export))
    if host.check() != 0:
        raise ExportError(f"{export.name}: its tables are not what smap_check demands; report it.")
    if export.integer:
        return Reader(export.model, host.read_i, export.body.steps)
    return Reader(export.model, host.read)


def span_of(seen: Sequence[Measured], channel: str) -> float:
    """Return the range of a channel over the points that stand; 0 where it changes by rounding."""
    exact = [one.exact for one in seen]
    values = np.concatenate([getattr(one, channel)[one.tip_angle >= 0.0] for one in exact])
    span = float(values.max() - values.min()) if len(values) else 0.0
    return span if span > ROUNDED * float(np.abs(values).max(initial=0.0)) else 0.0


def numbers_of(error: Floats, stands: bool) -> dict[str, float]:
    """Return max, p99 and rms of errors; of none infinite where anything stands."""
    if len(error) == 0:
        return dict.fromkeys(("max", "p99", "rms"), math.inf if stands else 0.0)
    error = np.nan_to_num(np.abs(error), nan=math.inf, posinf=math.inf)
    return {
        "max": float(error.max()),
        "p99": float(np.quantile(error, 0.99, method="higher")),
        "rms": float(np.sqrt(np.mean(error * error))),
    }


def statistics(seen: Sequence[Measured], channel: str) -> dict[str, float]:
    """Return max, p99 and rms of a channel's errors over points that stand and are said to.

    Infinite for an answer that is no number, and where nothing that stands is said to.
    """
    error = np.concatenate([one.errors(channel) for one in seen])
    return numbers_of(error, any(one.standing.any() for one in seen))

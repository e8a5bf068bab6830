"""The choice: which codec at which size meets a limit of flash, of error, or of both.

Each codec's sizes are grown from the smallest, one axis at a time, always where accuracy gains
most for a byte; a codec that takes minutes names the one to try.  All that was tried is kept: it is
the table that the choice is made from.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from firmware_export.choose.goal import MOST_FALSE_TIP, Goal
from firmware_export.choose.trials import Candidate, Trials
from firmware_export.emit import code_bytes
from firmware_export.protocol import CodecInfo
from lutgen.errors import ExportError

# Bytes beyond which no size is tried when flash has no limit.
LARGEST = 1 << 18
# How much steeper than so far the error may fall from here on.
OPTIMISM = 2.0
# Sizes that are grown at once while the goal is far.
MOST_STEPS = 4


def choose(trials: Trials, codecs: Sequence[CodecInfo], goal: Goal) -> Candidate:
    """Return the best candidate of some codecs.

    With a percentage in the goal the smallest that is accurate enough; without it the most accurate
    that fits.  Of each kind one that reports at most MOST_FALSE_TIP of what is stable as unsafe
    goes before others.

    Raises
    ------
    ExportError
        If nothing meets the goal; the message says what comes nearest.
    """
    for codec in codecs:
        try_codec(trials, codec, goal)
        if codec.exact(trials.model) and any(
            one and own is codec and goal.holds(one) and goal.fits(one)
            for (own, _), one in trials.tried.items()
        ):
            break
    tried = [one for (codec, _), one in trials.tried.items() if one and codec in codecs]
    good = [one for one in tried if goal.holds(one) and goal.fits(one)]
    if not good:
        raise _refusal(trials, tried, goal)
    generous = [one for one in good if one.false_tip <= MOST_FALSE_TIP]
    if not generous:
        return min(good, key=lambda one: (one.false_tip, one.total, one.label))
    if goal.percent is None:
        return min(generous, key=lambda one: (one.error, one.total, one.label))
    return min(generous, key=lambda one: (one.total, one.error, one.label))


def front(trials: Trials, chosen: Candidate) -> list[dict[str, Any]]:
    """Return the rows of the table of candidates: of each codec those that none of it beats."""
    rows = []
    for one in trials.candidates:
        if not math.isfinite(one.error):
            continue
        beaten = any(
            o.total <= one.total
            and o.error <= one.error
            and (o.total, o.error) != (one.total, one.error)
            for o in trials.candidates
            if o.export.codec == one.export.codec
        )
        # Its guard may be another since, see `exporter.guarded`.
        is_chosen = (one.export.codec, one.label) == (chosen.export.codec, chosen.label)
        if is_chosen or not beaten:
            rows.append(one.row(is_chosen))
    return sorted(rows, key=lambda row: (row["total_bytes"], row["error"], row["label"]))


def try_codec(trials: Trials, codec: CodecInfo, goal: Goal) -> None:
    """Try the sizes of a codec, each bit width in turn, until they meet the goal or cannot."""
    if codec.size is not None:
        ceiling = _ceiling(trials, goal)
        most = min(ceiling, goal.flash or ceiling) - code_bytes(codec.families["integer"])
        percent = None if goal.percent is None else goal.aim
        trials.try_out(codec, codec.size(trials.model, trials.channels, most, percent))
        return
    path: list[Candidate] = []
    for spec in codec.sizes(trials.model, trials.channels, trials.arithmetic):
        if path:
            # Wider codes are worth trying only where narrow ones come to an end: from where the
            # rounding of those began to count.
            if goal.percent is not None and any(
                one and own is codec and goal.serves(one) for (own, _), one in trials.tried.items()
            ):
                return
            least = min(goal.score(one) for one in path)
            knee = next(one for one in path if goal.score(one) <= 2.0 * least)
            spec = replace(knee.export.tables.spec, bits=spec.bits)
        path = grow_sizes(trials, codec, spec, goal) or path


def _ceiling(trials: Trials, goal: Goal) -> int:
    """Return the bytes beyond which a candidate is of no use."""
    if goal.percent is None:
        return goal.flash if goal.flash is not None else LARGEST
    found = [one.total for one in trials.candidates if goal.serves(one)]
    return min(found, default=LARGEST)


def grow_sizes(trials: Trials, codec: CodecInfo, spec: Any, goal: Goal) -> list[Candidate]:
    """Grow from one size; return the candidates on the way."""
    ceiling = _ceiling(trials, goal)
    if codec.bytes is not None:
        code = code_bytes(codec.families[trials.arithmetic])
        # What has been found is smaller than this can be; a refusal names the smallest there is.
        if codec.bytes(spec) + code > ceiling and trials.candidates:
            return []
    now = trials.try_out(codec, spec)
    if now is None:
        return []
    path, best, idle = [now], now, 0
    gains: list[float] = []
    budget, leap, fine = codec.encodings, 1, False
    while idle < codec.patience and budget > 0:
        if goal.percent is not None and goal.score(now) <= 1.0 and goal.holds(now):
            if leap == 1 or fine:
                break
            # A leap went past the smallest that will do: from before it step by step.
            now, fine = path[-2], True
        if now.total > ceiling or _hopeless(path, goal, ceiling, trials):
            break
        leap = 1 if fine else _leap(goal.score(now))
        options = _larger(trials, codec, now.export.tables.spec, leap)
        if not options:
            break
        if math.isinf(goal.score(now)):
            # Nothing is answered yet, so nothing can be compared: the largest step.
            options, gains = options[-1:], []
        step, gains, spent = _step(trials, codec, now, options, gains, goal, ceiling)
        budget -= max(spent, 1)
        if step is None:
            break
        now = step
        path.append(now)
        if math.isfinite(goal.score(now)):
            # Small steps may add up: they are compared with the last that was large enough.
            idle += 1
            if goal.score(now) < codec.gain * goal.score(best):
                best, idle = now, 0
    return path


def _leap(score: float) -> int:
    """Return how many sizes to grow at once: errors fall with the square of the nodes."""
    return MOST_STEPS if math.isinf(score) else max(1, min(MOST_STEPS, int(math.log2(score) / 2.0)))


def _larger(trials: Trials, codec: CodecInfo, spec: Any, leap: int) -> list[Any]:
    """Return the larger sizes: each of the codec's ways to grow, `leap` times over."""
    grow, result = codec.grow, []
    for way in range(len(grow(trials.model, spec))):
        grown = spec
        for _ in range(leap):
            ways = grow(trials.model, grown)
            if way >= len(ways):
                break
            grown = ways[way]
        result.append(grown)
    return result


def _step(
    trials: Trials,
    codec: CodecInfo,
    now: Candidate,
    options: list[Any],
    gains: list[float],
    goal: Goal,
    ceiling: int,
) -> tuple[Candidate | None, list[float], int]:
    """Return the option that gains most for a byte, the gains known now, and encodings spent.

    Lazily: the gains of the step before are upper bounds as good as any, so the option that was
    best then is encoded first, and taken if it is still better than the others were.
    """
    fresh: dict[int, Candidate | None] = {}
    known = list(gains) if len(gains) == len(options) else [math.inf] * len(options)
    spent = 0
    while True:
        at = max(range(len(options)), key=lambda i: (known[i], -i))
        if at in fresh:
            break
        spent += (codec, options[at]) not in trials.tried
        fresh[at] = trials.try_out(codec, options[at])
        known[at] = _gain(now, fresh[at], goal, ceiling)
    step = fresh[at] if known[at] > -math.inf else None
    return step, known, spent


def _gain(now: Candidate, then: Candidate | None, goal: Goal, ceiling: int) -> float:
    """Return the fall of the score's logarithm for a byte; -inf for what cannot be taken."""
    if then is None or then.total > ceiling:
        return -math.inf
    before, after = goal.score(now), goal.score(then)
    if not math.isfinite(after):
        return 0.0 if not math.isfinite(before) else -math.inf
    if not math.isfinite(before):
        return 1e9
    fall = math.log(max(before, 1e-12)) - math.log(max(after, 1e-12))
    return fall / max(then.total - now.total, 1)


def _hopeless(path: list[Candidate], goal: Goal, ceiling: int, trials: Trials) -> bool:
    """Whether even a far steeper fall of the error than of late would come too late."""
    first, now = path[max(0, len(path) - 4)], path[-1]
    if len(path) < 5 or not (math.isfinite(goal.score(first)) and now.bytes > first.bytes):
        return False
    fall = math.log(max(goal.score(first), 1e-12) / max(goal.score(now), 1e-12))
    power = OPTIMISM * max(fall, 0.0) / math.log(now.bytes / first.bytes)
    room = max(ceiling - (now.total - now.bytes), now.bytes)
    reach = float(goal.score(now) * (now.bytes / room) ** power)
    if goal.percent is not None:
        return reach > 1.0
    rivals = (one for one in trials.candidates if goal.fits(one))
    return reach > min((goal.score(one) for one in rivals), default=math.inf)


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
            f"{where}: no codec could encode the robot (got {got}); ask for another codec."
        )
    asked = []
    if goal.flash is not None:
        asked.append(f"{goal.flash:,} bytes of flash")
    if goal.percent is not None:
        asked.append(f"an error of {goal.percent:.3g} % of the range")
    nearest = []
    fitting = [one for one in usable if goal.fits(one)]
    smallest = min(usable, key=lambda one: one.total)
    if fitting:
        one = min(fitting, key=lambda one: one.error)
        estimate = one.error * goal.margin
        nearest.append(f"{estimate:.3g} % in {one.total:,} bytes ({one.label})")
    else:
        nearest.append(f"{smallest.total:,} bytes is the smallest there is ({smallest.label})")
    accurate = [one for one in usable if goal.holds(one)]
    if goal.percent is not None and accurate:
        one = min(accurate, key=lambda one: one.total)
        nearest.append(f"{one.total:,} bytes are needed for that error ({one.label})")
    return ExportError(
        f"{where}: no export meets what is asked for (got {' and '.join(asked)}); the nearest that "
        f"can be had: {'; '.join(nearest)}."
    )

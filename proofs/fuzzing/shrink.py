"""The smallest input that still shows a fault: lines, then characters, then words left out."""

import dataclasses
import time
from collections.abc import Callable, Sequence
from typing import Any

from proofs.fuzzing.case import Case

__all__ = ["shrunk"]

# Seconds and runs that one fault is worth.
SECONDS = 40.0
RUNS = 400


def shrunk(case: Case, shows: Callable[[Case], bool]) -> Case:
    """Return a case with less in it for which `shows` still holds.

    Files that are no text are only left out as a whole.
    """
    stop = time.monotonic() + SECONDS
    left = [RUNS]

    def holds(tried: Case) -> bool:
        left[0] -= 1
        return left[0] > 0 and time.monotonic() < stop and shows(tried)

    for name in list(case.files):
        without = {key: value for key, value in case.files.items() if key != name}
        if holds(fewer := dataclasses.replace(case, files=without)):
            case = fewer
    for name, data in list(case.files.items()):
        if _is_text(data):
            case = _file(case, name, holds)
    words = _parts(case.words[1:], lambda kept: holds(_with_words(case, kept)))
    return _with_words(case, words)


def _file(case: Case, name: str, holds: Callable[[Case], bool]) -> Case:
    def with_text(parts: Sequence[bytes]) -> Case:
        return dataclasses.replace(case, files={**case.files, name: b"".join(parts)})

    lines = case.files[name].splitlines(keepends=True)
    lines = _parts(lines, lambda kept: holds(with_text(kept)))
    text = b"".join(lines)
    if len(text) < 4000:
        pieces = [text[i : i + 1] for i in range(len(text))]
        text = b"".join(_parts(pieces, lambda kept: holds(with_text(kept))))
    return with_text([text])


def _with_words(case: Case, words: Sequence[str]) -> Case:
    return dataclasses.replace(case, words=(*case.words[:1], *words))


def _parts(parts: Sequence[Any], holds: Callable[[list[Any]], bool]) -> list[Any]:
    """Leave out runs of parts, long ones first, while it still holds."""
    kept = list(parts)
    span = max(len(kept) // 2, 1)
    while kept:
        at = 0
        while at < len(kept):
            fewer = kept[:at] + kept[at + span :]
            if holds(fewer):
                kept = fewer
            else:
                at += span
        if span == 1:
            break
        span //= 2
    return kept


def _is_text(data: bytes) -> bool:
    try:
        data.decode("utf-8")
    except UnicodeDecodeError:
        return False
    return b"\x00" not in data[:200]

"""Halve brackets around the place where something begins, for many places at once."""

from collections.abc import Callable

import numpy as np

from lutgen.arrays import Bools, Floats


def halve(
    happens: Callable[[Floats], Bools], before: Floats, after: Floats, times: int
) -> tuple[Floats, Floats]:
    """Return brackets (n,) that are 2^times narrower.

    It does not happen at the places `before` (n,), and does at those `after`.

    Examples
    --------
    >>> before, after = halve(lambda x: x * x > 2.0, np.array([1.0]), np.array([2.0]), 40)
    >>> before.round(9).tolist()
    [1.414213562]
    """
    for _ in range(times):
        middle = (before + after) / 2.0
        found = happens(middle)
        before, after = np.where(found, before, middle), np.where(found, middle, after)
    return before, after

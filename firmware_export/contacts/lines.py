"""Find kinks and jumps along one parameter in the positions of a robot that is given by code.

Nothing is known of the function but its values, so the search is by samples on lines.
"""

from collections.abc import Callable

import numpy as np

from lutgen.vector import Floats

# (n, l) places of l lines -> (n, l, c) coordinates.
Line = Callable[[Floats], Floats]

# Places at which a stretch of a line is looked at, and how often it is made as much shorter.
PLACES, ZOOMS, JUMP_ZOOMS = 65, 6, 8
# A kink keeps its change of slope, what is smooth loses it: least share that is kept.
KEPT = 0.02
# Parts of a stretch within which kinks of several lines are at one place, and away from its ends.
SAME = 1e-6


def _closer(begin: Floats, width: float, line: Line) -> tuple[Floats, Floats]:
    """Return the places (n, l) on stretches of a width, and the coordinates there."""
    x = begin + width * np.linspace(0.0, 1.0, PLACES)[:, None]
    return x, line(x)


def find_jump(low: float, high: float, lines: int, line: Line) -> tuple[float, float]:
    """Return by how much a coordinate jumps between two places, and where.

    The stretch over which it changes most is made shorter and shorter; what is continuous
    changes by less and less, at last by next to nothing.
    """
    begin, width = np.full(lines, low), high - low
    change = np.zeros((1, lines))
    for _ in range(JUMP_ZOOMS):
        x, value = _closer(begin, width, line)
        change = np.abs(np.diff(value, axis=0)).max(axis=2)
        at = change.argmax(axis=0)
        begin = x[at, np.arange(lines)]
        width /= PLACES - 1
    most = int(change.max(axis=0).argmax())
    return float(change[:, most].max()), float(begin[most])


def find_break(low: float, high: float, lines: int, line: Line) -> float:
    """Return where to cut a stretch: at a kink that all lines have at one place, or in the middle.

    Parameters
    ----------
    low, high : float
        Ends of the stretch.
    lines : int
        How many lines there are.
    line : callable
        Coordinates at places of the lines.

    Returns
    -------
    float
        Between the ends.
    """
    begin, width = np.full(lines, low), high - low
    first = bend = np.zeros(lines)
    for zoom in range(ZOOMS):
        x, value = _closer(begin, width, line)
        second = np.abs(value[:-2] - 2.0 * value[1:-1] + value[2:]).max(axis=2)
        at = second.argmax(axis=0)
        bend = second[at, np.arange(lines)] / width
        first = bend if zoom == 0 else first
        begin = x[at, np.arange(lines)]
        width *= 2.0 / (PLACES - 1)
    kinked = (bend > KEPT * first) & (bend > KEPT * bend.max())
    place = begin + 0.5 * width
    middle = 0.5 * (low + high)
    if not kinked.any():
        return middle
    found = float(np.median(place[kinked]))
    near = SAME * (high - low)
    alike = bool(np.all(np.abs(place[kinked] - found) < near))
    return found if alike and low + near < found < high - near else middle

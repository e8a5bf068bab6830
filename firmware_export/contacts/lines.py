"""Find kinks and jumps along one parameter in the positions of a robot that is given by code.

Nothing is known of the function but its values, so the search is by samples on lines.
"""

from collections.abc import Callable

import numpy as np

from lutgen.vector import Floats

# (n, l) places of l lines, or (n, 1) of all -> (n, l, c) coordinates.
Line = Callable[[Floats], Floats]

# Places at which a stretch of a line is looked at, and how often it is made as much shorter.
PLACES, ZOOMS, JUMP_ZOOMS = 65, 6, 8
# A kink keeps its change of slope, what is smooth loses it: least share that is kept.
KEPT = 0.02
# Parts of a stretch within which kinks of several lines are at one place, and away from its ends.
SAME = 1e-6


def _zoom(
    low: float, width: float, line: Line, order: int, times: int
) -> tuple[Floats, float, list[Floats]]:
    """Make the stretch of each line on which differences of an order are largest shorter.

    Returns where the last ones begin (l,), their width, and the largest (l,) of each time.
    """
    begin, most = np.full(1, low), list[Floats]()
    for _ in range(times):
        x = begin + width * np.linspace(0.0, 1.0, PLACES)[:, None]
        change = np.abs(np.diff(line(x), order, axis=0)).max(axis=2)
        at = change.argmax(axis=0)
        begin = np.take_along_axis(np.broadcast_to(x, (PLACES, len(at))), at[None], axis=0)[0]
        most.append(change.max(axis=0))
        width *= order / (PLACES - 1)
    return begin, width, most


def find_jump(low: float, high: float, line: Line) -> tuple[float, float]:
    """Return by how much a coordinate jumps between two places, and where.

    What is continuous changes by less and less on shorter stretches, at last by nearly nothing.
    """
    begin, _, change = _zoom(low, high - low, line, 1, JUMP_ZOOMS)
    most = int(change[-1].argmax())
    return float(change[-1][most]), float(begin[most])


def find_break(low: float, high: float, line: Line) -> float:
    """Return where to cut a stretch: at a kink that all lines have at one place, or in the middle.

    `line` gives coordinates at places of the lines between both ends.
    """
    begin, width, change = _zoom(low, high - low, line, 2, ZOOMS)
    # The second difference at a kink grows with the stretch, elsewhere with its square.
    bend, first = change[-1] * (0.5 * (PLACES - 1)) ** (ZOOMS - 1), change[0]
    kinked = (bend > KEPT * first) & (bend > KEPT * bend.max())
    place = begin + 0.5 * width
    middle = 0.5 * (low + high)
    if not kinked.any():
        return middle
    found = float(np.median(place[kinked]))
    near = SAME * (high - low)
    alike = bool(np.all(np.abs(place[kinked] - found) < near))
    return found if alike and low + near < found < high - near else middle

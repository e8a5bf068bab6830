"""Positions of a robot that is given by code as Chebyshev series over pieces of its box.

Axes are cut where the function has a kink, else in the middle, until few terms hold it along the
axis.  Then every piece gets the tensor product of these, and `series` leaves out what is small.
Nothing is known of the function but its values, so kinks and jumps are found by samples on lines.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np

from firmware_export.model import Model, chebyshev_nodes, chebyshev_transform, combinations, widened
from lutgen.errors import InputError
from lutgen.recipe import robot_size_of
from lutgen.vector import Floats

MOST_PARAMETERS = 3
# Nodes along a line, and the most terms along an axis by the number of parameters.
LINE_NODES, MOST_LENGTH = 49, (1, 40, 24, 16)
# Pieces of an axis, and nodes of all pieces: bounds of time and memory.
MOST_PIECES, MOST_NODES = 64, 100_000
LINES, SEED = 12, 11
# Parts of the size by which what jumps still differs over the shortest stretch that is looked at: a
# square root at the end of its range differs there by 1e-6.
JUMP = 1e-5
# Part of the error requested at which a series along an axis has ended.
ENDED = 0.05
# Places at which a stretch of a line is looked at, and how often it is made as much shorter.
PLACES, ZOOMS, JUMP_ZOOMS = 65, 6, 8
# A kink keeps its change of slope, what is smooth loses it: least share that is kept.
KEPT = 0.02
# Parts of a stretch within which kinks of several lines are at one place, and away from its ends.
SAME = 1e-6

# Params (m, k) -> groups (m, g, 3), length.
Place = Callable[[Floats], Floats]
# (n, l) places of l lines, or (n, 1) of all -> (n, l, c) coordinates.
Line = Callable[[Floats], Floats]


def pieces_of(
    model: Model, order: tuple[int, ...], error: float, common: bool
) -> tuple[list[Floats], Floats]:
    """Return knots and series that are off by less than about `error` (length).

    The box is widened by what sensors may say.  The knots (p + 1,) of each axis, rad or length, are
    exact in single precision.  The series (p_1, ..., p_k, n_1, ..., n_k, groups, 3) have the
    coefficients of T_a1(s_1) ... T_ak(s_k) with s from -1 to 1 over a piece, length.  Groups are
    contacts relative to the com, or if it is `common`, minus the com and contacts in the robot's
    own frame.  Positions that jump or need too many pieces are refused.
    """
    box = widened(model)

    def place(params: Floats) -> Floats:
        found = box.postures(params)
        centres, com = found.centres[:, order], found.com[:, None]
        return np.concatenate([-com, centres + com], axis=1) if common else centres

    knots, lengths = list[Floats](), list[int]()
    for axis in range(box.k):
        cuts, length = _cut(box, place, axis, error)
        knots.append(cuts)
        lengths.append(length)
        nodes = math.prod(len(one) - 1 for one in knots) * math.prod(lengths)
        if nodes > MOST_NODES:
            raise _too_many(error)
    return knots, _series(place, knots, lengths)


def _too_many(error: float) -> InputError:
    return InputError(
        f"its positions cannot be held to {error:.3g} by a moderate number of polynomials (they "
        "have kinks along no axis, or bend too fast); use --codec grid"
    )


def _cut(box: Model, place: Place, axis: int, error: float) -> tuple[Floats, int]:
    """Return the knots of an axis, and how many terms each piece needs along it.

    The lines go through some corners of the box, its middle, and other postures.
    """
    rng = np.random.default_rng(SEED)
    t = rng.random((LINES, box.k))
    t[:4] = rng.integers(0, 2, (4, box.k))
    t[4] = 0.5
    bases, matrix = box.at(t), chebyshev_transform(LINE_NODES)

    def line(x: Floats) -> Floats:
        params = np.broadcast_to(bases, (len(x), *bases.shape)).copy()
        params[..., axis] = x
        return place(params.reshape(-1, box.k)).reshape(*params.shape[:2], -1)

    knots = [float(np.float32(end)) for end in (box.lower[axis], box.upper[axis])]
    stretches, longest = [(knots[0], knots[1])], 1
    while stretches:
        low, high = stretches.pop()
        x = low + (chebyshev_nodes(LINE_NODES)[:, None] + 1.0) / 2.0 * (high - low)
        found = np.tensordot(matrix, line(x), (1, 0))
        above = np.flatnonzero(np.abs(found).max(axis=(1, 2)) > ENDED * error)
        length = int(above[-1]) + 1 if len(above) else 1
        if length <= MOST_LENGTH[box.k]:
            longest = max(longest, length)
            continue
        # On ever shorter stretches a continuous function changes by hardly anything at last.
        begin, change = _zoom(low, high - low, line, 1, JUMP_ZOOMS)
        jump, where = change[-1].max(), begin[change[-1].argmax()]
        if jump > JUMP * robot_size_of(box.recipe):
            name = box.recipe.parameters[axis].name
            raise InputError(
                f"its positions jump (by {jump:.3g} where {name} is {where:.6g}), which no table "
                "may hold; let them be continuous, or use --codec grid"
            )
        cut = float(np.float32(_break(low, high, line)))
        if len(knots) > MOST_PIECES or not low < cut < high:
            raise _too_many(error)
        knots.append(cut)
        stretches += [(cut, high), (low, cut)]
    return np.sort(knots), longest


def _zoom(low: float, width: float, line: Line, order: int, times: int) -> tuple[Floats, Floats]:
    """Make the stretch of each line on which differences of an order are largest shorter.

    Returns where the last ones begin (l,), and the largest differences (times, l).
    """
    begin, most = np.full(1, low), []
    for _ in range(times):
        x = begin + width * np.linspace(0.0, 1.0, PLACES)[:, None]
        change = np.abs(np.diff(line(x), order, axis=0)).max(axis=2)
        at = change.argmax(axis=0)
        begin = np.take_along_axis(np.broadcast_to(x, (PLACES, len(at))), at[None], axis=0)[0]
        most.append(change.max(axis=0))
        width *= order / (PLACES - 1)
    return begin, np.array(most)


def _break(low: float, high: float, line: Line) -> float:
    """Return where to cut a stretch: at a kink that all lines have at one place, or in the middle.

    `line` gives coordinates at places of the lines between both ends.
    """
    begin, change = _zoom(low, high - low, line, 2, ZOOMS)
    # The second difference at a kink grows with the stretch, elsewhere with its square.
    bend = change[-1] * (0.5 * (PLACES - 1)) ** (ZOOMS - 1)
    kinked = (bend > KEPT * change[0]) & (bend > KEPT * bend.max())
    place = begin + 0.5 * (high - low) * (2.0 / (PLACES - 1)) ** ZOOMS
    if kinked.any():
        found, near = float(np.median(place[kinked])), SAME * (high - low)
        alike = bool(np.all(np.abs(place[kinked] - found) < near))
        if alike and low + near < found < high - near:
            return found
    return 0.5 * (low + high)


def _series(place: Place, knots: Sequence[Floats], lengths: Sequence[int]) -> Floats:
    """Return the series of all pieces, see `pieces_of`; one node more than there are terms."""
    k, counts = len(knots), [n + 1 for n in lengths]
    axes = [
        (one[:-1, None] + (chebyshev_nodes(n) + 1.0) / 2.0 * np.diff(one)[:, None]).ravel()
        for one, n in zip(knots, counts, strict=True)
    ]
    value = place(combinations(axes))
    shape = [number for one, n in zip(knots, counts, strict=True) for number in (len(one) - 1, n)]
    value = value.reshape(*shape, *value.shape[1:])
    for axis, n in enumerate(counts):
        value = np.moveaxis(
            np.tensordot(chebyshev_transform(n)[: n - 1], value, (1, 2 * axis + 1)), 0, 2 * axis + 1
        )
    order = [*range(0, 2 * k, 2), *range(1, 2 * k, 2), 2 * k, 2 * k + 1]
    return np.ascontiguousarray(value.transpose(order))

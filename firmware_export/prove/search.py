"""Branch and bound over the parameters: the guard that a map needs, and the cells that show it.

Owns the search.  Gravity needs no cells: what is shown of a posture is shown for every direction
(see `cells`).
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_export.prove.blob import TABLES, Held, Points
from firmware_export.prove.cells import REASONS, Found, Rules, examine
from firmware_export.prove.intervals import Interval
from firmware_export.prove.motion import Sum, contacts_of
from firmware_export.prove.rounding import HALF_UNIT, WHOLE, WHOLE_TABLES, unwound
from firmware_export.prove.stored import Stored, stored
from lutgen.channels import acceptance_of
from lutgen.recipe import Recipe
from lutgen.vector import Floats

Ints = NDArray[np.int64]

# Cells that are looked at: before it is given up that anything is proved at all, for a guard that
# is as small as can be, and at once.
MOST, FEW, PIECE = 60_000, 6_000, 4_096
# Postures by which the guard is foreseen, and what it is allowed to be above that.
# They are looked for at random, and then by such steps (parts of the box) from the neediest.
POSTURES, SEED, BEST = 400, 11, 20
STEPS = (0.1, 0.02, 0.004)
ABOVE = 1.02
# Cells that need less than this part of the neediest wait.
LEVEL = 0.7
# A cell is not halved below this part of its axis.
SHORTEST = 1e-9


@dataclass(frozen=True, eq=False)
class Problem:
    """What is to be proved of a map: its postures, where its contacts are, and what stands.

    `box` (k, 2): the parameters' ends, slack and all; `whole`: how many 1/32767 the integer form
    reads a sine too high; `integer`: whether there is no other.
    """

    box: Floats
    truth: list[Sum]
    stored: Stored
    rules: Rules
    whole: float
    integer: bool

    def examine(self, cells: Floats) -> Found:
        """Return what cells (n, k, 2) prove; without floats the planes' turn is all that counts."""
        box = Interval(cells[..., 0].T, cells[..., 1].T)
        found = examine(box, self.truth, self.stored, self.rules)
        return found._replace(guard=found.turn) if self.integer else found

    def whole_guard(self, turn: float) -> int:
        """Return the guard of the integer form (1/32767) for planes that turn by rad."""
        return math.ceil(32767.0 * turn * (1.0 + 1e-12) + self.whole)


def problem_of(recipe: Recipe, held: Held, integer: bool) -> Problem:
    """Return what is to be proved of a map.

    Raises
    ------
    ValueError
        Where the lemmas about single precision do not reach so far; tells why.
    """
    if sorted(held.order) != [0, 1, 2] or len(recipe.contacts) != 3:
        raise ValueError("the map has not the recipe's three contacts")
    whole = held.slack < 0.0
    ends = np.stack([held.low, held.high], axis=1).reshape(-1, 2)
    span = held.high - held.low
    reach = np.abs(ends).max(axis=1) + np.maximum(held.slack, 0.0)
    hair = 8.0 * HALF_UNIT * reach
    room = np.where(whole, 0.0, held.slack) + hair
    box = np.stack([held.low - room, held.high + room], axis=1).reshape(-1, 2)
    # Steps become floats with some rounding; turns are taken off with more.
    lag = 4.0 * HALF_UNIT * span + 2.0 * HALF_UNIT * reach
    lag += hair if held.codec == TABLES else 0.0  # which end where the box does
    lag += np.array([unwound(r) if w else 0.0 for r, w in zip(reach, whole, strict=True)])
    low, high = ([getattr(p, end) for p in recipe.parameters] for end in ("minimum", "maximum"))
    if np.any(np.abs(held.low - low) > hair) or np.any(np.abs(held.high - high) > hair):
        raise ValueError("the map has not the axes of the recipe's parameters")
    truth = contacts_of(recipe, held.order)
    accept = acceptance_of(recipe)
    thresholds = held.body.thresholds if isinstance(held.body, Points) else (0.0, -2.0, 0.0)
    rules = Rules(
        accept.steepest if recipe.upright < math.pi else -2.0,
        accept.rest_width if math.isfinite(accept.rock_angle) else 0.0,
        recipe.com_uncertainty,
        thresholds,
        held.either,
        not integer,
    )
    positions = stored(held, truth, box, lag, integer)
    cut = WHOLE_TABLES if held.codec == TABLES and integer else WHOLE
    return Problem(box, truth, positions, rules, cut, integer)


@dataclass(frozen=True, eq=False)
class Proof:
    """What came of a search.

    `cells` (n, k, 2): they cover the box, and each needs at most `guard` (rad), its planes turn by
    at most `turn` (rad); `trail`: how they come of the box, see `_trail`.  Where nothing is proved
    `guard` is infinite, `worst` (k, 2) is the cell that would not do, and `reason` why.
    """

    guard: float
    turn: float
    cells: Floats
    trail: str
    looked: int
    worst: Floats | None = None
    reason: str = ""


def start_cells(problem: Problem) -> Floats:
    """Return the first cells (n, k, 2): the box, cut where tables have their nodes."""
    pairs = []
    for (low, high), cuts in zip(problem.box, problem.stored.cuts, strict=True):
        inner = cuts[(cuts > low) & (cuts < high)]
        places = np.concatenate([[low], inner, [high]])
        pairs.append(np.stack([places[:-1], places[1:]], axis=1))
    if not pairs:
        return np.zeros((1, 0, 2))
    grids = np.meshgrid(*(np.arange(len(one)) for one in pairs), indexing="ij")
    return np.stack([one[grid.ravel()] for one, grid in zip(pairs, grids, strict=True)], axis=1)


class _Leaves:
    """The cells that cover the box, and the trees by which they came of the first ones.

    A cell's key is the number of its first cell, then 0 or 1 for each time it was halved.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.span = np.maximum(problem.box[:, 1] - problem.box[:, 0], 1e-300)
        self.cells = start_cells(problem)
        self.first = len(self.cells)
        self.keys = [(at,) for at in range(self.first)]
        self.halved: dict[tuple[int, ...], int] = {}
        self.looked = 0
        self.found = self._examine(self.cells)

    def _examine(self, cells: Floats) -> Found:
        self.looked += len(cells)
        pieces = [
            self.problem.examine(cells[at : at + PIECE]) for at in range(0, len(cells), PIECE)
        ]
        return Found(*(np.concatenate(column) for column in zip(*pieces, strict=True)))

    def sizes(self, at: Ints) -> Floats:
        """Return the longest sides of cells, as parts of the box."""
        cells = self.cells[at]
        return np.asarray(((cells[..., 1] - cells[..., 0]) / self.span).max(axis=1, initial=0.0))

    def halve(self, at: Ints) -> None:
        """Halve cells along their longest sides."""
        cells, row = self.cells[at], np.arange(len(at))
        axis = ((cells[..., 1] - cells[..., 0]) / self.span).argmax(axis=1)
        left, right = cells.copy(), cells.copy()
        left[row, axis, 1] = right[row, axis, 0] = cells.mean(axis=2)[row, axis]
        new = np.concatenate([left, right])
        keys = [self.keys[one] for one in at]
        self.halved |= {key: int(along) for key, along in zip(keys, axis, strict=True)}
        kept = np.ones(len(self.cells), bool)
        kept[at] = False
        self.keys = [key for key, stays in zip(self.keys, kept, strict=True) if stays]
        self.keys += [(*key, 0) for key in keys] + [(*key, 1) for key in keys]
        self.cells = np.concatenate([self.cells[kept], new])
        more = self._examine(new)
        self.found = Found(
            *(
                np.concatenate([old[kept], added])
                for old, added in zip(self.found, more, strict=True)
            )
        )


def attempt(problem: Problem, limit: float, most: int = MOST) -> Proof:
    """Cover the box by cells that need a guard (rad) of at most `limit`, or as little as can be.

    The neediest cells are halved until none needs more, or `most` cells were looked at; then the
    others are halved no more, but those that prove nothing up to `MOST`.
    """
    leaves = _Leaves(problem)
    while True:
        guard = leaves.found.guard
        open_ = np.flatnonzero(~np.isfinite(guard))
        finite = guard[np.isfinite(guard)]
        above = max(limit, LEVEL * float(finite.max(initial=0.0)))
        if leaves.looked <= most:
            open_ = np.flatnonzero(guard > above)
            if not len(open_):
                open_ = np.flatnonzero(guard > limit)
        if not len(open_):
            trail = _trail(leaves.first, leaves.halved)
            order = sorted(range(len(leaves.keys)), key=leaves.keys.__getitem__)
            turn = float(leaves.found.turn.max())
            return Proof(float(guard.max()), turn, leaves.cells[order], trail, leaves.looked)
        stuck = leaves.sizes(open_) < SHORTEST
        if stuck.any() or leaves.looked + 2 * len(open_) > max(MOST, most):
            at = open_[int(np.argmax(stuck))]
            why = REASONS[leaves.found.reason[at]]
            return Proof(math.inf, math.inf, leaves.cells, "", leaves.looked, leaves.cells[at], why)
        leaves.halve(open_)


def _trail(count: int, halved: dict[tuple[int, ...], int]) -> str:
    """Return the trees of all first cells: the axis of each that is halved, "." of each other."""
    out: list[str] = []
    todo: list[tuple[int, ...]] = [(at,) for at in reversed(range(count))]
    while todo:
        key = todo.pop()
        axis = halved.get(key)
        out.append("." if axis is None else "0123456789abcdefghijklmnopqrstuvwxyz"[axis])
        if axis is not None:
            todo += [(*key, 1), (*key, 0)]
    return "".join(out)


class Seen(NamedTuple):
    """The posture (k,) that needs the largest guard (rad) of some; infinite where it shows none."""

    guard: float
    place: Floats
    reason: str


def foreseen(problem: Problem) -> Seen:
    """Return what single postures need: no proof can do with less."""
    rng = np.random.default_rng(SEED)
    k = len(problem.box)
    places = rng.random((POSTURES, k))
    places[: POSTURES // 4] = np.rint(places[: POSTURES // 4])
    low, high = problem.box[:, 0], problem.box[:, 1]
    at = low + (high - low) * places
    best = Seen(0.0, at[0], "")
    for step in STEPS:
        found = problem.examine(np.repeat(at[:, :, None], 2, axis=2))
        order = np.argsort(-found.guard, kind="stable")[:BEST]
        if found.guard[order[0]] > best.guard:
            top = order[0]
            best = Seen(float(found.guard[top]), at[top], REASONS[found.reason[top]])
        if not math.isfinite(best.guard):
            break
        moves = rng.normal(size=(POSTURES, k)) * step * (high - low)
        at = np.clip(at[order][np.arange(POSTURES) % BEST] + moves, low, high)
    return best


def needed(problem: Problem) -> Proof:
    """Return a proof of about the least guard that can be proved with few cells."""
    seen = foreseen(problem)
    if not math.isfinite(seen.guard):
        return _hopeless(seen)
    return attempt(problem, ABOVE * seen.guard, FEW)


def enough(problem: Problem, limit: float, most: int) -> Proof:
    """Return a proof that a guard (rad) is enough, or of what was shown instead."""
    seen = foreseen(problem)
    if seen.guard > limit:
        return _hopeless(seen)
    return attempt(problem, limit, most)


def _hopeless(seen: Seen) -> Proof:
    place = np.repeat(seen.place[:, None], 2, axis=1)
    why = seen.reason or f"this posture alone needs {math.degrees(seen.guard):.3g} deg"
    return Proof(math.inf, math.inf, place[None], "", len(STEPS) * POSTURES, place, why)

"""Branch and bound over the parameters: cells that cover the box, each proved for any direction.

Gravity needs no cells: what is shown of a posture is shown for every direction (see `cell`).
"""

import itertools
import math
from typing import Any, NamedTuple

from lutgen.channels import acceptance_of
from lutgen.recipe import Recipe
from proofs.prove.cell import examine
from proofs.prove.held import TABLES, CannotProveError, Map, Points, Tables
from proofs.prove.motion import contacts_of
from proofs.prove.rounding import WHOLE, WHOLE_TABLES

# Cells that are looked at before it is given up, and the part of an axis below which none is cut.
MOST, SHORTEST = 20_000, 1e-6


class Proof(NamedTuple):
    """The guard (rad) of a map, the cells that show it to be enough, or why they do not."""

    guard: float
    cells: int
    reason: str


def prove(recipe: Recipe, blob: bytes, integer: bool) -> Proof:
    """Prove that a map is never falsely safe, and its tip angle never above the true one.

    Parameters
    ----------
    recipe : Recipe
        What the map is of.
    blob : bytes
        The map as it stands in flash.
    integer : bool
        Whether it is read without floats.

    Raises
    ------
    CannotProveError
        For a map or a robot that the lemmas say nothing about.
    """
    if recipe.python is not None:
        raise CannotProveError("the robot is given by code: nothing is known of it but values")
    map_ = Map(blob, integer)
    if sorted(map_.order) != [0, 1, 2] or len(recipe.contacts) != 3:
        raise CannotProveError("the map has not the recipe's three contacts")
    for at, parameter in enumerate(recipe.parameters):
        ends = (map_.low[at] - parameter.minimum, map_.high[at] - parameter.maximum)
        if max(map(abs, ends)) > map_.hair[at]:
            raise CannotProveError(f"the map has another axis for {parameter.name}")
    stored = (Tables if map_.codec == TABLES else Points)(map_, contacts_of(recipe, map_.order))
    if map_.at != len(blob):
        raise CannotProveError(f"the map ends at byte {map_.at} of {len(blob)}")
    accept = acceptance_of(recipe)
    steepest = accept.steepest if recipe.upright < math.pi else -2.0
    width = accept.rest_width if math.isfinite(accept.rock_angle) else 0.0
    rules = (steepest, width, recipe.com_uncertainty)
    whole = WHOLE_TABLES if map_.codec == TABLES and integer else WHOLE
    most_turn = (map_.guard_i - whole) / 32767
    scale = [1.0 / (high - low) for low, high in map_.box]
    looked, todo = 0, _first(map_.box, stored.cuts)
    while todo:
        box = todo.pop()
        looked += 1
        guard, turn, reason = examine(stored, map_, rules, box)
        if turn <= most_turn and (integer or guard <= map_.guard):
            continue
        sizes = [(high - low) * one for (low, high), one in zip(box, scale, strict=True)]
        longest = max(sizes, default=0.0)
        if looked + len(todo) > MOST or longest < SHORTEST:
            reason = reason or f"a guard of {math.degrees(float(guard)):.3g} deg is needed"
            return Proof(map_.guard, looked, f"{reason} at {[low for low, _ in box]}")
        axis = sizes.index(longest)
        low, high = box[axis]
        for half in ((low, (low + high) / 2.0), ((low + high) / 2.0, high)):
            todo.append([*box[:axis], half, *box[axis + 1 :]])
    return Proof(map_.guard, looked, "")


def _first(box: Any, cuts: list[list[float]]) -> list[Any]:
    """Return the first cells: the box, cut where tables have their nodes."""
    rows = []
    for (low, high), places in zip(box, cuts, strict=True):
        inner = sorted({place for place in places if low < place < high})
        rows.append(list(itertools.pairwise([low, *inner, high])))
    return [list(one) for one in itertools.product(*rows)]

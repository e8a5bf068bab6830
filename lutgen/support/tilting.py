"""One roll of a plane: tilted about what it touches until it touches another primitive.

On points the plane turns about a line and comes down on the one with the least angle.  On round
ones the contacts move, so the plane goes in steps: each is short beside the bend of the arc, and
Newton's method finds the plane again after it.
"""

import math
from typing import NamedTuple

from lutgen.arrays import Floats, Vector
from lutgen.jit import njit
from lutgen.support.polygon import has_bit
from lutgen.support.primitive import KIND, RADIUS, axle, fill_contacts, tangent_plane
from lutgen.vector import along, cross, dot, length, row, scale, subtract, unit

# The bits of all primitives.
ALL = -1
# Longest step on round primitives (rad), and how many there are at most.
LONGEST_STEP, MOST_STEPS = 0.5, 60
# A step that is no use is shortened by this, and given up when it is shorter than that (rad).
SHORTER, SHORTEST = 0.4, 1e-3
# A plane on the same contacts that is turned by less (rad) is the one that was left.
LEFT = 1e-7
# So many times the length that counts as none a primitive may be below a plane where no other fits.
NEARLY = 100.0
# Primitives that a step may stop at before the first one that touches is found.
TRIES = 12
# Sine between axles that are parallel.
PARALLEL = 1e-6
# How far a primitive reaches beyond the place where it touched, in radii times (1 - cos turn): 2 if
# the contacts did not move.
REACH = 3.0


class Limits(NamedTuple):
    """Limits of a search for planes, and if the contacts move as one.

    `highest`: the greatest n_z of a plane that is wanted.  `same`: the length that counts as none.
    `rigid`: True if all primitives are alike, so that planes see them as points.
    """

    highest: float
    same: float
    rigid: bool


@njit(bare=True)
def touching(contacts: Floats, mask: int, normal: Vector, i: int, near: float) -> int:
    """Return the bits of those in `mask` that reach to within `near` of a plane on primitive i.

    `contacts` (n, 3): where they touch a plane with that normal, of `fill_contacts`.
    """
    level, found = dot(row(contacts, i), normal) - near, 0
    for k in range(contacts.shape[0]):
        if has_bit(mask, k) and dot(row(contacts, k), normal) >= level:
            found |= 1 << k
    return found


@njit(inline=True, bare=True)
def turn_to(highest: float, normal: Vector, ahead: Vector) -> float:
    """Return by how much (rad) a plane turns towards `ahead` until its normal's z is `highest`."""
    if normal[2] >= highest:
        return 0.0
    steep = math.hypot(normal[2], ahead[2])
    turn = math.atan2(ahead[2], normal[2]) - math.acos(max(min(highest / steep, 1.0), -1.0))
    return turn if turn >= 0.0 else turn + 2.0 * math.pi


@njit(bare=True)
def meets_another(
    primitives: Floats,
    contacts: Floats,
    pair: tuple[int, int],
    normal: Vector,
    ahead: Vector,
    turn: float,
) -> bool:
    """Return True if a plane on a pair may touch another one before it has turned so far (rad).

    Arcs over rims bend to the side unless the axles are parallel; that is not known beforehand.
    """
    i, j = pair
    if j >= 0 and primitives[i, RADIUS] + primitives[j, RADIUS] > 0.0:
        if length(cross(axle(primitives, i), axle(primitives, j))) > PARALLEL:
            return True
        if primitives[i, KIND] != primitives[j, KIND]:
            return True
    c, s = math.cos(turn), math.sin(turn)
    if s < 0.0:
        return True
    origin = row(contacts, i)
    for k in range(primitives.shape[0]):
        if k != i and k != j:
            arm = subtract(row(contacts, k), origin)
            bulge = REACH * primitives[k, RADIUS] * (1.0 - c)
            if dot(ahead, arm) * s + dot(normal, arm) * c + bulge >= 0.0:
                return True
    return False


@njit(bare=True)
def _first_ahead(
    contacts: Floats, i: int, mask: int, normal: Vector, ahead: Vector, least: float
) -> tuple[int, float, float]:
    """Return the primitive that a plane about i comes to first if none moves.

    And cosine and sine of the angle.  `mask`: those that it touches already.  -1 without a contact.
    """
    origin = row(contacts, i)
    first, lever, depth = -1, -1.0, 0.0
    for k in range(contacts.shape[0]):
        if not has_bit(mask, k):
            arm = subtract(row(contacts, k), origin)
            x, y = dot(ahead, arm), max(-dot(normal, arm), least)
            # The one with the greatest cotangent.
            if first < 0 or x * depth > lever * y:
                first, lever, depth = k, x, y
    size = math.sqrt(lever * lever + depth * depth)
    return first, lever / size, depth / size


@njit(bare=True)
def _deepest(contacts: Floats, pair: tuple[int, int], to: int, normal: Vector, same: float) -> int:
    """Return the primitive that is furthest below a plane, -1 if none is by more than `same`."""
    i, j = pair
    worst, most, level = -1, same, dot(row(contacts, i), normal)
    for k in range(contacts.shape[0]):
        if k != i and k != j and k != to:
            below = dot(row(contacts, k), normal) - level
            if below > most:
                worst, most = k, below
    return worst


@njit(bare=True)
def tilt(
    primitives: Floats,
    contacts: Floats,
    pair: tuple[int, int],
    mask: int,
    normal: Vector,
    ahead: Vector,
    limits: Limits,
) -> tuple[int, int, Vector]:
    """Tilt a plane towards `ahead` until it touches another primitive.

    `contacts` (3, n, 3): the first are those at `normal`, of `fill_contacts`, the others scratch.
    The `pair` carries; of (i, -1) the plane turns about the line on i across `ahead`, which is at a
    right angle to `normal`.  `mask` has the bits of all that it touches.  Returns the primitive
    that it comes to, or -1; and there the bits of all that it touches, and its unit normal.
    """
    i, j = pair
    highest, same, rigid = limits
    left, touched = normal, mask
    across = cross(ahead, normal)
    radius, bent = max(primitives[i, RADIUS], primitives[j, RADIUS]) if j >= 0 else 0.0, False
    for k in range(primitives.shape[0]):
        # A round contact touches a plane about a line of points twice.
        bent |= not rigid and has_bit(mask, k) and primitives[k, RADIUS] > 0.0
    step = LONGEST_STEP
    if bent and radius > 0.0:
        # The arc's radius is the distance of the contacts over that of the rim.
        apart = subtract(row(contacts[0], i), row(contacts[0], j))
        step = max(min(step, 0.5 * length(apart) / radius), SHORTEST)
    longest, skipped = step, -1
    here, there, spare = contacts[0], contacts[0 if rigid else 1], contacts[2]
    for _ in range(MOST_STEPS):
        to, c, s = _first_ahead(here, i, mask, normal, ahead, 1e-3 * same)
        if bent and (to < 0 or c < math.cos(step)):
            to, angle = -1, step
            if highest < 1.0:
                room = turn_to(highest, normal, ahead)
                if room < SHORTEST or not meets_another(
                    primitives, here, pair, normal, ahead, room
                ):
                    break
                angle = min(step, room)
            c, s = math.cos(angle), math.sin(angle)
        start = along(scale(normal, c), ahead, s)
        onward = along(scale(ahead, c), normal, -s)
        if not bent and (to < 0 or start[2] > highest):
            break
        if to < 0 and j >= 0:
            start, _ = tangent_plane(primitives, i, j, -1, onward, start)
        good, found, worst = True, start, -1
        for _ in range(TRIES):
            if to >= 0 and j >= 0:
                found, good = tangent_plane(primitives, i, j, to, across, start)
            elif to >= 0:
                found, good = tangent_plane(primitives, i, to, -1, across, start)
            if not rigid:
                fill_contacts(primitives, found, there)
            worst = _deepest(there, pair, to, found, same)
            if worst < 0:
                break
            to = worst
        if worst >= 0 and _deepest(there, pair, to, found, NEARLY * same) < 0:
            # Each is below the plane of the other by noise: the facet takes in both.
            worst = -1
        # Three rims may touch two planes: back to the one that is left Newton's method must not go.
        moved = not has_bit(touched, max(to, 0)) or length(subtract(found, left)) > LEFT
        if worst < 0 and to >= 0 and good and moved and dot(found, ahead) > -1e-9:
            touched = touching(there, ALL, found, i, same) | 1 << to
            return (to if found[2] <= highest else -1), touched, found
        if worst < 0 and to < 0:
            normal, ahead = start, onward
            here, there, spare = there, spare, there
            mask = touching(here, mask, normal, i, same)
            if j >= 0:
                mask |= 1 << j
                arm = subtract(row(here, j), row(here, i))
                turned = unit(cross(arm, normal))
                ahead = scale(turned, math.copysign(1.0, dot(turned, ahead)))
        elif bent and step >= SHORTEST:
            step = SHORTER * min(step, math.acos(c))
        elif bent and to >= 0 and to != skipped:
            # It comes into the row of the pair, and makes no plane with it: there may be another.
            mask, skipped, step = mask | 1 << to, to, longest
        else:
            break
    return -1, 0, normal

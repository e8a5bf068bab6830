"""Twin of the runtime's planes on contacts: where they touch, which facet they form, how they roll.

Every function is the one of runtime/smap.c with the same name, operation by operation.  `work`
(3 n + 6 a + 3,) float32 is posture_t: positions, axes, rims, normal; `facet` (4,) float32 is a
normal and a height; `corner` (n + 1,) int64 its corners, with their number at the end.
"""

import numpy as np
from numpy.typing import NDArray

from firmware_export.twin import F0, F1, Vector, at, cross, dot, njit, normalise, root, subtract

Singles = NDArray[np.float32]
Ints = NDArray[np.int64]

NONE = 255
NO_HINGE = 255
NEWTON_STEPS = 8
LARGEST = np.float32(3.402823466e38)
FACE_ON = np.float32(1e-4)
TINY = np.float32(1e-30)
SMALL_TURN = np.float32(1e-6)
HALF_TURN = np.float32(1.99)


@njit()
def put(array: Singles, index: int, vector: Vector) -> None:
    """Write three components."""
    array[index], array[index + 1], array[index + 2] = vector


@njit()
def aim(work: Singles, contacts: int, axes: int, n: Vector) -> None:
    """Look at planes with the unit normal n: from here on contact_point answers for them."""
    put(work, 3 * contacts + 6 * axes, n)
    for i in range(axes):
        hinge = at(work, 3 * contacts + 3 * i)
        along = dot(n, hinge)
        rim = (n[0] - along * hinge[0], n[1] - along * hinge[1], n[2] - along * hinge[2])
        size, rim = normalise(rim)
        if size < FACE_ON:
            rim = (F0, F0, F0)
        put(work, 3 * contacts + 3 * axes + 3 * i, rim)


@njit()
def contact_point(
    work: Singles, radius: Singles, hinge: Ints, contacts: int, axes: int, i: int
) -> Vector:
    """Return the point of a contact that extends furthest along the normal."""
    p = at(work, 3 * i)
    if hinge[i] < 0:
        return p
    if hinge[i] == NO_HINGE:
        to = at(work, 3 * contacts + 6 * axes)
    else:
        to = at(work, 3 * contacts + 3 * axes + 3 * hinge[i])
    r = radius[i]
    return p[0] + r * to[0], p[1] + r * to[1], p[2] + r * to[2]


@njit()
def extent(
    work: Singles, radius: Singles, hinge: Ints, contacts: int, axes: int, i: int
) -> np.float32:
    """Return how far a contact extends along the normal."""
    point = contact_point(work, radius, hinge, contacts, axes, i)
    return dot(point, at(work, 3 * contacts + 6 * axes))


@njit()
def support(work: Singles, radius: Singles, hinge: Ints, contacts: int, axes: int) -> int:
    """Return the contact that extends furthest along the normal."""
    best = 0
    reach = -LARGEST
    for i in range(contacts):
        value = extent(work, radius, hinge, contacts, axes, i)
        if value > reach:
            reach = value
            best = i
    return best


@njit()
def outline(
    work: Singles,
    radius: Singles,
    hinge: Ints,
    contacts: int,
    axes: int,
    tolerance: np.float32,
    facet: Singles,
    corner: Ints,
) -> bool:
    """Find height and corners of the facet with a normal; False where it is none."""
    n = at(facet, 0)
    corner[contacts] = 0
    aim(work, contacts, axes, n)
    top = support(work, radius, hinge, contacts, axes)
    height = extent(work, radius, hinge, contacts, axes, top)
    facet[3] = height
    if not height > tolerance:
        return False
    furthest = -F1
    touching = 0
    first = 0
    for i in range(contacts):
        if extent(work, radius, hinge, contacts, axes, i) >= height - tolerance:
            here = contact_point(work, radius, hinge, contacts, axes, i)
            size = dot(here, here)
            touching |= 1 << i
            if size > furthest:
                furthest = size
                first = i
    now = first
    count = 0
    while True:
        following = NONE
        step = (F0, F0, F0)
        length = F0
        here = contact_point(work, radius, hinge, contacts, axes, now)
        for i in range(contacts):
            if not (touching >> i) & 1:
                continue
            point = subtract(contact_point(work, radius, hinge, contacts, axes, i), here)
            size = root(dot(point, point))
            if size <= tolerance:
                continue
            turn = dot(cross(step, point), n)
            if (
                following == NONE
                or turn < -tolerance * length
                or (turn <= tolerance * length and size > length and dot(step, point) > F0)
            ):
                following = i
                length = size
                step = point
        if following == NONE:
            return False
        corner[count] = now
        count += 1
        corner[contacts] = count
        now = following
        if not (now != first and count < contacts):
            break
    return count >= 3 and now == first


@njit()
def roll(
    work: Singles,
    radius: Singles,
    hinge: Ints,
    contacts: int,
    axes: int,
    normal: Vector,
    a: int,
    b: int,
    axis: Vector,
    facet: Singles,
) -> int:
    """Roll a plane over the contacts a - b (or over a, about `axis`) until the next one touches."""
    n = normal
    found = NONE
    for step in range(NEWTON_STEPS):
        x, y = F1, F0
        lowest = HALF_TURN
        aim(work, contacts, axes, n)
        start = contact_point(work, radius, hinge, contacts, axes, a)
        if b == NONE:
            edge = axis
        else:
            edge = subtract(contact_point(work, radius, hinge, contacts, axes, b), start)
        _, edge = normalise(edge)
        change = dot(n, edge)
        n = (n[0] - change * edge[0], n[1] - change * edge[1], n[2] - change * edge[2])
        _, n = normalise(n)
        outward = cross(edge, n)
        aim(work, contacts, axes, n)
        found = NONE
        for i in range(contacts):
            if i in (a, b):
                continue
            point = subtract(contact_point(work, radius, hinge, contacts, axes, i), start)
            aside = dot(point, outward)
            above = -dot(point, n)
            if above >= F0:
                turn = F1 - aside / ((-aside if aside < F0 else aside) + above + TINY)
            elif aside > F0:
                turn = aside / (aside - above) - F1
            else:
                continue
            if turn < lowest:
                lowest = turn
                found = i
                x, y = aside, above
        if found == NONE:
            put(facet, 0, n)
            return NONE
        n = (
            n[0] * x + outward[0] * y,
            n[1] * x + outward[1] * y,
            n[2] * x + outward[2] * y,
        )
        _, n = normalise(n)
        if step > 0 and y < SMALL_TURN * x and -y < SMALL_TURN * x:
            break
    put(facet, 0, n)
    return found


@njit()
def rocks(
    work: Singles,
    radius: Singles,
    hinge: Ints,
    contacts: int,
    axes: int,
    tolerance: np.float32,
    steepest: np.float32,
    lowest: np.float32,
    least_cosine: np.float32,
    normal: Vector,
    a: int,
    b: int,
    facet: Singles,
    corner: Ints,
) -> bool:
    """Tell whether the robot rocks from a facet over its edge a - b onto another."""
    nowhere = (F0, F0, F0)
    if roll(work, radius, hinge, contacts, axes, normal, a, b, nowhere, facet) == NONE:
        return False
    if not dot(at(facet, 0), normal) >= least_cosine:
        return False
    if not outline(work, radius, hinge, contacts, axes, tolerance, facet, corner):
        return False
    return bool(-facet[2] > steepest and facet[3] > lowest)

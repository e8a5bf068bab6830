"""Twin of the runtime's search for the facet under gravity and for the region's boundary.

Every function is the one of runtime/smap.c with the same name, operation by operation; the arrays
are those of `contacts_planes`.
"""

import numpy as np

from firmware_export.contacts.planes import (
    NONE,
    Ints,
    Singles,
    aim,
    contact_point,
    extent,
    outline,
    put,
    rocks,
    roll,
    support,
)
from firmware_export.twin import (
    F0,
    F1,
    Vector,
    arcsine,
    at,
    cross,
    dot,
    njit,
    normalise,
    root,
    subtract,
)

WALK_STEPS = 24
RING_STEPS = 8
WAITING = 6
SAME = np.float32(1e-10)
HALF = np.float32(0.5)
THIRD = np.float32(0.333333333)


@njit()
def arc_sine(start: Vector, stop: Vector, g: Vector) -> np.float32:
    """Return the sine of the angle from g to the arc between two contact directions."""
    plane = cross(start, stop)
    if dot(cross(plane, start), g) >= F0 and dot(cross(stop, plane), g) >= F0:
        size = root(dot(plane, plane))
        sine = dot(plane, g) / size if size > F0 else F0
        return -sine if sine < F0 else sine
    lowest = F1
    for i in range(2):
        end = start if i == 0 else stop
        if dot(end, g) > F0:
            side = cross(end, g)
            sine = root(dot(side, side) / dot(end, end))
            if sine < lowest:
                lowest = sine
    return lowest


@njit()
def same_normal(a: Vector, b: Vector) -> bool:
    """Tell whether two normals are those of the same facet."""
    change = subtract(a, b)
    return bool(dot(change, change) < SAME)


@njit()
def surrounded(
    work: Singles,
    radius: Singles,
    hinge: Ints,
    contacts: int,
    axes: int,
    tolerance: np.float32,
    steepest: np.float32,
    lowest: np.float32,
    least_cosine: np.float32,
    start: Vector,
    pivot: int,
    other: int,
    forward: bool,
) -> bool:
    """Tell whether the facets round contact `pivot` close into a ring over which it rocks."""
    facet = np.zeros(4, np.float32)
    corner = np.zeros(contacts + 1, np.int64)
    n = start
    for _ in range(RING_STEPS):
        a, b = (other, pivot) if forward else (pivot, other)
        if not rocks(
            *(work, radius, hinge, contacts, axes, tolerance, steepest, lowest, least_cosine),
            *(n, a, b, facet, corner),
        ):
            return False
        if same_normal(at(facet, 0), start):
            return True
        count = corner[contacts]
        place = NONE
        for i in range(count):
            if corner[i] == pivot:
                place = i
                break
        if place == NONE:
            return False
        if forward:
            place = count - 1 if place == 0 else place - 1
        else:
            place = 0 if place + 1 == count else place + 1
        other = corner[place]
        n = at(facet, 0)
    return False


@njit()
def first_facet(
    work: Singles,
    radius: Singles,
    hinge: Ints,
    contacts: int,
    axes: int,
    tolerance: np.float32,
    g: Vector,
    facet: Singles,
    corner: Ints,
) -> bool:
    """Find a facet to start from: lower a level plane, lean it over one contact, then over two."""
    nowhere = (F0, F0, F0)
    aim(work, contacts, axes, g)
    a = support(work, radius, hinge, contacts, axes)
    reach = extent(work, radius, hinge, contacts, axes, a)
    start = contact_point(work, radius, hinge, contacts, axes, a)
    lean = (reach * g[0] - start[0], reach * g[1] - start[1], reach * g[2] - start[2])
    if dot(lean, lean) < tolerance * tolerance:
        lean = (g[1] * g[1] + g[2] * g[2], -g[0] * g[1], -g[0] * g[2])
        if lean[0] < HALF:
            lean = (-g[1] * g[0], g[0] * g[0] + g[2] * g[2], -g[1] * g[2])
    b = roll(work, radius, hinge, contacts, axes, g, a, NONE, cross(g, lean), facet)
    if b == NONE:
        return False
    if outline(work, radius, hinge, contacts, axes, tolerance, facet, corner):
        return True
    other = contact_point(work, radius, hinge, contacts, axes, b)
    start = contact_point(work, radius, hinge, contacts, axes, a)
    n = at(facet, 0)
    if dot(cross(start, other), g) < F0:
        b = roll(work, radius, hinge, contacts, axes, n, a, b, nowhere, facet)
    else:
        b = roll(work, radius, hinge, contacts, axes, n, b, a, nowhere, facet)
    return b != NONE and outline(work, radius, hinge, contacts, axes, tolerance, facet, corner)


@njit()
def crossed(
    work: Singles,
    radius: Singles,
    hinge: Ints,
    contacts: int,
    axes: int,
    facet: Singles,
    corner: Ints,
    g: Vector,
) -> int:
    """Return the edge over which g lies furthest outside a facet, or NONE."""
    worst = NONE
    lowest = F0
    aim(work, contacts, axes, at(facet, 0))
    count = corner[contacts]
    for i in range(count):
        start = contact_point(work, radius, hinge, contacts, axes, corner[i])
        j = corner[0 if i + 1 == count else i + 1]
        wall = cross(start, contact_point(work, radius, hinge, contacts, axes, j))
        sine = dot(wall, g) / root(dot(wall, wall))
        if sine < lowest:
            lowest = sine
            worst = i
    return worst


@njit()
def within_side(
    work: Singles,
    radius: Singles,
    hinge: Ints,
    contacts: int,
    axes: int,
    tolerance: np.float32,
    before: Vector,
    after: Vector,
    near: int,
    far: int,
    g: Vector,
) -> bool:
    """Tell whether g lies within one side of the gap between two facets."""
    aim(work, contacts, axes, before)
    start = contact_point(work, radius, hinge, contacts, axes, near)
    across = contact_point(work, radius, hinge, contacts, axes, far)
    aim(work, contacts, axes, after)
    stop = contact_point(work, radius, hinge, contacts, axes, near)
    plane = cross(start, stop)
    moved = subtract(stop, start)
    if dot(moved, moved) <= tolerance * tolerance:
        return True
    return bool((dot(plane, g) < F0) == (dot(plane, across) < F0))


@njit()
def stability_factor(
    work: Singles,
    radius: Singles,
    hinge: Ints,
    contacts: int,
    axes: int,
    facet: Singles,
    corner: Ints,
    g: Vector,
) -> np.float32:
    """Return |SD_g| on a facet."""
    n = at(facet, 0)
    aim(work, contacts, axes, n)
    base = contact_point(work, radius, hinge, contacts, axes, corner[0])
    before = subtract(contact_point(work, radius, hinge, contacts, axes, corner[1]), base)
    sum0 = sum1 = sum2 = area = F0
    for i in range(2, corner[contacts]):
        after = subtract(contact_point(work, radius, hinge, contacts, axes, corner[i]), base)
        part = dot(cross(before, after), n)
        sum0 = sum0 + part * (before[0] + after[0])
        sum1 = sum1 + part * (before[1] + after[1])
        sum2 = sum2 + part * (before[2] + after[2])
        area = area + part
        before = after
    area = THIRD / area
    reach = facet[3] / dot(n, g)
    apart = (
        reach * g[0] - (base[0] + sum0 * area),
        reach * g[1] - (base[1] + sum1 * area),
        reach * g[2] - (base[2] + sum2 * area),
    )
    return root(dot(apart, apart))


@njit()
def boundary(
    work: Singles,
    radius: Singles,
    hinge: Ints,
    contacts: int,
    axes: int,
    tolerance: np.float32,
    steepest: np.float32,
    lowest: np.float32,
    least_cosine: np.float32,
    facet: Singles,
    corner: Ints,
    other: Singles,
    other_corner: Ints,
    g: Vector,
) -> np.float32:
    """Return the sine of the angle from g to the boundary of the standing region."""
    seen = np.zeros((WAITING, 3), np.float32)
    best = F1
    known = 1
    put(seen[0], 0, at(facet, 0))
    visit = 0
    while visit < known:
        if visit > 0:
            put(facet, 0, at(seen[visit], 0))
            outline(work, radius, hinge, contacts, axes, tolerance, facet, corner)
        visit += 1
        count = corner[contacts]
        n = at(facet, 0)
        for i in range(count):
            a = corner[i]
            b = corner[0 if i + 1 == count else i + 1]
            aim(work, contacts, axes, n)
            start = contact_point(work, radius, hinge, contacts, axes, a)
            stop = contact_point(work, radius, hinge, contacts, axes, b)
            sine = arc_sine(start, stop, g)
            if sine >= best and (visit > 1 or dot(cross(start, stop), g) >= F0):
                continue
            if not rocks(
                *(work, radius, hinge, contacts, axes, tolerance, steepest, lowest, least_cosine),
                *(n, a, b, other, other_corner),
            ):
                best = sine if sine < best else best
                continue
            beyond = at(other, 0)
            k = 0
            while k < known and not same_normal(at(seen[k], 0), beyond):
                k += 1
            if k == WAITING:
                best = sine if sine < best else best
                continue
            if k == known:
                put(seen[known], 0, beyond)
                known += 1
            for side in range(2):
                near, far = (b, a) if side else (a, b)
                here = stop if side else start
                aim(work, contacts, axes, beyond)
                moved = contact_point(work, radius, hinge, contacts, axes, near)
                sine = arc_sine(here, moved, g)
                if sine < best:
                    shift = subtract(moved, here)
                    if dot(shift, shift) > tolerance * tolerance and not surrounded(
                        *(
                            work,
                            radius,
                            hinge,
                            contacts,
                            axes,
                            tolerance,
                            steepest,
                            lowest,
                            least_cosine,
                        ),
                        *(n, near, far, side == 1),
                    ):
                        best = sine
    return best


@njit()
def read_facets(
    work: Singles,
    radius: Singles,
    hinge: Ints,
    contacts: int,
    axes: int,
    tolerance: np.float32,
    steepest: np.float32,
    lowest: np.float32,
    least_cosine: np.float32,
    d: Vector,
    out: Singles,
) -> None:
    """Read one posture under the direction d; leaves `out` as it is where the robot tips."""
    facet, other = np.zeros(4, np.float32), np.zeros(4, np.float32)
    corner, other_corner = np.zeros(contacts + 1, np.int64), np.zeros(contacts + 1, np.int64)
    nowhere = (F0, F0, F0)
    _, g = normalise(d)
    if not first_facet(work, radius, hinge, contacts, axes, tolerance, g, facet, corner):
        return
    step = 0
    while True:
        place = crossed(work, radius, hinge, contacts, axes, facet, corner, g)
        if place == NONE:
            break
        n = at(facet, 0)
        count = corner[contacts]
        a, b = corner[place], corner[0 if place + 1 == count else place + 1]
        if step == WALK_STEPS:
            return
        if roll(work, radius, hinge, contacts, axes, n, a, b, nowhere, other) == NONE:
            return
        if not outline(work, radius, hinge, contacts, axes, tolerance, other, other_corner):
            return
        back = crossed(work, radius, hinge, contacts, axes, other, other_corner, g)
        if back != NONE and other_corner[back] == b:
            if not (-facet[2] > steepest and facet[3] > lowest):
                return
            if not rocks(
                *(work, radius, hinge, contacts, axes, tolerance, steepest, lowest, least_cosine),
                *(n, a, b, other, other_corner),
            ):
                return
            m = at(other, 0)
            if not (
                within_side(work, radius, hinge, contacts, axes, tolerance, n, m, a, b, g)
                and within_side(work, radius, hinge, contacts, axes, tolerance, n, m, b, a, g)
            ):
                return
            if dot(m, g) * facet[3] > dot(n, g) * other[3]:
                facet[:] = other
                corner[:] = other_corner
            break
        facet[:] = other
        corner[:] = other_corner
        step += 1
    if not (-facet[2] > steepest and facet[3] > lowest):
        return
    out[0] = stability_factor(work, radius, hinge, contacts, axes, facet, corner, g)
    out[2] = facet[3]
    out[1] = arcsine(
        boundary(
            *(work, radius, hinge, contacts, axes, tolerance, steepest, lowest, least_cosine),
            *(facet, corner, other, other_corner, g),
        )
    )

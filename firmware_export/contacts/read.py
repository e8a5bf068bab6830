"""Twin of the runtime's codec `contacts`: from codes to a reading, bit for bit.

Owns the assembly of a posture; three points are read by `three_points`, more contacts and round
ones by `contacts_facets`.  Every function here is one of runtime/smap.c under the same name.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_export.contacts.facets import read_facets
from firmware_export.twin import F0, F1, PI, njit, prange, read_three, root

Singles = NDArray[np.float32]
Ints = NDArray[np.int64]

BELOW_ONE = np.float32(0.99999994)


class Posture(NamedTuple):
    """The tables and the numbers of the descriptor, as smap_contacts_t holds them."""

    shape: NDArray[np.uint8]
    modes: NDArray[np.int16]
    products: NDArray[np.uint8]
    entries: NDArray[np.uint8]
    weights: NDArray[np.int16]
    radii: NDArray[np.int16]
    hinges: NDArray[np.uint8]
    length: np.float32
    unit: np.float32
    steepest: np.float32
    lowest: np.float32
    least_cosine: np.float32
    tolerance: np.float32
    contacts: int
    axes: int
    many: bool


@njit()
def assemble(
    shape: Ints,
    modes: Singles,
    products: Ints,
    entries: Ints,
    weights: Singles,
    length: np.float32,
    unit: np.float32,
    contacts: int,
    axes: int,
    many: bool,
    t: Singles,
    entry: Singles,
    work: Singles,
) -> None:
    """Write positions (3 n) and, behind them, axes (3 a) of one posture to `work`."""
    entry[0] = F1 / unit
    step = length * unit
    count = 1
    at = 0
    for i in range(len(t)):
        last = shape[i, 1] - 1
        x = t[i] * (np.float32(last) * BELOW_ONE)
        cell = int(x)
        frac = x - np.float32(cell)
        for _ in range(shape[i, 0]):
            low, high = modes[at + cell], modes[at + cell + 1]
            entry[count] = low + (high - low) * frac
            count += 1
            at += last + 1
    for i in range(len(products)):
        entry[count] = entry[products[i, 0]] * entry[products[i, 1]] * unit
        count += 1
    for i in range(3 * contacts + 3 * axes):
        work[i] = F0
    common = np.zeros(3, np.float32)
    coordinate = 0
    for term in range(len(entries)):
        value = weights[term] * step * entry[entries[term] & 63]
        coordinate += entries[term] >> 6
        if not many:
            work[coordinate] += value
        elif coordinate < 3:
            common[coordinate] += value
        else:
            work[coordinate - 3] += value
    if many:
        for i in range(contacts):
            for m in range(3):
                work[3 * i + m] += common[m]
        for i in range(axes):
            at = 3 * contacts + 3 * i
            size = root(
                work[at] * work[at] + work[at + 1] * work[at + 1] + work[at + 2] * work[at + 2]
            )
            if size > F0:
                inverse = F1 / size
                for m in range(3):
                    work[at + m] *= inverse


@njit(parallel=True)
def _read_all(
    shape: Ints,
    modes: Singles,
    products: Ints,
    entries: Ints,
    weights: Singles,
    radius: Singles,
    hinge: Ints,
    length: np.float32,
    unit: np.float32,
    steepest: np.float32,
    lowest: np.float32,
    least_cosine: np.float32,
    tolerance: np.float32,
    contacts: int,
    axes: int,
    many: bool,
    t: Singles,
    gravity: Singles,
    out: Singles,
) -> None:
    chunks = 64
    for chunk in prange(chunks):
        entry = np.zeros(64, np.float32)
        work = np.zeros(3 * contacts + 6 * axes + 3, np.float32)
        for q in range(chunk * len(t) // chunks, (chunk + 1) * len(t) // chunks):
            out[q, 0] = out[q, 2] = np.float32(np.nan)
            out[q, 1] = -PI
            assemble(
                *(shape, modes, products, entries, weights, length, unit),
                *(contacts, axes, many, t[q], entry, work),
            )
            d = (gravity[q, 0], gravity[q, 1], gravity[q, 2])
            if many:
                read_facets(
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
                    *(d, out[q]),
                )
            else:
                read_three(work, lowest, steepest, d, out[q])


def read_contacts(posture: Posture, t: Singles, gravity: Singles, out: Singles) -> None:
    """Fill `out` (m, 3) with sdg, tip_angle before the guard, and height.

    `t` (m, k) float32 are the parameters over their axes; `gravity` (m, 3) float32 has 1 along the
    normal of its face.
    """
    radius = posture.radii.astype(np.float32) * posture.length
    contacts = posture.contacts
    round_contacts = len(radius) > 0
    _read_all(
        posture.shape.astype(np.int64),
        posture.modes.astype(np.float32),
        posture.products.astype(np.int64),
        posture.entries.astype(np.int64),
        posture.weights.astype(np.float32),
        radius if round_contacts else np.zeros(contacts, np.float32),
        posture.hinges.astype(np.int64) if round_contacts else np.full(contacts, -1),
        posture.length,
        posture.unit,
        posture.steepest,
        posture.lowest,
        posture.least_cosine,
        posture.tolerance,
        contacts,
        posture.axes,
        posture.many,
        np.ascontiguousarray(t, np.float32),
        np.ascontiguousarray(gravity, np.float32),
        out,
    )

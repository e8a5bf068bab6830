"""The same numbers as vectorised NumPy: all directions of a posture at once, postures in a loop."""

import numpy as np
from numpy.typing import NDArray

from benchmarks.planes import Planes


def stability_factor(
    held: Planes, directions: NDArray[np.float64], out: NDArray[np.float32]
) -> None:
    """Fill `out` (m, g) with |SD_g| for directions (3, g), in float64 until the store."""
    every = np.arange(directions.shape[1])
    for m, (facets, _) in enumerate(held.counts):
        plane, w1, w2 = (held.facets[m, :facets, 3 * i : 3 * i + 3] for i in range(3))
        rates = plane @ directions
        best = rates.argmax(axis=0)
        rate = rates[best, every]
        along = np.einsum("gi,ig->g", w1[best], directions)
        aside = np.einsum("gi,ig->g", w2[best], directions)
        stands = rate > 0.0
        for k in range(facets):
            for e in range(held.first[m, k], held.first[m, k + 1]):
                stands &= (best != k) | (held.walls[m, e] @ directions >= 0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            out[m] = np.where(stands, np.sqrt(along * along + aside * aside) / rate, np.nan)


def tip_angle(held: Planes, directions: NDArray[np.float64], out: NDArray[np.float32]) -> None:
    """Fill `out` (m, g) with the tip angle of convex standing regions, rad."""
    for m, (facets, segments) in enumerate(held.counts):
        if segments == 0:
            out[m] = np.pi if facets else -np.pi
            continue
        sine = (held.tips[m, :segments] @ directions).min(axis=0)
        out[m] = np.arcsin(np.clip(sine, -1.0, 1.0))


def three_metrics(
    axes: NDArray[np.float64], directions: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return tip angle, static margin and energy margin (3, g) of a convex robot.

    `axes` (b, 9): start, stop and inward unit normal of the plane of each tip-over axis;
    `directions` (3, g).
    """
    start, stop, plane = axes[:, 0:3], axes[:, 3:6], axes[:, 6:9]
    edge = stop - start
    length = np.sqrt((edge * edge).sum(axis=1))
    along = edge / length[:, None]
    arm = (start * along).sum(axis=1)[:, None] * along - start
    radius = np.sqrt((arm * arm).sum(axis=1))
    inside = plane @ directions
    across = np.sqrt(np.maximum(1.0 - (along @ directions) ** 2, 0.0))
    with np.errstate(divide="ignore"):
        margin = inside * radius[:, None] / across
    rise = radius[:, None] * across + arm @ directions
    return np.stack(
        [
            np.arcsin(np.clip(inside.min(axis=0), -1.0, 1.0)),
            margin.min(axis=0),
            np.copysign(rise, inside).min(axis=0),
        ]
    )

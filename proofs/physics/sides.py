"""How far the quadrilateral of a gap reaches beyond the gap itself, and what rocking leads to.

Owns two measurements that are no verdicts.  (1) A gap ends where gravity passes through a contact
point of the rolling pair; that point moves on an arc, and lutgen's gap has a straight side.
(2) A robot let go on one of the two facets of a gap, under a direction over the gap, rolls
towards the other; gravity turns with it in the body frame, and it has momentum when it arrives.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from proofs.physics.begin import Start
from proofs.physics.body import DISC, Posture
from proofs.physics.cases import CASES
from proofs.physics.release import STEEPEST, release
from proofs.physics.robots import Maker
from proofs.physics.start import accepted, balance, gaps, is_free, start

ROBOTS: dict[str, Maker] = {
    name: CASES[name].make
    for name in (
        *("3 to 8 balls, +-3 cm", "4 thin wheels, +-3 cm", "4 cylinders, +-3 cm"),
        *("4 flippers, thin", "4 flippers, cylinders", "Absolem, 4 angles"),
    )
}
POSTURES, RELEASES, SEED = 60, 60, 21
# A direction this far (share of the line between the contacts) beyond a side is outside.
OUTSIDE = 1e-3


@dataclass(frozen=True)
class Sides:
    """What was measured on one kind of robot.

    `too_wide` and `too_narrow` (deg): the furthest that lutgen's side lies beyond the true one,
    and inside it, of `sides` sides; `rest`: of `releases` from a facet, how many came to rest.
    """

    name: str
    sides: int
    too_wide: float
    too_narrow: float
    releases: int
    rest: int


def beyond(posture: Posture, plane: Start, end: int) -> float | None:
    """Return lutgen's tip angle (rad) exactly at a side of a gap; None where it is no limit."""
    first, second = plane.points if end == 0 else plane.points[::-1]
    outside = first + OUTSIDE * (first - second)
    outside /= np.linalg.norm(outside)
    begin = start(posture, outside)
    # On a facet near its ridge the share is NaN, and it is no limit.
    tips = begin is not None and begin.balanced and abs(begin.share - 0.5) > 0.5
    if not tips:
        return None
    return posture.tip_angle(first / np.linalg.norm(first))


def measured(name: str) -> Sides:
    """Measure one kind of robot."""
    rng = np.random.default_rng([SEED, list(ROBOTS).index(name)])
    angles: list[float] = []
    releases = rest = 0
    for _ in range(POSTURES):
        posture = ROBOTS[name](rng)
        for gap in gaps(posture, accepted(posture)):
            plane = balance(posture, gap, rng.uniform())
            if not is_free(posture, plane):
                continue
            # A ball goes on rolling beyond the side of its gap: it has no side of this kind.
            ends = (0, 1) if DISC in posture.kind else ()
            found = (beyond(posture, plane, end) for end in ends)
            angles += [angle for angle in found if angle is not None]
            share = rng.uniform(0.1, 0.9)
            gravity_dir = (1.0 - share) * plane.points[0] + share * plane.points[1]
            gravity_dir /= np.linalg.norm(gravity_dir)
            facet = gap.near if rng.uniform() < 0.5 else gap.far
            begin = Start(facet.normal, facet.height, facet.points)
            if releases < RELEASES and begin.slope(gravity_dir) < STEEPEST:
                releases += 1
                rest += not release(posture, begin, gravity_dir).tipped
    degrees = np.degrees([0.0, *angles])
    return Sides(
        name,
        len(angles),
        float(degrees.max()),
        abs(float(degrees.min())),
        releases,
        rest,
    )


def table(rows: Sequence[Sides]) -> str:
    """Return the table of rows as Markdown."""
    lines = [
        "| robots | sides | lutgen's side too far out, at most | too far in, at most "
        "| let go on one of the facets | of these come to rest |",
        "|---|---|---|---|---|---|",
    ]
    for r in rows:
        limits = f"{r.too_wide:.3f} deg | {r.too_narrow:.3f} deg" if r.sides else "- | -"
        lines.append(
            f"| {r.name} | {r.sides:,} | {limits} "
            f"| {r.releases} | {100.0 * r.rest / max(1, r.releases):.0f} % |"
        )
    return "\n".join(lines) + "\n"

"""The ground tilted slowly under a robot: the slope at which it goes over.

Owns the run in which gravity turns, and when a fall *began*.  A robot that only rocks onto other
contacts lies still again and goes on; the fall is the motion that does not end, and it began when
the robot last turned no faster than the ground.  The engine is late: the moment that tips grows
from nothing.  `lag` measures by how much, on three feet, whose limit is plane geometry.
"""

import math
from collections.abc import Sequence

import numpy as np

from proofs.physics.begin import Start
from proofs.physics.body import Floats, Posture, rigid_body
from proofs.physics.release import STEEPEST, Run

GRAVITY = 9.81
# Turns of the ground (rad/s), and the share of an expected limit up to which it may turn quickly.
# Twice as quick, or up to 0.9 of the limit, it is what throws some robots over; half as quick they
# fall at the same slopes, and five times as slow, too (but for the lag).
QUICK, SLOW, UNTIL = math.radians(4.0), math.radians(0.25), 0.6
# Steps (ms) between two looks, and the time (s) that a robot lies on level ground first.
LOOK, SETTLE = 10, 0.3
# Turned so far (rad) from where it lay on level ground it has gone over: no sum of gaps is as wide.
OVER = math.radians(75.0)
# A robot that falls turns this many times faster than the ground; one that rolls along a sole
# turns up to some 10 times faster, as the com may be close to the middle of its arc.
FASTER = 20.0


def slope_at_fall(
    posture: Posture, begin: Start, heading: float, slowly_from: float, slow: float = SLOW
) -> float:
    """Return the slope (rad) at which a robot begins to fall; NaN where it lies up to 80 deg.

    It begins on the plane of `begin`, which is tilted in a heading: 0 raises the tail, so that the
    nose points down; rad, in the frame of the plane, x as near the body's as can be.  Up to
    `slowly_from` (rad) it tilts quickly: far enough below the limit for what swings to lie still.
    """
    run = Run(posture, begin, begin.normal)
    frame = run.rotation
    slopes, normals = [0.0], [frame.T @ [0.0, 0.0, -1.0]]
    run.step(int(1000.0 * SETTLE))
    slope, seconds = 0.0, LOOK / 1000.0
    while slope < STEEPEST and run.turned < OVER:
        slope += seconds * (QUICK if slope < slowly_from else slow)
        down = [
            math.sin(slope) * math.cos(heading),
            math.sin(slope) * math.sin(heading),
            -math.cos(slope),
        ]
        run.model.opt.gravity[:] = GRAVITY * np.array(down)
        run.step(LOOK)
        slopes.append(slope)
        normals.append(run.normals[-1])
    if run.turned < OVER:
        return math.nan
    steps = np.linalg.norm(np.diff(np.array(normals), axis=0), axis=1)
    calm = np.flatnonzero(steps <= FASTER * np.diff(slopes))
    return slopes[int(calm[-1]) + 1] if len(calm) else 0.0


def three_feet(rng: np.random.Generator) -> tuple[Posture, Start, Floats]:
    """Return a body on three feet and the outward normals (3, 2), in its plane, of its sides."""
    turn = rng.uniform(0.0, 2.0 * math.pi) + 2.0 * math.pi / 3.0 * np.arange(3)
    turn += rng.uniform(-0.3, 0.3, 3)
    reach, height = rng.uniform(0.2, 0.4), rng.uniform(0.15, 0.4)
    feet = np.stack([reach * np.cos(turn), reach * np.sin(turn), 0.0 * turn - height], axis=1)
    side = np.roll(feet, -1, axis=0) - feet
    outward = np.stack([side[:, 1], -side[:, 0]], axis=1)
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    return (
        rigid_body(feet, mass=rng.uniform(5.0, 50.0)),
        Start(-np.eye(3)[2], height, feet),
        outward,
    )


def limit_of_feet(begin: Start, outward: Floats, heading: float) -> float:
    """Return the slope (rad) at which gravity passes a side of the feet's polygon."""
    way = np.array([math.cos(heading), math.sin(heading)])
    tangents = [
        float(begin.points[k, :2] @ one) / (begin.height * float(one @ way))
        for k, one in enumerate(outward)
        if one @ way > 1e-9
    ]
    return math.atan(min(tangents))


def lag(seed: int = 30, count: int = 8, slow: float = SLOW) -> Sequence[float]:
    """Return by how much (rad) the engine is late with bodies on three feet, one each."""
    rng = np.random.default_rng(seed)
    late = []
    for _ in range(count):
        posture, begin, outward = three_feet(rng)
        heading = rng.uniform(0.0, 2.0 * math.pi)
        limit = limit_of_feet(begin, outward, heading)
        late.append(slope_at_fall(posture, begin, heading, UNTIL * limit, slow) - limit)
    return late

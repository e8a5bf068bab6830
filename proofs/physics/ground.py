"""Tilt the ground slowly in nine headings, and compare with the slope that lutgen guarantees.

A robot on ground that tilts rocks onto other contacts on its way, and then leans further than the
ground does; it lies still again and goes on.  The fall is the motion that does not end, and it
began when the robot last turned no faster than the ground.
"""

import math
from collections import Counter

import numpy as np

from lutgen.analysis import Posture as Asked
from lutgen.analysis import even_headings, ground_tilt
from lutgen.channels import body_gravity
from lutgen.recipe import Recipe
from proofs.physics.body import Floats, Posture, recipe_posture
from proofs.physics.release import STEEPEST, Run
from proofs.physics.robots import any_params, gallery
from proofs.physics.start import DOWN, Start, on_plane

ROBOTS = ("articulated", "absolem", "markhor", "marv")
COLUMNS = (
    *("postures", "fell below what is guaranteed", "bear over 2 deg more in the worst heading"),
    *("slow tilts", "below the limit of their heading"),
)
NEVER, CASES = ("fell below what is guaranteed",), ("postures",)
HEADINGS = even_headings(8)  # and the worst one that lutgen knows
# The engine is late by 0.19 to 0.28 deg on three feet, whose limit is plane geometry, as the moment
# that tips grows from nothing.  A promise is false where it falls this much (rad) below.
LATE, CLEAR = math.radians(0.19), math.radians(0.1)
# Postures that lutgen gives less (rad) stand so badly that the engine's settling decides; and what
# one may bear beyond its guarantee.
LEAST, SPARED = math.radians(3.0), math.radians(2.0)
# Turns of the ground (rad/s), and the share of an expected limit up to which it may turn quickly.
# Twice as quick, or up to 0.9 of the limit, is what throws some robots over; half as quick they
# fall at the same slopes, and five times as slow, too (but for the lag).
QUICK, SLOW, UNTIL = math.radians(4.0), math.radians(0.25), 0.6
# Steps (ms) between two looks, and the time (ms) that a robot lies on level ground first.
LOOK, SETTLE = 10, 300
# Turned so far (rad) from where it lay it has gone over: no sum of gaps is as wide.
OVER = math.radians(75.0)
# A robot that falls turns this many times faster than the ground; one that rolls along a sole
# turns up to some 10 times faster, as the com may be close to the middle of its arc.
FASTER = 20.0
CHUNK, SEED = 1, 33


def slope_at_fall(posture: Posture, begin: Start, heading: float, slowly_from: float) -> float:
    """Return the slope (rad) at which a robot begins to fall; 80 deg where it lies up to there.

    The plane of `begin` is tilted in a heading: 0 raises the tail, so that the nose points down;
    rad, in the frame of the plane, x as near the body's as can be.  Up to `slowly_from` (rad) it
    tilts quickly: far enough below the limit for what swings to lie still.
    """
    run = Run(posture, begin, begin.normal)
    run.step(SETTLE)
    slopes, slope = [0.0], 0.0
    while slope < STEEPEST and run.turned < OVER:
        slope += LOOK / 1000.0 * (QUICK if slope < slowly_from else SLOW)
        across = [math.sin(slope) * math.cos(heading), math.sin(slope) * math.sin(heading)]
        run.tilt(run.laid.T @ [*across, -math.cos(slope)])
        run.step(LOOK)
        slopes.append(slope)
    if run.turned < OVER:
        return STEEPEST
    steps = np.linalg.norm(np.diff(np.array(run.normals[1:]), axis=0), axis=1)
    calm = np.flatnonzero(steps <= FASTER * np.diff(slopes))
    return slopes[int(calm[-1]) + 1] if len(calm) else 0.0


def promised(recipe: Recipe, params: Floats) -> tuple[float, Floats, Floats]:
    """Return lutgen's word: the slope (rad) at which one posture tips over in no heading.

    Then headings (rad), the worst one last, and the slopes (rad) at which it tips over in them.
    """
    found = ground_tilt(Asked(recipe, params))
    headings = np.append(HEADINGS, found.worst)
    return found.guaranteed, headings, found.limits(headings)


def tilted(recipe: Recipe, params: Floats) -> Counter[str]:
    """Tilt the ground under one posture in every heading; nothing where it hardly stands."""
    promise, headings, limits = promised(recipe, params)
    if promise < LEAST:
        return Counter()
    posture = recipe_posture(recipe, params)
    begin = on_plane(posture, body_gravity(recipe, params[None], DOWN, "plane")[0])
    ways = np.stack([headings, UNTIL * np.minimum(limits, promise)], axis=1).tolist()
    slopes = np.array([slope_at_fall(posture, begin, *way) for way in ways]) - LATE
    worst, below = float(slopes.min()), int((slopes < limits - CLEAR).sum())
    numbers = (1, worst < promise - CLEAR, worst > promise + SPARED, len(slopes), below)
    return Counter(dict(zip(COLUMNS, map(int, numbers), strict=True)))


def tried(name: str, rng: np.random.Generator) -> Counter[str]:
    """Count a posture anywhere in the ranges of a robot."""
    return tilted(gallery(name), any_params(gallery(name), rng))

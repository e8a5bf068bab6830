"""How hard a robot may brake, speed up and turn before it tips over, and how fast it may stop.

A robot that accelerates feels gravity and inertia together, g - a; it tips
where that direction leaves the standing region.  The tip-over angle changes by no more than the
direction turns, so a direction that is turned by as much as was read, and read again, comes to the
limit and never beyond it, for any robot.

A stop takes from the com's velocity v what an impulse of the ground can take.  For a point mass
that is its largest part along a line from the com to a point P of the support polygon (v is
projected onto a convex cone), so 1 - (v . P)^2 of its energy is kept: (z / r)^2 over the middle of
an edge at r from a com z above it.  A body keeps less, as its own inertia takes momentum for each
angle.  The rest must not lift the com over the lowest edge anywhere: a robot that pitches on a
corner lands askew, and goes on sideways.

On a slope the com also sinks while contacts are in the air.  Energy that would lift it by h throws
it up at u and aside at w, u^2 + w^2 = 2 g h; against a tip angle a it is up for 2 u / (g sin a),
and goes w times that, at most 2 h / sin a.  So h grows by 2 h sin(slope) / sin a.

A com that is off by up to rho makes the rise f(x) = |x| - g . x to a balance on x less by at most
rho |grad f| = 2 rho sin(angle(x, g) / 2), as f is convex.  That is rho sqrt(2 f / |x|).
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from lutgen.analysis.ground import gravity_transform
from lutgen.analysis.posture import Facet, Posture
from lutgen.channels import evaluate, evaluate_each, segment_energy
from lutgen.chart import STANDARD_GRAVITY, unit_directions
from lutgen.recipe import Recipe
from lutgen.support import ends_of
from lutgen.vector import Floats, axis_rotation, read3

# No robot accelerates more, m/s^2; where it does not tip before that, nothing is said.
MOST = 50.0
# Reads at most, and the tip-over angle (rad) that is left where the limit is reached.
READS, LEFT = 400, 1e-6
METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001}
# Part of a polygon's width: contacts nearer to an edge belong to it, and not to what is behind it.
ON_EDGE = 0.01
# A robot is taken to keep this part of its energy at least.
STOPPED = 1e-12


def budgets(recipe: Recipe, params: ArrayLike, gravity: ArrayLike, direction: ArrayLike) -> Floats:
    """Return the largest accelerations before postures tip over, (m,), m/s^2, rounded down.

    0 where a posture (m, k) tips anyway, `MOST` where it would not tip below that.  `gravity`
    (m, 3) is down and `direction`, (m, 3) or (3,), where the robot accelerates, body frame, any
    length > 0: braking is backward, turning to the left is to the left.
    """
    rows = np.asarray(params, dtype=np.float64)
    both = np.array(np.broadcast_arrays(gravity, direction), dtype=np.float64)
    force, to = both / np.linalg.norm(both, axis=-1, keepdims=True)
    found, at = np.zeros(len(rows)), np.arange(len(rows))
    for _ in range(READS):
        tip = evaluate_each(recipe, rows[at], force[at], ("tip_angle",))["tip_angle"]
        goes_on = tip > LEFT
        at, tip = at[goes_on], tip[goes_on]
        if not at.size:
            break
        size = np.linalg.norm(force[at], axis=1)
        # Between the acceleration and what is felt now; it may turn as far as against the first.
        left = np.arccos(np.clip(-(force[at] * to[at]).sum(axis=1) / size, -1.0, 1.0))
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(tip < left, size * np.sin(tip) / np.sin(left - tip), np.inf)
        step = np.minimum(step, MOST / STANDARD_GRAVITY - found[at])
        found[at] += step
        force[at] -= step[:, None] * to[at]
        at = at[found[at] < MOST / STANDARD_GRAVITY * (1.0 - 1e-12)]
    return np.asarray(found * STANDARD_GRAVITY)


def turn_speed(acceleration: ArrayLike, radius: float) -> Floats:
    """Return the speeds (m/s) at which turns of a radius (m) take accelerations (m/s^2)."""
    return np.asarray(np.sqrt(np.maximum(np.asarray(acceleration) * radius, 0.0)))


class StopSpeeds(NamedTuple):
    """Speeds (m/s) up to which no stop tips a robot over; infinite where it cannot tip.

    `all_at_once` (h,) are those of headings in which all contacts stop at once, brakes locked or at
    a kerb; `anyhow` is for any cause, one wheel alone too, and any heading.
    """

    all_at_once: Floats
    anyhow: float


def stop_speeds(
    posture: Posture, gravity_dir: ArrayLike, headings: ArrayLike, bump: float = 0.0
) -> StopSpeeds:
    """Return the highest speeds from which a dead stop does not tip a posture over.

    The robot moves along the ground under gravity (3,) in headings (h,), rad, from the nose to the
    left.  With a `bump` (m) one of its contacts has come up by as much, whichever is worst.  0
    where it tips anyway, and NaN under forces and for lengths without unit: a force that turns with
    the robot has no potential, so that no rise of the com stops it.  With an uncertain com a roll
    over a gap counts as tipping.

    Examples
    --------
    >>> from lutgen.recipe.recipe import load_recipe
    >>> robot = load_recipe("maps/excavator.toml")
    >>> speeds = stop_speeds(Posture(robot, robot.home_params), [0, 0, -1], [0.0, math.pi / 2.0])
    >>> speeds.all_at_once.round(2), round(speeds.anyhow, 2)
    (array([1.77, 1.87]), 1.51)
    """
    recipe, down = posture.recipe, unit_directions(gravity_dir)
    heading = np.asarray(headings, np.float64)
    metre = METRES.get(recipe.length_unit)
    rho = recipe.com_uncertainty
    if recipe.has_wrench or metre is None:
        return StopSpeeds(np.full(heading.shape, math.nan), math.nan)
    found = evaluate(recipe, posture.row, down, ("tip_angle", "energy_margin"))
    facet, energy = posture.under(down), float(found["energy_margin"][0, 0])
    if facet is None or found["tip_angle"][0, 0] < 0.0:
        return StopSpeeds(np.zeros(heading.shape), 0.0)
    level = np.stack([np.cos(heading), np.sin(heading), np.zeros(heading.shape)], axis=1)
    ahead = level @ gravity_transform(-facet.normal).T
    speeds, least = np.full(heading.shape, math.inf), math.inf
    energy = energy if rho == 0.0 else _uncertain_rise(posture, down)
    tip_angle, aside = float(found["tip_angle"][0, 0]), math.asin(min(rho / facet.height, 1.0))
    slope = float(np.linalg.norm(np.cross(facet.normal, down)))  # its sine
    for lean, turned, rise in leans(facet, down, bump / metre):
        back = math.sin(min(max(tip_angle - turned, 0.0), math.pi / 2.0))
        rise += rho * turned
        left = (energy - rise) * back / (back + 2.0 * slope) if rise < energy else 0.0
        whole = math.sqrt(2.0 * STANDARD_GRAVITY * metre * left)
        kept = np.arcsin(np.sqrt(_kept(facet.points, ahead @ lean))) + aside
        speeds = np.minimum(speeds, whole / np.sin(np.minimum(kept, math.pi / 2.0)))
        least = min(least, whole)
    return StopSpeeds(speeds, least)


def _uncertain_rise(posture: Posture, down: Floats) -> float:
    """Return how far the com rises at least before the robot leaves its rests, or rolls to one."""
    region, rho = posture.region, posture.recipe.com_uncertainty
    rolls = (e for e in range(region.counts.edges) if np.less(*region.edge[e]["held"]))
    ends = [(read3(arc["start"]), read3(arc["stop"])) for arc in posture.axes]
    ends += [ends_of(region, e) for e in rolls]
    least = min((segment_energy(*pair, read3(down)) for pair in ends), default=math.inf)
    pairs = np.array(ends).reshape(-1, 2, 3)
    moment = np.linalg.norm(np.cross(pairs[:, 0], pairs[:, 1]), axis=1)
    away = (moment / np.linalg.norm(pairs[:, 1] - pairs[:, 0], axis=1)).min(initial=math.inf)
    return least - rho * math.sqrt(2.0 * least / away) if least < math.inf else least


def _kept(corners: Floats, ahead: Floats) -> Floats:
    """Return the part (h,) of its energy that a point mass keeps of unit velocities (h, 3)."""
    arms = corners / np.linalg.norm(corners, axis=1, keepdims=True)
    kept = 1.0 - (np.maximum(ahead @ arms.T, 0.0) ** 2).max(axis=1)
    for start, stop in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        wall = np.cross(start, stop)
        wall /= np.linalg.norm(wall)
        # P is where v, projected onto the plane of com and edge, meets the edge.
        inside = (ahead @ np.cross(wall, start) >= 0.0) & (ahead @ np.cross(stop, wall) >= 0.0)
        kept = np.where(inside, np.minimum(kept, (ahead @ wall) ** 2), kept)
    return np.asarray(np.clip(kept, STOPPED, 1.0))


def leans(facet: Facet, down: Floats, bump: float) -> Iterator[tuple[Floats, float, float]]:
    """Yield how a bump (length) turns the robot over each edge, and how far its com rises.

    The turn comes as a matrix (3, 3) and as an angle (rad).  The contact that comes up is the one
    behind the edge that is nearest to it, which turns the robot most.
    """
    if bump == 0.0:
        yield np.eye(3), 0.0, 0.0
        return
    for start, stop in zip(facet.points, np.roll(facet.points, -1, axis=0), strict=True):
        edge = (stop - start) / np.linalg.norm(stop - start)
        behind = np.abs((facet.touching_points - start) @ np.cross(facet.normal, edge))
        nearest = float(behind[behind > ON_EDGE * behind.max()].min())
        turned = math.asin(min(bump / nearest, 1.0))
        lean = axis_rotation(tuple(edge.tolist()), -turned)
        rise = float((lean @ start - start) @ down)
        passed = bump >= nearest or down @ lean @ np.cross(start, stop) <= 0.0
        yield lean, turned, math.inf if passed else rise

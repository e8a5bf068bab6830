"""Find a robot's mass and centre of mass from scales under its contacts, and from tilts.

The unknowns are the mass m and the moment m d, where d (3,) is the shift of the com from the
computed one, the same in every posture, body frame.  Balance of forces and of moments is linear in
both: the loads that scales read, and gravity's ray through an edge as the robot begins to tip.  The
result is written into the text of a recipe.
"""

import itertools
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lutgen.analysis.posture import Facet, Posture
from lutgen.analysis.tilt import level_frames, tilted
from lutgen.errors import InputError, RecipeError, reject
from lutgen.recipe import Recipe, parse_recipe
from lutgen.recipe.load import toml
from lutgen.support import plane_axes
from lutgen.vector import Floats

# Singular values below this part of the largest say nothing.
NOTHING = 1e-8
# The edge over which the robot tips follows from the com: so often it is looked up again.
ROUNDS = 5
# Slope (rad) of the weighings that are proposed, and the sine by which the robot must stand there.
PROPOSED, STANDING = math.radians(10.0), 0.05
# Digits that are written: a part in 1e9 is finer than any scale.
DIGITS = 9
# The com is within so many standard deviations in 19 of 20 cases and more.
DEVIATIONS = 2.0
# The head of the table, and what is in it.
_ROBOT = re.compile(r"^([ \t]*\[\s*robot\s*\][ \t]*(?:#.*)?\n)((?:(?![ \t]*\[).*\n)*)", re.M)


@dataclass(frozen=True)
class Weighing:
    """Loads (kg) on groups of contacts, by name, and the standard deviation of each reading.

    `params` (k,) is the posture, rad or length; the ground slopes by `slope` (rad) in the robot's
    `heading` (rad, 0: nose down).
    """

    params: tuple[float, ...]
    loads: dict[tuple[str, ...], float]
    accuracy: float
    slope: float = 0.0
    heading: float = 0.0


@dataclass(frozen=True)
class Tipping:
    """The slope (rad) at which the robot was seen to begin to tip, in a heading (rad)."""

    params: tuple[float, ...]
    slope: float
    heading: float
    accuracy: float


Reading = Weighing | Tipping


@dataclass(frozen=True)
class Advice:
    """The weighing that would help most, all contacts on scales, and the com's deviation then."""

    params: tuple[float, ...]
    slope: float
    heading: float
    com_std: float


@dataclass(frozen=True, eq=False)
class Weighed:
    """Mass (kg) and shift of the com (3,), body frame, with standard deviations.

    A deviation is infinite where the readings say nothing, and the value then is the recipe's.
    `residuals` (kg, or rad for tilts) are readings less what the result would give, in the order of
    the readings.  `spread` is the largest standard deviation of the com in any direction.
    """

    mass: float
    mass_std: float
    com_shift: Floats
    com_std: Floats
    spread: float
    residuals: Floats
    advice: Advice | None


def weigh(recipe: Recipe, readings: Sequence[Reading]) -> Weighed:
    """Fit mass and com of a recipe's robot to readings by least squares.

    The robot stands on the facet on which it rests on level ground, and tips from it.  Undetermined
    parts move as little as the readings need.  If they scatter more than their deviations
    say, the result's deviations grow with them.  Refused are unknown contacts, contacts in the air,
    and loads that no mass explains.
    """
    mass = math.fsum(link.mass for link in recipe.links)
    read = [math.fsum(one.loads.values()) for one in readings if isinstance(one, Weighing)]
    # The recipe's own mass and no shift; without masses, the most that the scales read.
    start = np.array([mass or max(read, default=1.0) or 1.0, 0.0, 0.0, 0.0])
    centres = Posture(recipe, readings[0].params).placed.centres[0]
    size = float(np.linalg.norm(centres, axis=1).max()) or 1.0
    estimate, scale = start, start[0] * np.array([1.0, size, size, size])
    # Tilts alone do not determine the mass, which stays.
    free = scale if read else scale * [0.0, 1.0, 1.0, 1.0]
    for _ in range(ROUNDS if any(isinstance(one, Tipping) for one in readings) else 1):
        parts = [_equations(recipe, one, estimate) for one in readings]
        row, value, unit = (np.concatenate(part) for part in zip(*parts, strict=True))
        share = np.linalg.pinv(row * free, rcond=NOTHING) @ (value - row @ start)
        estimate = start + free * share
    if not estimate[0] > 0.0:
        what = "the readings give no mass above 0"
        reject(recipe.source, what, f"{estimate[0]:g} kg", "check them", InputError)
    rest = value - row @ estimate
    covariance, unknown = _known(row, free)
    freedom = len(value) - (4 - unknown.shape[1])
    grown = max(1.0, float(rest @ rest) / freedom) if freedom else 1.0
    mass_std, com_std, spread = _deviations(estimate, grown * covariance, unknown)
    mass_std = mass_std if read else math.inf
    advice = _advice(recipe, readings, estimate, row, scale)
    mass, shift = float(estimate[0]), estimate[1:] / estimate[0]
    return Weighed(mass, mass_std, shift, com_std, spread, rest * unit, advice)


def _seated(
    recipe: Recipe, params: tuple[float, ...], slope: float, heading: float
) -> tuple[Facet, Floats]:
    """Return the facet on which the robot stands, and gravity in the body frame (3,)."""
    posture = Posture(recipe, params)
    frame = level_frames(recipe, posture.row, "plane")[0]
    posture.refuse_forces()
    facet = posture.under(-frame[:, 2])
    if facet is None:
        values = ", ".join(f"{value:g}" for value in params) or "none"
        what, got = "the robot rests on nothing in a posture", f"parameters {values}, rad or length"
        reject(recipe.source, what, got, "leave it out of the file", InputError)
    return facet, frame @ tilted(slope, heading)


def _equations(recipe: Recipe, reading: Reading, estimate: Floats) -> tuple[Floats, Floats, Floats]:
    """Return equations ``row . x = value`` of a reading, and the unit: the deviation of each."""
    facet, down = _seated(recipe, reading.params, reading.slope, reading.heading)
    if isinstance(reading, Tipping):
        start, stop = facet.points, np.roll(facet.points, -1, axis=0)
        shift = estimate[1:] / estimate[0]
        walls = np.cross(start - shift, stop - shift)
        edge = int(np.argmin(walls @ down / np.linalg.norm(walls, axis=1)))
        # Gravity is in the plane of edge and com: ((P - d) x (Q - d)) . g = 0, times the mass.
        side = stop[edge] - start[edge]
        row = [np.cross(start[edge], stop[edge]) @ down, *-np.cross(side, down)]
        factor = estimate[0] * float(np.linalg.norm(walls[edge])) * reading.accuracy
        return np.array([row]) / factor, np.zeros(1), np.array([reading.accuracy])
    names = [recipe.contact_names[i] for i in facet.touching]
    picked = np.array([[name in group for name in names] for group in reading.loads], np.float64)
    for name in itertools.chain(*reading.loads):
        if name not in names:
            what, got = "a contact carries nothing in this posture", f"a load on {name!r}"
            reject(recipe.source, what, got, f"on the ground are {', '.join(names)}", InputError)
    loads, free = _balance(facet, down)
    # Loads that statics leaves open are taken out of the readings.
    spare = picked @ free
    keep = np.eye(len(picked)) - spare @ np.linalg.pinv(spare)
    value = np.array(list(reading.loads.values()))
    unit = np.full(len(value), reading.accuracy)
    return keep @ picked @ loads / reading.accuracy, keep @ value / reading.accuracy, unit


def _balance(facet: Facet, down: Floats) -> tuple[Floats, Floats]:
    """Return loads (c, 4) for each unknown, and those (c, c - 3) that balance among themselves.

    Friction acts in the ground's plane, so it has no moment about axes in it: with o the com's
    foot and e such an axis, sum N ((r - o) x n) . e = (D x g) . e - m (o x g) . e.
    """
    points, normal = facet.touching_points, facet.normal
    foot, axes = normal * facet.height, np.array(plane_axes(tuple(normal.tolist())))
    sums = np.vstack([np.ones(len(points)), axes @ np.cross(points - foot, normal).T])
    known = np.zeros((3, 4))
    known[0, 0] = normal @ down
    known[1:, 0] = -axes @ np.cross(foot, down)
    known[1:, 1:] = np.cross(down, axes)
    _, singular, right = np.linalg.svd(sums)
    rank = int((singular > NOTHING * singular[0]).sum())
    return np.linalg.pinv(sums) @ known, right[rank:].T


def _known(row: Floats, scale: Floats) -> tuple[Floats, Floats]:
    """Return the covariance (4, 4) of equations, and the directions (4, u) that they leave open.

    `scale` (4,) is what a unit of each unknown is.
    """
    _, singular, right = np.linalg.svd(row * scale)
    rank = int((singular > NOTHING * singular[0]).sum())
    inverse = (right[:rank].T / singular[:rank] ** 2) @ right[:rank]
    return scale[:, None] * inverse * scale, scale[:, None] * right[rank:].T


def _deviations(
    estimate: Floats, covariance: Floats, unknown: Floats
) -> tuple[float, Floats, float]:
    """Return the deviations of mass, of the com's components, and of the com where it is largest.

    `unknown` (4, u) are directions of which nothing is known.
    """
    shift = estimate[1:] / estimate[0]
    change = np.hstack([-shift[:, None], np.eye(3)]) / estimate[0]
    com = change @ covariance @ change.T
    lost = change @ unknown
    scale = float(np.abs(change @ np.diag(np.abs(unknown).max(axis=1, initial=0.0))).max())
    open_ = np.abs(lost).max(axis=1, initial=0.0) > NOTHING * max(scale, 1e-300)
    com_std = np.where(open_, np.inf, np.sqrt(np.maximum(np.diag(com), 0.0)))
    mass_open = np.abs(unknown[0]).max(initial=0.0) > NOTHING * np.abs(unknown).max(initial=0.0)
    mass_std = math.inf if mass_open else math.sqrt(max(covariance[0, 0], 0.0))
    spread = math.inf if open_.any() else math.sqrt(max(float(np.linalg.eigvalsh(com)[-1]), 0.0))
    return mass_std, com_std, spread


def _advice(
    recipe: Recipe, readings: Sequence[Reading], estimate: Floats, row: Floats, scale: Floats
) -> Advice | None:
    """Return the weighing after which the com is known best, or None."""
    accuracies = [one.accuracy for one in readings if isinstance(one, Weighing)]
    accuracy = min(accuracies, default=0.01 * float(estimate[0]))
    home = recipe.home_params
    ends = [(i, end) for i, p in enumerate(recipe.parameters) for end in (p.minimum, p.maximum)]
    # Home and each end of a parameter, level and tilted.
    rows = [home, *((*home[:i], end, *home[i + 1 :]) for i, end in ends)]
    headings = (0.0, 0.5 * math.pi, math.pi, -0.5 * math.pi)
    slopes = [(0.0, 0.0), *((PROPOSED, heading) for heading in headings)]
    best = None
    for params, (slope, heading) in itertools.product(rows, slopes):
        facet, down = _seated(recipe, params, slope, heading)
        start, stop = facet.points, np.roll(facet.points, -1, axis=0)
        walls = np.cross(start, stop)
        if float((walls @ down / np.linalg.norm(walls, axis=1)).min()) < STANDING:
            continue
        # A scale under each contact, less the loads that balance among themselves.
        loads, free = _balance(facet, down)
        more = (np.eye(len(loads)) - free @ free.T) @ loads / accuracy
        _, _, spread = _deviations(estimate, *_known(np.vstack([row, more]), scale))
        if best is None or spread < best.com_std:
            best = Advice(params, slope, heading, spread)
    return best


def correction(recipe: Recipe, found: Weighed) -> dict[str, float | list[float]]:
    """Return the keys of `[robot]` that make the recipe the robot that was weighed.

    `mass` is left out where the recipe has no masses, or the readings do not determine it, and
    `com_uncertainty` where they leave a part of the com open.
    """
    shift = [float(f"{x:.{DIGITS}g}") for x in found.com_shift + recipe.com_offset]
    keys: dict[str, float | list[float]] = {}
    if found.mass_std < float("inf") and any(link.mass for link in recipe.links):
        keys["mass"] = float(f"{found.mass:.{DIGITS}g}")
    keys["com_offset"] = shift
    if found.spread < float("inf"):
        keys["com_uncertainty"] = float(f"{DEVIATIONS * found.spread:.3g}")
    return keys


def correction_lines(keys: dict[str, float | list[float]]) -> list[str]:
    """Return the keys as lines of TOML."""
    return [f"{key} = {toml(value)}" for key, value in keys.items()]


def corrected(recipe: Recipe, found: Weighed) -> str:
    """Return the recipe's text with the correction below its `[robot]`; all else stays.

    A text where the keys cannot be replaced is refused with the lines to write by hand.
    """
    keys = correction(recipe, found)
    before = re.compile(rf"^[ \t]*({'|'.join(keys)})\s*=.*\n", re.M)
    lines = "\n".join([*correction_lines(keys), ""])
    text = "\n".join([*recipe.text.splitlines(), ""])
    text = _ROBOT.sub(lambda part: part[1] + lines + before.sub("", part[2]), text, count=1)
    try:
        made = parse_recipe(text, recipe.source, inert=True, urdf=recipe.urdf)
        good = list(made.com_offset) == keys["com_offset"]
    except RecipeError:
        good = False
    if not good:
        what, got = "the keys of [robot] are not where they can be replaced", "no good recipe"
        reject(recipe.source, what, got, f"write {'; '.join(correction_lines(keys))} there by hand")
    return text

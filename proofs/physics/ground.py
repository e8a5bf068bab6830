"""The ground tilted slowly in nine headings, against the slope that lutgen guarantees in all.

Owns the comparison.  A robot on ground that tilts rocks onto other contacts on its way, and then
leans further than the ground does: a limit that keeps to the facet of level ground promises too
much, and so does one that forgets with how much momentum the robot arrives on the next facet.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

import lutgen
from lutgen.analysis import Posture as Asked
from lutgen.analysis import even_headings, ground_tilt
from lutgen.channels import body_gravity
from lutgen.recipe import Recipe
from proofs.physics.begin import Start
from proofs.physics.body import Floats, recipe_postures
from proofs.physics.pierced import heights
from proofs.physics.release import STEEPEST
from proofs.physics.robots import ROOT
from proofs.physics.slow import UNTIL, slope_at_fall

ROBOTS = ("articulated", "absolem", "markhor", "marv")
HEADINGS = even_headings(8)  # and the worst one that lutgen knows
# A promise is false where the engine falls this much (rad) below it, its own lag taken off: lags
# differ by 0.07 deg, and the engine is right to 0.1 deg.
CLEAR = math.radians(0.1)
# Postures that lutgen gives less (rad) stand so badly that the engine's settling decides.
LEAST = math.radians(3.0)
CHUNK, SEED = 3, 33


@dataclass(frozen=True)
class Fall:
    """One posture in degrees: what is guaranteed, and in each heading lutgen's limit and slope."""

    params: tuple[float, ...]
    guaranteed: float
    limits: tuple[float, ...]
    slopes: tuple[float, ...]


@dataclass(frozen=True)
class Row:
    """One robot: postures that fell below their guarantee, and by how much (deg) at most.

    `spared` (deg) is the median of what the worst heading of a posture bears beyond its guarantee.
    `early` of `tilts` were below lutgen's limit of their heading, by `earliest` (deg) at most;
    `median` (deg) is that of slope - limit, the lag taken off.
    """

    name: str
    postures: int
    broken: int
    worst: float
    spared: float
    tilts: int
    early: int
    earliest: float
    median: float


def guaranteed(recipe: Recipe, params: Floats) -> tuple[float, float]:
    """Return the slope (rad) up to which lutgen says that one posture tips over in no heading.

    The second is its worst heading (rad).  This is the one place to change when lutgen says it
    elsewhere.
    """
    found = ground_tilt(Asked(recipe, params))
    return found.guaranteed, found.worst


def said_limits(recipe: Recipe, params: Floats, headings: Floats) -> Floats:
    """Return the slopes (h,), rad, at which lutgen says that one posture tips over in headings."""
    return ground_tilt(Asked(recipe, params)).limits(headings)


def fall(recipe: Recipe, params: Floats) -> Fall | None:
    """Tilt the ground under one posture in every heading; None where it hardly stands."""
    promise, worst = guaranteed(recipe, params)
    if promise < LEAST:
        return None
    posture = recipe_postures(recipe, params[None])[0]
    normal = body_gravity(recipe, params[None], [0.0, 0.0, -1.0], "plane")[0]
    height = float(heights(posture, normal[None]).max())
    begin = Start(normal, height, posture.centres[:3])
    headings = np.append(HEADINGS, worst)
    limits = said_limits(recipe, params, headings)
    slopes = [
        slope_at_fall(posture, begin, float(heading), UNTIL * min(float(limit), promise))
        for heading, limit in zip(headings, limits, strict=True)
    ]
    return Fall(
        tuple(np.degrees(params).tolist()),
        math.degrees(promise),
        *(tuple(np.degrees(limits).tolist()), tuple(np.degrees(slopes).tolist())),
    )


def judged(name: str, chunk: int) -> list[Fall]:
    """Return the falls of `CHUNK` postures, the same in every run."""
    rng = np.random.default_rng([SEED, ROBOTS.index(name), chunk])
    recipe = lutgen.load_recipe(ROOT / "maps" / f"{name}.toml")
    low = np.array([p.minimum for p in recipe.parameters])
    high = np.array([p.maximum for p in recipe.parameters])
    found: list[Fall] = []
    if name == ROBOTS[0] and not chunk:
        # The posture of the first finding: guaranteed 38.4 deg, and the engine falls at 36.
        first = fall(recipe, np.radians([45.0, 15.0]))
        found += [first] if first else []
    while len(found) < CHUNK:
        one = fall(recipe, rng.uniform(low, high))
        found += [one] if one else []
    return found


def row(name: str, falls: Sequence[Fall], late: float) -> Row:
    """Count; `late` (deg) is the engine's least lag."""
    clear = math.degrees(CLEAR)
    slopes = np.array([one.slopes for one in falls]) - late
    # One that lies up to the steepest slope has not fallen.
    slopes = np.where(np.isnan(slopes), math.degrees(STEEPEST), slopes)
    below = np.array([one.guaranteed for one in falls]) - slopes.min(axis=1)
    early = np.array([one.limits for one in falls]) - slopes
    return Row(
        name=name,
        postures=len(falls),
        broken=int((below > clear).sum()),
        worst=float(below.max()),
        spared=float(-np.median(below)),
        tilts=slopes.size,
        early=int((early > clear).sum()),
        earliest=float(early.max()),
        median=float(-np.median(early)),
    )


def table(rows: Sequence[Row]) -> str:
    """Return the table of rows as Markdown."""
    lines = [
        "| robot | postures | fell below what is guaranteed | by at most "
        "| median of worst slope - guaranteed | slow tilts | below the limit of their heading "
        "| by at most | median of slope - limit |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for r in rows:
        lines.append(
            f"| {r.name} | {r.postures} | {r.broken} | {max(r.worst, 0.0):.2f} deg "
            f"| {r.spared:.2f} deg | {r.tilts} | {r.early} | {max(r.earliest, 0.0):.2f} deg "
            f"| {r.median:.2f} deg |"
        )
    return "\n".join(lines) + "\n"


def missed(rows: Sequence[Row]) -> list[str]:
    """Return the robots that fell below what is guaranteed, one line each."""
    return [
        f"{r.name}: {r.broken} of {r.postures} postures fell below what is guaranteed, by up to "
        f"{r.worst:.2f} deg"
        for r in rows
        if r.broken
    ]

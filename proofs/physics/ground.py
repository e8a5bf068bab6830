"""The ground tilted slowly in nine headings, against the slope that lutgen guarantees in all.

Owns the comparison.  A robot on ground that tilts rocks onto other contacts on its way, and then
leans further than the ground does: a limit that keeps to the facet of level ground promises too
much.  Two limits are held against the engine: what `lutgen limits` prints, and the slope up to
which the robot stands when it is seated anew on every slope, found by walking.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import lutgen
from lutgen.analysis import Posture as Asked
from lutgen.analysis import even_headings, posture_limits, tilted
from lutgen.channels import body_gravity, evaluate_each
from lutgen.recipe import Recipe
from proofs.physics.body import Floats, recipe_postures
from proofs.physics.cases import ROOT
from proofs.physics.pierced import heights
from proofs.physics.slow import UNTIL, slope_at_fall
from proofs.physics.start import Start

ROBOTS = ("articulated", "absolem", "markhor", "marv")
HEADINGS = even_headings(8)  # and the seated limit's worst one
# The walk of the seated limit: steps (rad), the steepest ground, halvings (to 0.001 deg), and the
# headings of its guarantee.
STEP, STEEP, HALVINGS, AROUND = math.radians(0.5), math.radians(80.0), 9, 72
# A promise is false where the engine falls this much (rad) below it, its own lag taken off: lags
# differ by 0.07 deg, and the engine is right to 0.1 deg.
CLEAR = math.radians(0.1)
# Postures that lutgen gives less (rad) stand so badly that the engine's settling decides.
LEAST = math.radians(3.0)
CHUNK, SEED = 3, 33


@dataclass(frozen=True)
class Fall:
    """One posture in degrees: printed and seated guarantee, per heading seated limit and slope."""

    params: tuple[float, ...]
    printed: float
    seated: float
    limits: tuple[float, ...]
    slopes: tuple[float, ...]


@dataclass(frozen=True)
class Row:
    """One robot: false promises, and the most (deg) by which each guarantee is too high."""

    name: str
    postures: int
    falls: int
    printed_false: int
    printed_worst: float
    seated_false: int
    seated_worst: float
    too_early: int
    median: float


def printed_guarantee(recipe: Recipe, params: Floats) -> float:
    """Return the slope (rad) that `lutgen limits` guarantees one posture (k,) in every heading."""
    return posture_limits(Asked(recipe, params), "plane").guaranteed


def seated_limits(recipe: Recipe, params: Floats, headings: Floats) -> Floats:
    """Return the slope (rad) at which one posture first tips in headings (h,), seated on each."""

    def stands(slope: Floats) -> NDArray[np.bool_]:
        level = tilted(slope, np.broadcast_to(headings, slope.shape)).reshape(-1, 3)
        rows = np.broadcast_to(params, (len(level), len(params)))
        down = body_gravity(recipe, rows, level, "plane")
        angles = evaluate_each(recipe, rows, down, ("tip_angle",))["tip_angle"]
        return np.asarray(angles.reshape(slope.shape) >= 0.0, np.bool_)

    walk = np.arange(0.0, STEEP + STEP, STEP)
    found = stands(np.repeat(walk[:, None], len(headings), axis=1))
    first = np.where(found.all(axis=0), len(walk) - 1, (~found).argmax(axis=0))
    high = walk[first]
    low = np.maximum(high - STEP, 0.0)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        up = stands(middle[None])[0]
        low, high = np.where(up, middle, low), np.where(up, high, middle)
    return np.asarray(low)


def seated_guarantee(recipe: Recipe, params: Floats) -> tuple[float, float]:
    """Return the least of the seated limits (rad) over `AROUND` headings, and its heading."""
    around = even_headings(AROUND)
    limits = seated_limits(recipe, params, around)
    return float(limits.min()), float(around[limits.argmin()])


def fall(recipe: Recipe, params: Floats) -> Fall | None:
    """Tilt the ground under one posture in every heading; None where it hardly stands."""
    printed = printed_guarantee(recipe, params)
    seated, worst = seated_guarantee(recipe, params)
    if min(printed, seated) < LEAST:
        return None
    posture = recipe_postures(recipe, params[None])[0]
    normal = body_gravity(recipe, params[None], [0.0, 0.0, -1.0], "plane")[0]
    height = float(heights(posture, normal[None]).max())
    begin = Start(normal, height, posture.centres[:3])
    headings = np.append(HEADINGS, worst)
    limits = seated_limits(recipe, params, headings)
    slopes = [
        slope_at_fall(posture, begin, float(heading), UNTIL * min(float(limit), seated, printed))
        for heading, limit in zip(headings, limits, strict=True)
    ]
    return Fall(
        tuple(np.degrees(params).tolist()),
        *(math.degrees(printed), math.degrees(seated)),
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
    slopes = np.where(np.isnan(slopes), math.degrees(STEEP), slopes)
    least = slopes.min(axis=1)
    printed = np.array([one.printed for one in falls]) - least
    seated = np.array([one.seated for one in falls]) - least
    beyond = slopes - np.array([one.limits for one in falls])
    return Row(
        *(name, len(falls), slopes.size),
        *(int((printed > clear).sum()), float(printed.max())),
        *(int((seated > clear).sum()), float(seated.max())),
        *(int((beyond < -clear).sum()), float(np.median(beyond))),
    )


def table(rows: Sequence[Row]) -> str:
    """Return the table of rows as Markdown."""
    lines = [
        "| robot | postures | slow tilts | fell below what `lutgen limits` guarantees "
        "| by at most | below the guarantee of a robot seated anew | by at most "
        "| tilts below the seated limit of their heading | median of tilt - limit |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for r in rows:
        lines.append(
            f"| {r.name} | {r.postures} | {r.falls} | {r.printed_false} "
            f"| {max(r.printed_worst, 0.0):.2f} deg | {r.seated_false} "
            f"| {max(r.seated_worst, 0.0):.2f} deg | {r.too_early} | {r.median:.2f} deg |"
        )
    return "\n".join(lines) + "\n"


def missed(rows: Sequence[Row]) -> list[str]:
    """Return the robots that fell below what is guaranteed, one line each."""
    return [
        f"{r.name}: {r.printed_false} of {r.postures} postures fell below what `lutgen limits` "
        f"guarantees, by up to {r.printed_worst:.2f} deg"
        for r in rows
        if r.printed_false
    ]

"""Robots given by code, as recipes name them: closed chains, stops, and what is no mechanism."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from lutgen.recipe.recipe import Recipe, parse_recipe
from proofs.recipes import sweep_part

__all__ = [
    *("coded", "latched", "legs", "limited", "one_way", "round_about", "scissors", "stops"),
    "wheels",
]

Floats = NDArray[np.float64]
Places = tuple[Floats, Floats]
# Of a four-bar linkage in the plane of x and z, m: crank, coupler, rocker, ground; where on the
# coupler the foot is, along and across.
CRANK, COUPLER, ROCKER, GROUND, FOOT = 0.12, 0.3, 0.25, 0.35, (0.35, -0.3)
# Where the crank turns on the body.
HIP = np.array([0.1, -0.25])


def four_bar(crank: Floats) -> Floats:
    """Return the foot (m, 2), x and z, of linkages whose cranks stand at angles (m,), rad."""
    b = CRANK * np.stack([np.cos(crank), np.sin(crank)], axis=-1)
    across = np.array([GROUND, 0.0]) - b
    apart = np.sqrt((across**2).sum(axis=-1, keepdims=True))
    along = (apart**2 + COUPLER**2 - ROCKER**2) / (2.0 * apart)
    up = np.sqrt(COUPLER**2 - along**2)
    side = np.stack([-across[..., 1], across[..., 0]], axis=-1) / apart
    coupler = (along * across / apart + up * side) / COUPLER
    normal = np.stack([-coupler[..., 1], coupler[..., 0]], axis=-1)
    foot: Floats = b + FOOT[0] * coupler + FOOT[1] * normal
    return foot


def _feet(q: Floats, fixed: Sequence[Sequence[float]]) -> Floats:
    """Return contacts (m, n, 3): two feet on linkages in front, others fixed."""
    feet = np.empty((len(q), 2 + len(fixed), 3))
    for side, y in enumerate((0.35, -0.3)):
        feet[:, side, [0, 2]] = four_bar(q[:, side]) + HIP
        feet[:, side, 1] = y
    feet[:, 2:] = fixed
    return feet


def legs(q: Floats) -> Places:
    """Return three feet, two of them on four-bar linkages; a com that does not move."""
    return _feet(q, [(-0.45, 0.0, -0.4)]), np.tile([0.02, 0.0, 0.1], (len(q), 1))


def wheels(q: Floats) -> Places:
    """Return four contacts, two of them on four-bar linkages that carry a part of the mass."""
    feet = _feet(q, [(-0.4, 0.3, -0.4), (-0.4, -0.35, -0.4)])
    return feet, 0.05 * feet[:, :2].sum(axis=1) + (0.0, 0.0, 0.08)


def scissors(q: Floats) -> Places:
    """Return four feet of three parameters: a lift, its lean, and a spread; all depend on all."""
    lift, lean, spread = q.T
    corners = np.array([(1, 1), (1, -1), (-1, -1), (-1, 1)], np.float64)
    feet = np.empty((len(q), 4, 3))
    feet[..., 0] = 0.4 * corners[:, 0] + np.sin(lean)[:, None] * 0.2
    feet[..., 1] = (0.25 + spread[:, None]) * corners[:, 1]
    height = np.sqrt(0.5**2 - (0.2 + spread) ** 2) * np.sin(lift)
    feet[..., 2] = -height[:, None] - 0.1 * corners[:, 0] * np.sin(lean)[:, None]
    return feet, np.zeros((len(q), 3))


def stops(q: Floats) -> Places:
    """Return three feet of which one meets a stop, at 0.37 m, and goes on in another direction."""
    feet = np.tile([(0.6, 0.0, -0.5), (-0.4, 0.4, -0.5), (-0.4, -0.4, -0.5)], (len(q), 1, 1))
    beyond = np.maximum(q[:, 0] - 0.37, 0.0)
    feet[:, 0, 0] += 0.3 * q[:, 0] - 0.2 * beyond
    feet[:, 0, 2] += 0.25 * beyond + 0.05 * np.sin(3.0 * q[:, 0])
    return feet, np.zeros((len(q), 3))


def latched(q: Floats) -> Places:
    """Return three feet of which one snaps to another place at 0.37 m."""
    feet, com = stops(q)
    feet[:, 0, 0] += np.where(q[:, 0] > 0.37, 0.05, 0.0)
    return feet, com


def round_about(q: Floats) -> Places:
    """Return three feet of which one goes round on a circle, as often as one likes."""
    feet = np.tile([(0.6, 0.0, -0.5), (-0.4, 0.4, -0.5), (-0.4, -0.4, -0.5)], (len(q), 1, 1))
    feet[:, 0, 0] += 0.15 * np.cos(q[:, 0])
    feet[:, 0, 2] += 0.15 * np.sin(q[:, 0])
    return feet, np.zeros((len(q), 3))


def limited(q: Floats) -> Places:
    """Return three feet, and no number where a rod of 1 m is not long enough."""
    feet, com = round_about(np.zeros((len(q), 1)))
    with np.errstate(invalid="ignore"):
        feet[:, 0, 2] -= 0.1 * np.sqrt(1.0 - q[:, 0] ** 2)
    return feet, com


def one_way(q: Floats) -> Places:
    """Return four feet with a kink along no axis: of two levers the higher one counts."""
    feet = np.tile(
        [(0.4, 0.4, -0.5), (0.4, -0.4, -0.5), (-0.4, -0.4, -0.5), (-0.4, 0.4, -0.5)], (len(q), 1, 1)
    )
    feet[:, 0, 2] -= 0.3 * np.maximum(q[:, 0], q[:, 1])
    return feet, np.zeros((len(q), 3))


# Of each robot: parameters with ends (deg, or m where the third is).
AXES = {
    "legs": (("left", -120.0, -20.0, "deg"), ("right", -120.0, -20.0, "deg")),
    "wheels": (("left", -110.0, -30.0, "deg"), ("right", -110.0, -30.0, "deg")),
    "scissors": (
        ("lift", 30.0, 80.0, "deg"),
        ("lean", -20.0, 20.0, "deg"),
        ("spread", 0.0, 0.2, "m"),
    ),
    "stops": (("reach", 0.0, 1.0, "m"), ("idle", 0.0, 1.0, "m")),
    "latched": (("reach", 0.0, 1.0, "m"),),
    "round_about": (("turn", 0.0, 360.0, "deg"),),
    "limited": (("reach", 0.0, 1.0, "m"),),
    "one_way": (("left", 0.0, 0.3, "m"), ("right", 0.0, 0.3, "m")),
}


def coded(name: str, head: str = "", **sweep: object) -> Recipe:
    """Return the recipe of one of this file's robots; `head` goes into [robot]."""
    axes = "".join(
        f'[[robot.parameter]]\nname = "{one}"\nmin = {low}\nmax = {high}\nunit = "{unit}"\n'
        for one, low, high, unit in AXES[name]
    )
    samples = ", ".join(f"{axis[0]} = 3" for axis in AXES[name])
    text = (
        f'[robot]\nname = "{name}"\nlength_unit = "m"\npython = "proofs.linkage:{name}"\n{head}\n'
    )
    return parse_recipe(text + axes + sweep_part(samples, **sweep), allow_python=True)  # type: ignore[arg-type]

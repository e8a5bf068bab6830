"""Robots whose positions, axes and radii are off by noise, against the same robots without it.

Owns the robots and the comparison: outside a band of ten times the noise over the width of support
no direction may change between standing and tipping.  Robots of which one does, and that are near a
threshold in each such direction, are listed and left out (`thresholds`).
"""

from typing import NamedTuple

import numpy as np

import lutgen
from lutgen.recipe import forward, radii_and_kinds
from lutgen.support import pack
from lutgen.support.region import TIPS
from lutgen.vector import Floats
from proofs.physics.asked import ask, directions, limits_for
from proofs.physics.thresholds import FAR, THRESHOLDS, thresholds_near

KINDS = (
    *("car, one rim", "car, two rims", "six wheels, one rim", "six wheels, two rims", "balls"),
    *("absolem, one rim", "absolem, both rims", "four feet, rounded"),
)
# Parts of the size.
NOISES = (0.0, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3)
# The narrowest support among these robots (length), and what rounding alone may do (rad).
WIDTH, ROUNDING = 0.3, 1e-9


class Compared(NamedTuple):
    """How many robots were tried, and of how many a direction is falsely safe or falsely tips.

    `near` are those left out, by the threshold that they are near: the five of `thresholds`.
    `suspects` are the primitives (n, 8) of each robot that is falsely safe, and the directions.
    """

    kind: str
    noise: float
    robots: int
    safe: int
    tips: int
    near: tuple[int, ...]
    suspects: tuple[tuple[Floats, Floats], ...] = ()


def _wheels(
    xs: tuple[float, ...], ys: tuple[float, float], radius: float, rims: int
) -> tuple[Floats, Floats, Floats]:
    centres = [
        [x, y + np.sign(y) * 0.04 * rim, -0.1] for x in xs for y in ys for rim in range(rims)
    ]
    return (
        np.array(centres),
        np.tile([0.0, 1.0, 0.0], (len(centres), 1)),
        np.full(len(centres), radius),
    )


def _absolem(rng: np.random.Generator, rims: int) -> tuple[Floats, Floats, Floats]:
    recipe = lutgen.load_recipe("maps/absolem.toml")
    low = np.array([one.minimum for one in recipe.parameters])
    high = np.array([one.maximum for one in recipe.parameters])
    found = forward(recipe, rng.uniform(low, high)[None])
    centres, axes, radius = found.centres[0], found.axes[0], radii_and_kinds(recipe)[0]
    if rims == 2:
        outwards = np.sign(centres[:, 1:2]) * [0.0, 0.05, 0.0]
        centres, axes = np.concatenate([centres, centres + outwards]), np.tile(axes, (2, 1))
        radius = np.tile(radius, 2)
    return centres, axes, radius


def _robot(kind: str, rng: np.random.Generator) -> tuple[Floats, Floats, Floats]:
    """Return centres about the com, axes and radii of one robot without noise."""
    com = rng.uniform([-0.05, -0.03, -0.05], [0.05, 0.03, 0.05])
    rims = 2 if kind.endswith(("two rims", "both rims")) else 1
    if kind.startswith("car"):
        centres, axes, radius = _wheels((-0.2, 0.2), (-0.15, 0.15), 0.1, rims)
    elif kind.startswith("six"):
        centres, axes, radius = _wheels((-0.3, 0.0, 0.3), (-0.2, 0.2), 0.1, rims)
    elif kind == "balls":
        centres, axes, radius = _wheels((-0.2, 0.2), (-0.15, 0.15), 0.05, 1)
        axes = 0.0 * axes
    elif kind.startswith("absolem"):
        centres, axes, radius = _absolem(rng, rims)
    else:
        corners = np.array([[x, y, -0.2] for x in (0.3, -0.3) for y in (0.2, -0.2)])
        centres = np.round(corners + rng.uniform(-0.03, 0.03, (4, 3)) * [1, 1, rng.integers(2)], 2)
        axes, radius = np.zeros((4, 3)), np.zeros(4)
    return centres - com, axes, radius


def compared(kind: str, noise: float, robots: int, count: int = 200, seed: int = 1) -> Compared:
    """Compare `robots` of a kind, each under `count` directions, with and without noise."""
    rng = np.random.default_rng(seed)
    exact, noisy = [], []
    size = 0.0
    for _ in range(robots):
        centres, axes, radius = _robot(kind, rng)
        size = float((np.linalg.norm(centres, axis=1) + radius).max())
        discs = np.abs(axes).sum(axis=1) > 0.0
        balls = np.where(discs, 2, np.where(radius > 0.0, 1, 0))
        exact.append(pack(centres, axes, radius, balls))
        turned = axes + np.where(discs[:, None], noise * rng.standard_normal(axes.shape), 0.0)
        turned /= np.where(discs, np.linalg.norm(turned, axis=1), 1.0)[:, None]
        moved = centres + noise * size * rng.standard_normal(centres.shape)
        grown = radius + np.where(radius > 0.0, noise * size * rng.standard_normal(len(radius)), 0)
        noisy.append(pack(moved, turned, grown, balls))
    limits, gravity_dir = limits_for(size), directions(rng, robots, count)
    want, away = ask(np.array(exact), limits, gravity_dir)
    got, _ = ask(np.array(noisy), limits, gravity_dir)
    changed = np.abs(away) > FAR * noise * size / WIDTH + ROUNDING
    changed &= (want == TIPS) != (got == TIPS)
    suspects, tips = [], 0
    near = np.zeros(len(THRESHOLDS), int)
    for m in np.flatnonzero(changed.any(axis=1)):
        here = changed[m]
        found = thresholds_near(exact[m], gravity_dir[m, here], noise * size, WIDTH, size)
        alone = ~found.any(axis=1)
        if alone.any():
            tipped = want[m] == TIPS
            tips += bool((~tipped[here])[alone].any())
            if tipped[here][alone].any():
                suspects.append((exact[m], gravity_dir[m, here & tipped]))
        else:
            near[found.any(axis=0).argmax()] += 1
    left = tuple(near.tolist())
    return Compared(kind, noise, robots, len(suspects), tips, left, tuple(suspects))


def table(rows: list[Compared]) -> str:
    """Return a table in Markdown: falsely safe / falsely tipping / left out, per kind and noise."""
    lines = ["| noise (sizes) | " + " | ".join(KINDS) + " |", "|---" * (len(KINDS) + 1) + "|"]
    for noise in NOISES:
        cells = [f"{r.safe} / {r.tips} / {sum(r.near)}" for r in rows if r.noise == noise]
        lines.append(f"| {noise:g} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def listed(rows: list[Compared]) -> str:
    """Return a table in Markdown of the robots left out, by the threshold that they are near."""
    lines = ["| robots near | " + " | ".join(THRESHOLDS) + " |", "|---" * 6 + "|"]
    for r in rows:
        if sum(r.near):
            counts = " | ".join(map(str, r.near))
            lines.append(f"| {r.kind}, noise {r.noise:g}, of {r.robots:,} | {counts} |")
    return "\n".join(lines) + "\n"

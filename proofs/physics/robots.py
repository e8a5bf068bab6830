"""Makers of seeded robots and slopes for the physics engine."""

import math
from collections.abc import Callable
from functools import cache

import numpy as np

import lutgen
from lutgen.recipe import Recipe
from proofs.physics.body import Floats, Posture, Solid, body, recipe_posture

Maker = Callable[[np.random.Generator], Posture]
SIDEWAYS = np.array([0.0, 1.0, 0.0])


def cap(rng: np.random.Generator, tilt: float) -> Floats:
    """Return a direction of gravity, uniform on the cap up to a tilt (deg)."""
    z = rng.uniform(math.cos(math.radians(tilt)), 1.0)
    psi = rng.uniform(0.0, 2.0 * math.pi)
    across = math.sqrt(1.0 - z * z)
    return np.array([across * math.cos(psi), across * math.sin(psi), -z])


def stance(rng: np.random.Generator, count: int, warp: float) -> Floats:
    """Return feet round a body of 0.15 to 0.6 m, the com 0.1 to 0.4 m above and off centre."""
    turn = np.sort(rng.uniform(0.0, 2.0 * math.pi, count))
    reach = rng.uniform(0.5, 1.0, count)
    width, length = rng.uniform(0.15, 0.6, 2) / 2.0
    z = -rng.uniform(0.1, 0.4) + rng.uniform(-warp, warp, count)
    feet = np.stack([length * reach * np.cos(turn), width * reach * np.sin(turn), z], axis=1)
    feet[:, :2] += rng.uniform(-0.04, 0.04, 2)
    return np.asarray(feet)


def points(most: int, warp: float) -> Maker:
    """Return a maker of bodies on three points or more."""
    return lambda rng: body(
        stance(rng, int(rng.integers(3, most + 1)), warp), mass=rng.uniform(1.0, 30.0)
    )


def balls(rng: np.random.Generator) -> Posture:
    """Return a body on 3 to 8 spheres of 1 to 10 cm."""
    n = int(rng.integers(3, 9))
    return body(stance(rng, n, 0.03), rng.uniform(0.01, 0.1, n), mass=rng.uniform(1.0, 30.0))


def corners(rng: np.random.Generator) -> Floats:
    """Return four wheel centres, the com 0.05 to 0.3 m above and off centre."""
    length, width = rng.uniform(0.2, 0.6, 2) / 2.0
    signs = np.array([[1, 1], [1, -1], [-1, 1], [-1, -1]])
    flat = signs * [length, width] + rng.uniform(-0.04, 0.04, 2)
    z = -rng.uniform(0.05, 0.3) + rng.uniform(-0.03, 0.03, 4)
    return np.column_stack([flat, z])


def thin_wheels(rng: np.random.Generator) -> Posture:
    """Return a car on four thin wheels of unequal heights, toed and cambered by up to 10 deg."""
    axes = SIDEWAYS + rng.uniform(-0.17, 0.17, (4, 3)) * [1, 0, 1]
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    return body(corners(rng), rng.uniform(0.05, 0.12), axes, rng.uniform(1.0, 30.0))


def wide_wheels(rng: np.random.Generator) -> Posture:
    """Return a car on four real cylinders 2 to 8 cm wide."""
    radius, half = rng.uniform(0.05, 0.12), rng.uniform(0.01, 0.04)
    solids = tuple(Solid("cylinder", c, radius, SIDEWAYS, half) for c in corners(rng))
    return Posture(solids, rng.uniform(1.0, 30.0))


def capsules(rng: np.random.Generator) -> Posture:
    """Return a body on 3 or 4 capsules that point anywhere."""
    solids = []
    for centre in stance(rng, int(rng.integers(3, 5)), 0.03):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        radius, half = rng.uniform(0.01, 0.05), rng.uniform(0.02, 0.1)
        solids.append(Solid("capsule", centre, radius, axis, half))
    return Posture(tuple(solids), rng.uniform(1.0, 30.0))


def flippers(wide: bool, rng: np.random.Generator) -> Posture:
    """Return a robot on four flippers at any four angles, thin discs or cylinders."""
    length, width, reach = rng.uniform(0.3, 0.6), rng.uniform(0.3, 0.6), rng.uniform(0.2, 0.4)
    root, half = rng.uniform(0.06, 0.12), rng.uniform(0.02, 0.04)
    tip = root * rng.uniform(0.3, 0.9)
    off = [*rng.uniform(-0.04, 0.04, 2), -rng.uniform(0.03, 0.15)]
    shape, half, solids = ("cylinder", half, []) if wide else ("disc", 0.0, [])
    for forward, side in ((1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)):
        hinge = np.array([forward * length, side * width, 0.0]) / 2.0 + off
        angle = rng.uniform(-math.pi, math.pi)
        out = np.array([forward * math.cos(angle), 0.0, math.sin(angle)])
        solids.append(Solid(shape, hinge, root, SIDEWAYS, half))
        solids.append(Solid(shape, hinge + reach * out, tip, SIDEWAYS, half))
    return Posture(tuple(solids), rng.uniform(1.0, 30.0))


def chair(rng: np.random.Generator) -> Posture:
    """Return a rocking chair: two rails of 3 to 10 thin wheels each, on arcs, the com above."""
    count, step = int(rng.integers(3, 11)), math.radians(rng.uniform(2.0, 12.0))
    arc, radius = rng.uniform(0.25, 0.6), rng.uniform(0.01, 0.06)
    angle = step * (np.arange(count) - (count - 1) / 2.0)
    rail = np.stack([arc * np.sin(angle), 0.0 * angle, -arc * np.cos(angle)], axis=1)
    half = rng.uniform(0.1, 0.3)
    com = [rng.uniform(-0.03, 0.03), rng.uniform(-0.05, 0.05), -arc + rng.uniform(0.05, 0.5)]
    centres = np.concatenate([rail + side * SIDEWAYS for side in (-half, half)]) - com
    return body(centres, radius, SIDEWAYS, rng.uniform(1.0, 30.0))


def any_params(recipe: Recipe, rng: np.random.Generator) -> Floats:
    """Return parameters (k,) anywhere in a recipe's ranges."""
    ends = np.array([(p.minimum, p.maximum) for p in recipe.parameters])
    return np.asarray(rng.uniform(*ends.T))


@cache
def gallery(name: str) -> Recipe:
    """Return the recipe of a gallery robot."""
    return lutgen.load_recipe(f"recipe:{name}")


def any_posture(name: str) -> Maker:
    """Return a maker of a gallery robot's postures."""
    return lambda rng: recipe_posture(gallery(name), any_params(gallery(name), rng))

"""Makers of seeded robots and slopes for the physics engine."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

import lutgen
from lutgen.recipe import Recipe
from proofs.physics.body import Floats, Posture, Solid, on_solids, recipe_postures, rigid_body

ROOT = Path(__file__).resolve().parent.parent.parent
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


def points(count: tuple[int, int], warp: float) -> Maker:
    """Return a maker of bodies on points."""

    def make(rng: np.random.Generator) -> Posture:
        n = int(rng.integers(count[0], count[1] + 1))
        return rigid_body(stance(rng, n, warp), mass=rng.uniform(1.0, 30.0))

    return make


def balls(rng: np.random.Generator) -> Posture:
    """Return a body on 3 to 8 spheres of 1 to 10 cm."""
    n = int(rng.integers(3, 9))
    return rigid_body(stance(rng, n, 0.03), rng.uniform(0.01, 0.1, n), mass=rng.uniform(1.0, 30.0))


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
    return rigid_body(corners(rng), rng.uniform(0.05, 0.12), axes, rng.uniform(1.0, 30.0))


def wide_wheels(rng: np.random.Generator) -> Posture:
    """Return a car on four real cylinders 2 to 8 cm wide."""
    radius, half = rng.uniform(0.05, 0.12), rng.uniform(0.01, 0.04)
    solids = tuple(Solid("cylinder", c, radius, SIDEWAYS, half) for c in corners(rng))
    return on_solids(solids, rng.uniform(1.0, 30.0))


def capsules(rng: np.random.Generator) -> Posture:
    """Return a body on 3 or 4 capsules that point anywhere."""
    solids = []
    for centre in stance(rng, int(rng.integers(3, 5)), 0.03):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        solids.append(
            Solid("capsule", centre, rng.uniform(0.01, 0.05), axis, rng.uniform(0.02, 0.1))
        )
    return on_solids(tuple(solids), rng.uniform(1.0, 30.0))


def flippers(wide: bool) -> Maker:
    """Return a maker of robots on four flippers at any four angles, thin discs or cylinders."""

    def make(rng: np.random.Generator) -> Posture:
        length, width, reach = rng.uniform(0.3, 0.6), rng.uniform(0.3, 0.6), rng.uniform(0.2, 0.4)
        root, half = rng.uniform(0.06, 0.12), rng.uniform(0.02, 0.04)
        tip = root * rng.uniform(0.3, 0.9)
        off = [*rng.uniform(-0.04, 0.04, 2), -rng.uniform(0.03, 0.15)]
        solids = []
        for forward in (1.0, -1.0):
            for side in (1.0, -1.0):
                hinge = np.array([forward * length, side * width, 0.0]) / 2.0 + off
                angle = rng.uniform(-math.pi, math.pi)
                out = np.array([forward * math.cos(angle), 0.0, math.sin(angle)])
                solids.append(Solid("cylinder", hinge, root, SIDEWAYS, half))
                solids.append(Solid("cylinder", hinge + reach * out, tip, SIDEWAYS, half))
        mass = rng.uniform(1.0, 30.0)
        if wide:
            return on_solids(tuple(solids), mass)
        centres = np.array([solid.centre for solid in solids])
        return rigid_body(centres, np.array([s.radius for s in solids]), SIDEWAYS, mass)

    return make


def flipper_recipe(name: str, independent: bool) -> Recipe:
    """Return a gallery robot of front and rear flippers, with an angle each or with all four."""
    text = (ROOT / "maps" / f"{name}.toml").read_text(encoding="utf-8")
    if not independent:
        return lutgen.parse_recipe(text)
    names = []
    for end in ("front", "rear"):
        both = [f"{end}_{side}" for side in ("left", "right")]
        for flipper in both:
            at = text.index(f'name = "{flipper}_flipper"')
            tail = text[at:].replace(f'parameter = "{end}"', f'parameter = "{flipper}"', 1)
            text = text[:at] + tail
        at = text.index(f'[[robot.parameter]]\nname = "{end}"\n')
        stop = text.index("\n\n", at) + 1
        block = text[at:stop]
        text = text[:at] + "".join(block.replace(end, flipper) for flipper in both) + text[stop:]
        names += both
    nodes = ", ".join(f"{name} = 9" for name in names)
    return lutgen.parse_recipe(text.replace("front = 37, rear = 37", nodes))


def any_posture(recipe: Recipe) -> Maker:
    """Return a maker of a recipe's postures, anywhere in its ranges."""
    low = np.array([p.minimum for p in recipe.parameters])
    high = np.array([p.maximum for p in recipe.parameters])

    def make(rng: np.random.Generator) -> Posture:
        return recipe_postures(recipe, rng.uniform(low, high)[None])[0]

    return make


def any_of(makers: tuple[Maker, ...]) -> Maker:
    """Return a maker that draws one of several."""

    def make(rng: np.random.Generator) -> Posture:
        return makers[int(rng.integers(len(makers)))](rng)

    return make

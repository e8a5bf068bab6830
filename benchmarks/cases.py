"""Robots that are measured: postures of point contacts, wheels, and recipes.

Every posture differs from every other, smoothly in two parameters as in a real sweep.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.support.primitive import pack

POINT, SPHERE, DISC = 0, 1, 2
KIND_NAMES = {POINT: "points", SPHERE: "spheres", DISC: "discs"}


class Case(NamedTuple):
    """A family of postures: `stance` is "inside" (com inside the hull) or "ground" (feet below)."""

    stance: str
    contacts: int


def wobble(points: NDArray[np.float64], postures: int, amount: float) -> NDArray[np.float64]:
    """Return (postures, n, 3) copies of points (n, 3), each coordinate moved by up to `amount`."""
    side = max(math.isqrt(postures), 1)
    index = np.arange(postures)
    first, second = (index // side) / side, (index % side) / side
    phase = np.random.default_rng(7).uniform(0.0, 2.0 * math.pi, (2, *points.shape))
    moved = np.sin(2.0 * first[:, None, None] + phase[0]) + np.sin(
        3.0 * second[:, None, None] + phase[1]
    )
    return np.asarray(points + 0.5 * amount * moved)


def evenly_spread(count: int) -> NDArray[np.float64]:
    """Return (count, 3) points on the unit sphere, along a Fibonacci spiral."""
    k = np.arange(count) + 0.5
    z = 1.0 - 2.0 * k / count
    angle = math.pi * (1.0 + math.sqrt(5.0)) * k
    radius = np.sqrt(1.0 - z * z)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1)


def points_of(case: Case) -> NDArray[np.float64]:
    """Return the contacts (n, 3) of a case before they are moved, relative to the com."""
    if case.stance == "ground":
        angle = 2.0 * math.pi * np.arange(case.contacts) / case.contacts + 0.3
        return np.stack([np.cos(angle), np.sin(angle), np.full(case.contacts, -0.6)], axis=1)
    if case.contacts == 8:
        return np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    return evenly_spread(case.contacts)


def point_shapes(case: Case, postures: int) -> NDArray[np.float64]:
    """Return the packed primitives (postures, n, 8) of a case."""
    centres = wobble(points_of(case), postures, 0.08)
    nothing = np.zeros(case.contacts)
    return pack(centres, np.zeros_like(centres), nothing, nothing)


def wheel_shapes(kind: int, count: int, postures: int) -> NDArray[np.float64]:
    """Return packed spheres or discs (postures, n, 8): wheels in two rows, axles along y."""
    index = np.arange(count)
    along = np.linspace(-1.0, 1.0, (count + 1) // 2)[index // 2] + 0.2 / count * (index % 2)
    aside = np.where(index % 2 == 0, -0.5, 0.5)
    centres = wobble(np.stack([along, aside, np.full(count, -0.3)], axis=1), postures, 0.03)
    axes = np.zeros_like(centres)
    if kind == DISC:
        axes[..., 1] = 1.0
    return pack(centres, axes, np.full(count, 0.15), np.full(count, kind))


def legged_recipe(
    legs: int, samples: tuple[int, int], gravity: str, channels: tuple[str, ...]
) -> str:
    """Return a recipe in TOML: a body on legs, whose even and odd ones turn in two groups.

    `gravity` holds the lines of [sweep.gravity] for chart, tilt and nodes.  The limits are wide.
    """
    lines = ['[robot]\nname = "bench"\nlength_unit = "m"\nupright = 180.0\nrock_angle = 45.0']
    for name in ("even", "odd"):
        lines.append(f'[[robot.parameter]]\nname = "{name}"\nmin = 5.0\nmax = 50.0\nunit = "deg"')
    for leg in range(legs):
        group = "odd" if leg % 2 else "even"
        lines.append(
            f'[[robot.link]]\nname = "leg{leg}"\nparent = "body"\n'
            f"rpy = [0, 0, {360.0 * leg / legs + 10.0 + 3.0 * (leg % 3)}]\n"
            f'joint = {{ type = "revolute", axis = [0, 1, 0], parameter = "{group}", '
            f"scale = {1.0 + 0.01 * leg} }}\nmass = 0.2\ncom = [0.5, 0, 0]\n"
            f'[[robot.contact]]\nname = "foot{leg}"\nlink = "leg{leg}"\nposition = [1.0, 0, 0]'
        )
    lines.append('[[robot.link]]\nname = "body"\nmass = 2.0\ncom = [0, 0, 0.1]')
    names = ", ".join(f'"{name}"' for name in channels)
    lines.append(
        f"[sweep]\nsamples = {{ even = {samples[0]}, odd = {samples[1]} }}\n"
        f"[sweep.gravity]\n{gravity}\nchannels = [{names}]\n"
    )
    return "\n".join(lines)

"""Masses and centres of mass of real robots, beside an independent library and published values."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lutgen.urdf.joints import Motion, read_motion
from lutgen.urdf.links import centre_of_mass, places
from lutgen.urdf.read import load_urdf
from tests.fixtures.robots import real

NAMES = ("absolem", "husky")
POSTURES = 100


def random_values(motion: Motion, rng: np.random.Generator) -> dict[str, float]:
    """Return a value within its limits for every free joint."""
    return {name: rng.uniform(low, high) for name, (low, high) in motion.free.items()}


def joint_values(motion: Motion, free: dict[str, float]) -> dict[str, float]:
    """Return the values of all moving joints, those that mimic another included."""
    return {
        name: drive.offset + (drive.scale * free[drive.by] if drive.by is not None else 0.0)
        for name, drive in motion.drives.items()
    }


def oracle(path: Path, values: dict[str, float]) -> tuple[float, list[float]]:
    """Return mass and com that pinocchio finds, the root at the origin.

    With a fixed root it leaves the mass of the root link out, and it does not know mimics here.
    """
    import pinocchio

    model = pinocchio.buildModelFromUrdf(str(path), pinocchio.JointModelFreeFlyer())
    data = model.createData()
    step = np.zeros(model.nv)
    for name, value in values.items():
        step[model.joints[model.getJointId(name)].idx_v] = value
    com = pinocchio.centerOfMass(
        model, data, pinocchio.integrate(model, pinocchio.neutral(model), step)
    )
    return float(data.mass[0]), com.tolist()


@pytest.mark.needs("robots", "pinocchio")
@pytest.mark.parametrize("name", NAMES)
def test_an_independent_library_finds_the_same_mass_and_com_in_every_posture(name: str) -> None:
    path = real(name)
    robot = load_urdf(path)
    motion = read_motion(robot)
    rng = np.random.default_rng(6)
    moved = []
    for number in range(POSTURES + 1):
        free = random_values(motion, rng) if number else dict.fromkeys(motion.free, 0.0)
        mass, com = oracle(path, joint_values(motion, free))
        ours = centre_of_mass(robot, places(robot, motion, free))
        assert math.fsum(link.mass for link in robot.links) == pytest.approx(mass, abs=1e-9)
        assert ours.tolist() == pytest.approx(com, abs=1e-9)
        moved.append(ours)
    # Otherwise one posture would do; the Husky's wheels turn about their own com.
    spread = float(np.ptp(moved, axis=0).max())
    assert spread > 0.01 if name == "absolem" else spread < 1e-12


@pytest.mark.needs("robots")
@pytest.mark.parametrize(
    ("name", "mass", "com"),
    # Published with these files (51.134 and 75.432 kg), by a library that gives 1 kg to every
    # link without <inertial>; the format gives it none, which is what this project does.
    [
        ("absolem", 51.13414, (-0.043, -0.0131, 0.1327)),
        ("husky", 75.432003, (0.0644, -0.0484, 0.0948)),
    ],
)
def test_one_kilogram_on_every_link_without_inertial_gives_the_published_com(
    name: str, mass: float, com: tuple[float, float, float]
) -> None:
    robot = load_urdf(real(name))
    loaded = replace(
        robot, links=tuple(link if link.mass else replace(link, mass=1.0) for link in robot.links)
    )
    where = places(loaded, read_motion(loaded))
    # A com of four published decimals.
    assert math.fsum(link.mass for link in loaded.links) == pytest.approx(mass, abs=1e-6)
    assert centre_of_mass(loaded, where).tolist() == pytest.approx(list(com), abs=1e-4)

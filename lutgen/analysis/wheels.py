"""Inverse kinematics of the wheels: from the robot's velocity to wheel speeds and steering.

Owns the rolling constraints and what follows from them: degrees of freedom, sideways slip, and
the nearest motion without it.  Where wheels touch and which way they roll is `rolling`'s.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from lutgen.analysis.ground_contact import Ground, RollingContact, find_ground
from lutgen.analysis.posture import Posture
from lutgen.errors import InputError
from lutgen.recipe import Recipe
from lutgen.vector import Floats

LEVEL = (0.0, 0.0, -1.0)
# Below this share nothing counts: a slip of the motion's speed, a singular value of the largest.
# A millionth is what numbers typed with six digits leave over, and axles that cross a million
# robot sizes away are parallel.
TOLERANCE = 1e-6


@dataclass(frozen=True)
class Structure:
    """How the wheels that touch let the robot move in the contact plane.

    `dof` is 3 - rank of the constraints of the fixed wheels: every motion that some setting of
    the steered wheels allows.  `steered` tells whether a steered wheel touches.  `mobility` and
    `steerability` are the degrees of Campion, Bastin and d'Andrea-Novel (IEEE Trans. Robotics
    and Automation 12(1), 1996): motions without turning a steered wheel, and how many steered
    wheels can be turned independently; they add up to `dof`.  `touching` are the contacts of the
    wheels that touch.
    """

    dof: int
    steered: bool
    mobility: int
    steerability: int
    touching: tuple[str, ...]

    @property
    def category(self) -> str:
        """The paper's category, for example "2 DoF, steered"."""
        return f"{self.dof} DoF, {'steered' if self.steered else 'non-steered'}"


@dataclass(frozen=True)
class WheelMotion:
    """What one wheel does: `speed` in rad/s, `steering` in rad, `slip` in length/s.

    `contact` names the wheel.  Of a wheel that hovers all three are None.  `speed` is positive
    about the axle, the right-hand way.  `steering`, None unless the wheel is steered, is the
    angle about the ground's normal, anticlockwise seen from above, from how the recipe places the
    axle, in (-pi/2, pi/2].  `slip` is the velocity to the left of the rolling direction at which
    a fixed wheel is dragged over the ground; rollers and steering take it up, theirs is 0.
    """

    contact: str
    touches: bool
    speed: float | None
    steering: float | None
    slip: float | None


@dataclass(frozen=True)
class Motion:
    """Wheel speeds for one motion of the centre of mass; lengths in the recipe's unit.

    `velocity` (2,) and `yaw_rate` are those asked for.  `slip` is the root of the sum of squares
    of the wheels' slips: no choice of speeds and steering angles makes it smaller.  `possible` is
    true where it vanishes.  `nearest_velocity` (2,) and `nearest_yaw_rate` are the motion without
    slip that differs least from the one asked for: least sum of squares, with yaw rates times
    the distance from the com to the farthest corner of the support polygon.  They are the motion
    itself where it is possible.  `standing` is false where the robot tips.
    """

    velocity: tuple[float, float]
    yaw_rate: float
    wheels: tuple[WheelMotion, ...]
    slip: float
    possible: bool
    nearest_velocity: tuple[float, float]
    nearest_yaw_rate: float
    structure: Structure
    standing: bool


def structure(posture: Posture, gravity_dir: ArrayLike = LEVEL) -> Structure:
    """Categorise the robot by the degrees of freedom that its wheels leave it.

    Contacts without a wheel are taken to slide or swivel and constrain nothing, like wheels that
    hover and Swedish wheels.

    Parameters
    ----------
    posture : Posture
        Of a robot with wheels; InputError is raised as by `ground_contact.find_ground`.
    gravity_dir : (3,) array_like
        Pointing down, body frame, any length > 0: it chooses the support facet and nothing else.
    """
    return _structure(find_ground(posture, gravity_dir))


def wheel_speeds(
    posture: Posture,
    velocity: ArrayLike,
    yaw_rate: float,
    gravity_dir: ArrayLike = LEVEL,
) -> Motion:
    """Compute the wheel speeds and steering angles of a motion in the contact plane.

    A fixed or steered wheel rolls with v . t = r * speed, a Swedish wheel with
    v . e = r * speed * cos(gamma), where v is the robot's velocity at the contact, t the rolling
    direction and e the axis of the roller on the ground, t turned by gamma (Siegwart and
    Nourbakhsh, Introduction to Autonomous Mobile Robots, section 3.2.3).

    Parameters
    ----------
    posture : Posture
        Of a robot with wheels.
    velocity : (2,) array_like
        Velocity of the centre of mass, length per second: along the part of the body's x axis in
        the contact plane, and to the left of it.
    yaw_rate : float
        Angular velocity about the plane's upward normal, rad/s.
    gravity_dir : (3,) array_like
        Pointing down, body frame, any length > 0: it chooses the support facet and nothing else.

    Returns
    -------
    Motion
        Also of an impossible motion, with its slip.  A steered wheel that is slower than a
        millionth of the motion keeps the angle 0 and the speed 0.

    Raises
    ------
    InputError
        As for `ground_contact.find_ground`, and where the motion is not three finite numbers.
    """
    asked = np.asarray(velocity, np.float64)
    if asked.shape != (2,) or not np.isfinite(asked).all():
        raise InputError(
            f"velocity must be two finite numbers (got {asked.tolist()}); give it forward and to "
            "the left"
        )
    if not math.isfinite(yaw_rate):
        raise InputError(f"yaw_rate must be finite (got {yaw_rate}); give an angle per second")
    ground = find_ground(posture, gravity_dir)
    with np.errstate(over="ignore", invalid="ignore"):
        motion = _motion(posture.recipe, ground, asked, float(yaw_rate))
    results = [motion.slip, motion.nearest_yaw_rate, *motion.nearest_velocity]
    results += [wheel.speed for wheel in motion.wheels if wheel.speed is not None]
    if not all(map(math.isfinite, results)):
        raise InputError(
            f"{posture.recipe.source}: the motion gives wheel speeds beyond all numbers (got "
            f"velocity {asked.tolist()} and yaw_rate {yaw_rate}); choose a slower one"
        )
    return motion


def _motion(recipe: Recipe, ground: Ground, asked: Floats, yaw_rate: float) -> Motion:
    """Return the motion of the wheels on the ground; what is too large becomes inf or NaN."""
    motion = np.array([asked[0], asked[1], yaw_rate * ground.size])
    still = TOLERANCE * math.hypot(*motion)
    wheels = tuple(
        WheelMotion(wheel.contact, False, None, None, None)
        if contact is None
        else _wheel_motion(contact, contact.velocity(asked, yaw_rate), still)
        for wheel, contact in zip(recipe.wheels, ground.contacts, strict=True)
    )
    slip = math.hypot(*(wheel.slip or 0.0 for wheel in wheels))
    stretch, basis = _free_motions(ground)
    possible = slip <= stretch * still
    nearest = motion if possible else basis @ (basis.T @ motion)
    return Motion(
        (float(asked[0]), float(asked[1])),
        yaw_rate,
        wheels,
        slip,
        possible,
        (float(nearest[0]), float(nearest[1])),
        yaw_rate if possible else float(nearest[2]) / ground.size,
        _structure(ground),
        ground.standing,
    )


def _wheel_motion(contact: RollingContact, velocity: Floats, still: float) -> WheelMotion:
    """Return what a wheel does whose contact moves at `velocity`; below `still` it stands."""
    wheel = contact.wheel
    along = float(velocity @ contact.rolling)
    across = float(velocity @ contact.sideways)
    if wheel.rollers is not None:
        # v . e / cos(gamma), with e = cos(gamma) t + sin(gamma) s.
        speed = (along + across * math.tan(wheel.rollers)) / wheel.radius
        return WheelMotion(wheel.contact, True, speed, None, 0.0)
    if not wheel.steered:
        return WheelMotion(wheel.contact, True, along / wheel.radius, None, across)
    total = math.hypot(along, across)
    if total <= still:
        return WheelMotion(wheel.contact, True, 0.0, 0.0, 0.0)
    if abs(along) <= TOLERANCE * total:
        # Exactly sideways: rounding must not choose between -90 and 90 deg.
        return WheelMotion(wheel.contact, True, across / wheel.radius, math.pi / 2.0, 0.0)
    speed = math.copysign(total, along) / wheel.radius
    return WheelMotion(wheel.contact, True, speed, math.atan(across / along), 0.0)


def _free_motions(ground: Ground) -> tuple[float, Floats]:
    """Return the largest slip per motion of size 1, and an orthonormal basis of those without.

    Motions are (vx, vy, yaw rate * size), so that neither depends on the unit of length.  The slip
    is the largest singular value of the fixed wheels' constraints, 0 without any; the basis
    (3, dof) is their null space, one motion per column.
    """
    rows = [
        [*contact.sideways, contact.sideways @ contact.velocity(np.zeros(2), 1.0) / ground.size]
        for contact in ground.contacts
        if contact is not None and not contact.wheel.steered and contact.wheel.rollers is None
    ]
    if not rows:
        return 0.0, np.eye(3)
    _, spread, motions = np.linalg.svd(np.array(rows))
    rank = int((spread > TOLERANCE * spread[0]).sum())
    return float(spread[0]), motions[rank:].T.copy()


def _structure(ground: Ground) -> Structure:
    """Return the structure of a robot on the ground."""
    contacts = [contact for contact in ground.contacts if contact is not None]
    steered = [contact for contact in contacts if contact.wheel.steered]
    _, basis = _free_motions(ground)
    dof = basis.shape[1]
    turning = sum(_can_turn(contact, basis, ground.size) for contact in steered)
    # Two wheels' axles fix the centre of turning: further ones must follow.
    steerability = min(turning, max(dof - 1, 0))
    touching = tuple(contact.wheel.contact for contact in contacts)
    return Structure(dof, bool(steered), dof - steerability, steerability, touching)


def _can_turn(contact: RollingContact, basis: Floats, size: float) -> bool:
    """Tell whether the free motions move a contact in more than one direction.

    A steered wheel on the common axle of the fixed ones can only follow them.
    """
    moved = [contact.velocity(motion[:2], motion[2] / size) for motion in basis.T]
    if len(moved) < 2:
        return False
    spread = np.linalg.svd(np.array(moved), compute_uv=False)
    return bool(spread[1] > TOLERANCE * spread[0])

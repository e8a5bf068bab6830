"""Inverse kinematics of the wheels: from the robot's velocity to wheel speeds and steering.

Places and directions have two components, in the contact plane's frame: the plane of the support
facet with its normal up, x along the body's x axis and y to the left, its origin below the com.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from lutgen.analysis.diagnosis import diagnose
from lutgen.analysis.posture import Facet, Posture
from lutgen.errors import InputError, reject
from lutgen.parts import Wheel
from lutgen.recipe import forward
from lutgen.support import FACE_ANGLE
from lutgen.vector import Floats

LEVEL = (0.0, 0.0, -1.0)
# Below this share nothing counts: a slip of the motion's speed, a singular value of the largest.
# A millionth is what numbers typed with six digits leave over, and axles that cross a million
# robot sizes away are parallel.
TOLERANCE = 1e-6
# Products of speeds, sizes and radii up to this are numbers.
FASTEST = 1e100


@dataclass(frozen=True)
class WheelMotion:
    """Motion of one wheel: `speed` in rad/s, `steering` in rad, `slip` in length/s.

    `contact` names the wheel.  All three are None for a wheel that hovers.  `speed` is positive
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

    `velocity` (2,) and `yaw_rate` are those requested.  `slip` is the root of the sum of squares
    of the wheels' slips: no choice of speeds and steering angles makes it smaller, and the motion
    is `possible` where it vanishes.  `nearest_velocity` (2,) and `nearest_yaw_rate` are the motion
    without slip that differs least from the requested one: least sum of squares, yaw rates times
    the distance from the com to the farthest corner of the support polygon.  `dof` is 3 - rank of
    the constraints of the fixed wheels that touch: every motion that some setting of the steered
    wheels allows, of which one is there if the robot is `steered`.  Swedish wheels and contacts
    without a wheel constrain nothing.
    """

    velocity: tuple[float, float]
    yaw_rate: float
    wheels: tuple[WheelMotion, ...]
    slip: float
    possible: bool
    nearest_velocity: tuple[float, float]
    nearest_yaw_rate: float
    dof: int
    steered: bool
    standing: bool

    @property
    def category(self) -> str:
        """The paper's category, for example "2 DoF, steered"."""
        return f"{self.dof} DoF, {'steered' if self.steered else 'non-steered'}"


@dataclass(frozen=True)
class _Rolling:
    """A wheel on the ground: where it touches, and unit vectors (2,) ahead and to its left."""

    wheel: Wheel
    point: Floats
    ahead: Floats
    left: Floats

    def velocity(self, velocity: Floats, yaw_rate: float) -> Floats:
        """Return the velocity (2,) of the robot at this contact: v + w n x (p - com)."""
        return velocity + yaw_rate * np.array([-self.point[1], self.point[0]])


def _find_ground(posture: Posture, gravity_dir: ArrayLike) -> tuple[Facet, Floats, bool]:
    """Find the facet on the ground, the axes x and y (2, 3) in it, and if the robot stands."""
    source = posture.recipe.source
    if not posture.recipe.wheels:
        way_out = "add one for each contact that is a wheel: contact, axis, radius"
        reject(source, "the robot has no wheels", "no [[robot.wheel]]", way_out, InputError)
    found = diagnose(posture, gravity_dir)
    way_out = "choose another direction or posture"
    if found.facet is None:
        what = "the robot has no support facet under this gravity"
        reject(source, what, f"gravity_dir = {found.gravity_dir.tolist()}", way_out, InputError)
    facet, forward_axis = found.facet, np.array([1.0, 0.0, 0.0])
    if float(np.linalg.norm(facet.along(forward_axis))) < FACE_ANGLE:
        what = "the body's x axis is normal to the ground, which leaves no forward direction"
        reject(source, what, f"the normal {(-facet.normal).tolist()}", way_out, InputError)
    # y of a facet's frame points to the right.
    return facet, facet.frame(forward_axis) * [[1.0], [-1.0]], found.standing


def _touching(posture: Posture, facet: Facet, frame: Floats) -> tuple[_Rolling | None, ...]:
    """Return where each wheel touches the facet's plane and how it rolls, None where it hovers."""
    recipe = posture.recipe
    carriers = {contact.name: contact for contact in recipe.contacts}
    # An axle turns with its link as the axis of a disc does, so let the contacts have the axles.
    discs = tuple(replace(carriers[wheel.contact], axis=wheel.axis) for wheel in recipe.wheels)
    axles = forward(replace(recipe, contacts=discs), posture.row).axes[0]
    result: list[_Rolling | None] = []
    for wheel, axle in zip(recipe.wheels, axles, strict=True):
        i = recipe.contact_names.index(wheel.contact)
        if i not in facet.touching:
            result.append(None)
            continue
        # axle x up: a wheel whose axle points left drives forward when it spins positively.
        ahead = frame @ np.cross(axle, -facet.normal)
        length = float(np.linalg.norm(ahead))
        if length < FACE_ANGLE:
            what = f"the wheel on {wheel.contact} cannot roll, its axle is normal to the ground"
            way_out = "correct its `axis`, or choose another posture"
            reject(recipe.source, what, f"{axle.tolist()} in the body frame", way_out, InputError)
        point, ahead = facet.touching_points[facet.touching.index(i)], ahead / length
        left = np.array([-ahead[1], ahead[0]])
        result.append(_Rolling(wheel, frame @ point, ahead, left))
    return tuple(result)


def wheel_speeds(
    posture: Posture, velocity: ArrayLike, yaw_rate: float, gravity_dir: ArrayLike = LEVEL
) -> Motion:
    """Compute the wheel speeds and steering angles of a motion in the contact plane.

    A fixed or steered wheel rolls with v . t = r * speed, a Swedish wheel with
    v . e = r * speed * cos(gamma), where v is the robot's velocity at the contact, t the rolling
    direction and e the axis of the roller on the ground, t turned by gamma (Siegwart and
    Nourbakhsh, Introduction to Autonomous Mobile Robots, section 3.2.3).

    `velocity` (2,) is that of the centre of mass, length per second: along the part of the body's x
    axis in the contact plane, and to the left of it.  `yaw_rate` is about the plane's upward
    normal, rad/s.  `gravity_dir` (3,) is down, body frame, any length > 0; it only chooses the
    support facet.  An impossible motion comes with its slip.  A steered wheel that is slower than a
    millionth of the motion keeps the angle 0 and the speed 0.
    """
    requested = np.array([*np.ravel(velocity), yaw_rate], np.float64)
    if requested.shape != (3,) or not (np.abs(requested) <= FASTEST).all():
        what = f"velocity must be two numbers, and yaw_rate one, of up to {FASTEST:g}"
        way_out = "give lengths per second, forward and to the left, and rad/s"
        reject(posture.recipe.source, what, requested.tolist(), way_out, InputError)
    facet, frame, standing = _find_ground(posture, gravity_dir)
    contacts = _touching(posture, facet, frame)
    # The largest distance in the plane from the com to a corner of the support polygon.
    size = float(np.linalg.norm(facet.points @ frame.T, axis=1).max())
    velocity, yaw_rate = requested[:2], float(requested[2])
    motion = requested * [1.0, 1.0, size]
    still = TOLERANCE * math.hypot(*motion)
    wheels = tuple(
        WheelMotion(wheel.contact, False, None, None, None)
        if contact is None
        else _wheel_motion(contact, contact.velocity(velocity, yaw_rate), still)
        for wheel, contact in zip(posture.recipe.wheels, contacts, strict=True)
    )
    slip = math.hypot(*(wheel.slip or 0.0 for wheel in wheels))
    touching = [contact for contact in contacts if contact is not None]
    stretch, basis = _free_motions(touching, size)
    possible = slip <= stretch * still
    nearest = motion if possible else basis @ (basis.T @ motion)
    turn = yaw_rate if possible else float(nearest[2]) / size
    return Motion(
        (float(requested[0]), float(requested[1])),
        yaw_rate,
        wheels,
        slip,
        possible,
        nearest_velocity=(float(nearest[0]), float(nearest[1])),
        nearest_yaw_rate=turn,
        dof=basis.shape[1],
        steered=any(one.wheel.steered for one in touching),
        standing=standing,
    )


def _wheel_motion(contact: _Rolling, velocity: Floats, still: float) -> WheelMotion:
    """Return what a wheel does whose contact moves at `velocity`; below `still` it stands."""
    wheel = contact.wheel
    along = float(velocity @ contact.ahead)
    across = float(velocity @ contact.left)
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


def _free_motions(contacts: list[_Rolling], size: float) -> tuple[float, Floats]:
    """Return the largest slip per motion of size 1, and an orthonormal basis (3, dof) without.

    Motions are (vx, vy, yaw rate * size), so that neither depends on the unit of length.
    """
    rows = [
        [*contact.left, contact.left @ contact.velocity(np.zeros(2), 1.0) / size]
        for contact in contacts
        if not contact.wheel.steered and contact.wheel.rollers is None
    ]
    if not rows:
        return 0.0, np.eye(3)
    _, spread, motions = np.linalg.svd(np.array(rows))
    rank = int((spread > TOLERANCE * spread[0]).sum())
    return float(spread[0]), motions[rank:].T.copy()

"""Where the wheels of a posture touch the ground, and which way they roll there.

Owns the contact plane's frame: the plane of the support facet with its normal up, x along the
body's x axis and y to the left, its origin below the centre of mass.  Places and directions in it
have two components.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from lutgen.analysis.diagnosis import diagnose
from lutgen.analysis.posture import Facet, Posture
from lutgen.errors import InputError
from lutgen.parts import Wheel
from lutgen.recipe import forward
from lutgen.support import FACE_ANGLE
from lutgen.vector import Floats


@dataclass(frozen=True)
class RollingContact:
    """A wheel on the ground, in the contact plane's frame.

    `point` (2,): where it touches, relative to the com; `rolling` (2,): unit vector along which
    it drives when it spins positively about its axle, the right-hand way.
    """

    wheel: Wheel
    point: Floats
    rolling: Floats

    @property
    def sideways(self) -> Floats:
        """Unit vector (2,) to the left of the rolling direction."""
        return np.array([-self.rolling[1], self.rolling[0]])

    def velocity(self, velocity: Floats, yaw_rate: float) -> Floats:
        """Return the velocity (2,) of the robot at this contact: v + w n x (p - com)."""
        return velocity + yaw_rate * np.array([-self.point[1], self.point[0]])


@dataclass(frozen=True)
class Ground:
    """What a posture's wheels have to roll on.

    `size`: the largest distance in the plane from the com to a corner of the support polygon, by
    which yaw rates become comparable with velocities.  `contacts`: of the wheels in recipe order,
    None for those that hover.  `standing` is false where the robot tips.
    """

    size: float
    standing: bool
    contacts: tuple[RollingContact | None, ...]


def find_ground(posture: Posture, gravity_dir: ArrayLike) -> Ground:
    """Find the contact plane of one posture and the wheels that touch it.

    A wheel touches if its contact is one of the facet's `touching`.  InputError is raised
    without wheels or without a support facet under this gravity (3,), and where the body's x axis,
    or the axle of a wheel that touches, is normal to the facet.
    """
    source = posture.recipe.source
    if not posture.recipe.wheels:
        raise InputError(
            f"{source}: the robot has no wheels (got no [[robot.wheel]]); add one for each "
            "contact that is a wheel: contact, axis, radius."
        )
    found = diagnose(posture, gravity_dir)
    if found.facet is None:
        raise InputError(
            f"{source}: the robot has no support facet under this gravity (got gravity_dir "
            f"= {found.gravity_dir.tolist()}); choose another direction or posture."
        )
    facet, forward_axis = found.facet, np.array([1.0, 0.0, 0.0])
    if float(np.linalg.norm(facet.along(forward_axis))) < FACE_ANGLE:
        raise InputError(
            f"{source}: the body's x axis is normal to the ground, which leaves no forward "
            f"direction (got the normal {(-facet.normal).tolist()}); choose another direction or "
            "posture."
        )
    # The y axis of this room's questions about driving points to the left.
    frame = facet.frame(forward_axis) * [[1.0], [-1.0]]
    size = float(np.linalg.norm(facet.points @ frame.T, axis=1).max())
    return Ground(size, found.standing, _touching(posture, facet, frame))


def wheel_axes(posture: Posture) -> Floats:
    """Return the axles (n, 3) of the wheels of one posture as unit vectors, body frame."""
    recipe = posture.recipe
    carriers = {contact.name: contact for contact in recipe.contacts}
    # An axle turns with its link as the axis of a disc does, so let the contacts have the axles.
    discs = tuple(replace(carriers[wheel.contact], axis=wheel.axis) for wheel in recipe.wheels)
    axes: Floats = forward(replace(recipe, contacts=discs), posture.row).axes[0]
    return axes


def _touching(posture: Posture, facet: Facet, frame: Floats) -> tuple[RollingContact | None, ...]:
    """Return where each wheel touches the facet's plane and how it rolls, or None."""
    recipe = posture.recipe
    result: list[RollingContact | None] = []
    for wheel, axle in zip(recipe.wheels, wheel_axes(posture), strict=True):
        i = recipe.contact_names.index(wheel.contact)
        if i not in facet.touching:
            result.append(None)
            continue
        # axle x up: a wheel whose axle points left drives forward when it spins positively.
        rolling = frame @ np.cross(axle, -facet.normal)
        length = float(np.linalg.norm(rolling))
        if length < FACE_ANGLE:
            raise InputError(
                f"{recipe.source}: the wheel on {wheel.contact} cannot roll, its axle is normal to "
                f"the ground (got {axle.tolist()} in the body frame); correct its `axis`, or "
                "choose another posture."
            )
        point = facet.touching_points[facet.touching.index(i)]
        result.append(RollingContact(wheel, frame @ point, rolling / length))
    return tuple(result)

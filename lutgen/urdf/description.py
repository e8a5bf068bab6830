"""The contents of a robot description: links, collision shapes and joints, as plain values."""

import math
from dataclasses import dataclass, field

from lutgen.parts import ZERO, Vector


@dataclass(frozen=True)
class Collision:
    """A collision shape, placed in its link's frame.

    `kind` is ``"sphere"`` with size (radius,), ``"cylinder"`` or ``"capsule"`` (radius, length
    without the ends; along z), ``"box"`` (x, y, z), ``"mesh"`` with the name of a `file` and its
    `scale`, neither checked, ``"points"`` (x, y, z, x, ...) of a mesh that was opened, or the name
    of any other geometry, with size ().  `note` says how it was guessed, or why it was not.
    """

    kind: str
    size: tuple[float, ...]
    origin: Vector = ZERO
    rpy: Vector = ZERO
    file: str = ""
    scale: tuple[float, ...] = ()
    note: str = ""


@dataclass(frozen=True)
class UrdfLink:
    """A link: mass in kg, com in its frame (m); without an inertial the mass is 0.

    `visuals` are its looks, of a link without collision shapes.
    """

    name: str
    mass: float = 0.0
    com: Vector = ZERO
    collisions: tuple[Collision, ...] = ()
    visuals: tuple[Collision, ...] = ()


@dataclass(frozen=True)
class Mimic:
    """Value of a joint: multiplier * value of `joint` + offset."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class UrdfJoint:
    """A joint: T = Trans(origin) * Rz(yaw) Ry(pitch) Rx(roll) * motion in its parent.

    `kind` is one of ``JOINT_KINDS``; `lower` and `upper` (rad or m) are infinite where there is no
    limit; `effort` is the greatest of its motor, None where it is not said, and `soft` has the
    limits of a controller.
    """

    name: str
    kind: str
    parent: str
    child: str
    origin: Vector = ZERO
    rpy: Vector = ZERO
    axis: Vector = (1.0, 0.0, 0.0)
    lower: float = -math.inf
    upper: float = math.inf
    mimic: Mimic | None = None
    effort: float | None = None
    soft: tuple[float, float] | None = None


@dataclass(frozen=True)
class UrdfRobot:
    """A checked description: a tree of links under `root`.

    `links` and `joints` are in the order of the file; `ignored` counts other children of <robot>;
    `rounded` has the angles, as printed, that were taken for parts of a turn; `unknown` counts
    elements and attributes that the format does not have.
    """

    name: str
    source: str
    root: str
    links: tuple[UrdfLink, ...]
    joints: tuple[UrdfJoint, ...]
    ignored: dict[str, int]
    rounded: tuple[str, ...] = ()
    unknown: dict[str, int] = field(default_factory=dict)

    @property
    def above(self) -> dict[str, UrdfJoint]:
        """The joint that carries each link but the root."""
        return {joint.child: joint for joint in self.joints}

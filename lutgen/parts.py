"""The parts of a robot: parameters, links, joints, contacts, axles, wheels and forces.

Data with every angle in radians, and the order of the tree that links make; nothing is known here
of how they are written down (`recipe`, `urdf`) or of how a robot moves.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from typing import Any

from lutgen.errors import InputError

# Here and not in `lutgen.arrays`: the help of the commands does without NumPy.
Vector = tuple[float, float, float]
ZERO: Vector = (0.0, 0.0, 0.0)
# Share of a parameter's limits by which a value may be beyond them.
ROUNDING = 1e-9
# Contact primitives; in arrays a kind is its place here.  Kernels know these places, so the digest
# of their cache must cover this file, and does by the name of `lutgen.jit`.
KINDS = ("point", "sphere", "disc")


def to_internal(values: Any, unit: str) -> Any:
    """Turn a number or an array of numbers that people write into rad or length."""
    return values * (math.pi / 180.0) if unit == "deg" else values


def to_display(values: Any, unit: str) -> Any:
    """Turn rad or length into a unit that people read; the inverse of `to_internal`."""
    return values * (180.0 / math.pi) if unit == "deg" else values


@dataclass(frozen=True)
class Parameter:
    """A geometry parameter: one axis of the map, with its limits in `unit`, rad or length.

    `display_unit` is the recipe's own, and `meaning` what figures say of its values.
    """

    name: str
    minimum: float
    maximum: float
    unit: str
    display_unit: str
    meaning: str = ""

    def shown(self, values: Any) -> Any:
        """Turn values, numbers or arrays, into the unit in which the recipe writes them."""
        return to_display(values, self.display_unit)

    def stored(self, values: Any) -> Any:
        """Turn values in the recipe's unit into rad or length."""
        return to_internal(values, self.display_unit)

    def require(self, values: Any, where: str, low: float, high: float) -> None:
        """Refuse values (m,) below `low` or above `high`, limits (rad or length) of `where`."""
        # Angles in deg round when they become rad.
        rounding = ROUNDING * max(high - low, abs(low), abs(high))
        inside = (low - rounding <= values) & (values <= high + rounding)
        if not inside.all():
            row = int(inside.argmin())
            got = f"{self.shown(values[row]):.6g}"
            if self.display_unit == "deg":
                got += f" deg = {values[row]:.6g} rad"
            raise InputError(
                f"{where}: parameter {self.name} must lie in {self.shown(low):g} to "
                f"{self.shown(high):g} {self.display_unit} (got {got}"
                f"{f' in row {row}' if len(values) > 1 else ''}); the limits are in that file."
            )


@dataclass(frozen=True)
class Joint:
    """A joint of value scale * parameter + offset (rad or length), about or along `axis`."""

    kind: str
    axis: Vector
    parameter: str
    scale: float
    offset: float


@dataclass(frozen=True)
class Link:
    """A rigid part: T = Trans(origin) * Rz(yaw) Ry(pitch) Rx(roll) * joint in its parent.

    `origin` and `com` are in the length unit, `rpy` in rad; `com` is in the link's frame.
    For figures: `shape`, the sides (length) of a box, and its middle, else the com, `shape_at`.
    """

    name: str
    parent: str | None = None
    origin: Vector = ZERO
    rpy: Vector = ZERO
    joint: Joint | None = None
    mass: float = 0.0
    com: Vector = ZERO
    shape: Vector | None = None
    shape_at: Vector | None = None


@dataclass(frozen=True)
class Contact:
    """A contact primitive; `position` is its centre and `axis` a unit vector, link frame.

    One that is `rolling` turns freely: a disc about its axis, a sphere in every direction.
    For figures: `width` of a disc along its axis (length, 0 unknown), and the `belt` about it.
    """

    name: str
    link: str
    position: Vector
    radius: float = 0.0
    axis: Vector | None = None
    rolling: bool = False
    width: float = 0.0
    belt: str = ""

    @property
    def kind(self) -> str:
        """``"point"``, ``"sphere"`` or ``"disc"``."""
        if self.radius == 0.0:
            return "point"
        return "sphere" if self.axis is None else "disc"


@dataclass(frozen=True)
class Axle:
    """An axle that swings freely about a line, and the two contacts that it carries.

    `pivot` is a point of the line and `axis` a unit vector along it, in the frame of `link`.  The
    robot is described with the axle in mid-swing, which `stops` (rad) end on either side.
    """

    name: str
    contacts: tuple[str, str]
    link: str
    pivot: Vector
    axis: Vector
    stops: float | None = None


@dataclass(frozen=True)
class Wheel:
    """A wheel on the contact of that name; `axis` is its axle, a unit vector, link frame.

    A steered wheel may turn about the ground's normal.  `rollers` (rad) is the angle of a Swedish
    wheel from the rolling direction to the axis of the roller on the ground, anticlockwise.
    """

    contact: str
    axis: Vector
    radius: float
    steered: bool = False
    rollers: float | None = None


@dataclass(frozen=True)
class Group:
    """Contacts that carry their share of the weight together, such as those of an axle."""

    name: str
    contacts: tuple[str, ...]


@dataclass(frozen=True)
class Force:
    """A force on a link, constant in the body frame, and a moment.

    `position` is where it acts, in the link's frame; `force` in N and `moment` in N times the
    length unit, both along the body's axes.
    """

    name: str
    link: str
    position: Vector
    force: Vector
    moment: Vector = ZERO

    @property
    def acts(self) -> bool:
        """True if it does anything at all."""
        return any(self.force) or any(self.moment)


def way_up(parents: Mapping[str, str | None], name: str | None) -> list[str]:
    """Return a name, its parent, the parent of that, and so on."""
    way: list[str] = []
    while name is not None and name not in way:
        way.append(name)
        name = parents.get(name)
    return way


def parents_first(parents: Mapping[str, str | None]) -> tuple[list[str], list[str]]:
    """Return the names with parents before children, or a loop; a root has the parent None.

    The order is by the distance from the root, otherwise as given, and empty where there is a loop.

    Examples
    --------
    >>> parents_first({"foot": "leg", "leg": "body", "body": None})
    (['body', 'leg', 'foot'], [])
    >>> parents_first({"foot": "leg", "leg": "foot"})
    ([], ['foot', 'leg', 'foot'])
    """
    above = {name: [] if parent is None else [parent] for name, parent in parents.items()}
    depth: dict[str, int] = {}
    try:
        for name in TopologicalSorter(above).static_order():
            depth[name] = depth.get(parents[name] or "", -1) + 1
    except CycleError as error:
        return [], error.args[1][::-1]
    return sorted(parents, key=depth.__getitem__), []

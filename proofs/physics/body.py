"""Build one rigid robot for the physics engine, and the same for lutgen.

Solids become an MJCF model, and contact primitives with a recipe without parameters.  Lengths in m,
relative to the com, body frame.
"""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import lutgen
from lutgen.recipe import Recipe, forward, radii_and_kinds

Floats = NDArray[np.float64]

METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001, "1": 1.0}
# A point is a ball, and a disc a cylinder, of this radius and half width: far below the engine's
# own penetration of about 1e-5 m.
TINY = 1e-6
# The answer asks for no table, but a recipe must have a sweep.
SWEEP = '[sweep.gravity]\nchart = "cone"\nmax_tilt = 60.0\nnodes = 2\nchannels = ["tip_angle"]\n'
# The settings of the engine: facts on why are in docs/measured/physics.md.
OPTION = (
    'timestep="0.001" integrator="implicitfast" solver="Newton" iterations="100" '
    'tolerance="1e-12" cone="elliptic" impratio="100"'
)
SOFTNESS = 'solref="0.004 1" solimp="0.99 0.999 0.0001"'


@dataclass(frozen=True)
class Solid:
    """A "point", "sphere", "disc", "cylinder" or "capsule" at a place.

    `half` is half the length of the last two along `axis`.  A solid that is not `braked` turns
    freely about its axis, a ball about any.
    """

    shape: str
    centre: Floats
    radius: float = 0.0
    axis: Floats = field(default_factory=lambda: np.array([0.0, 1.0, 0.0]))
    half: float = 0.0
    braked: bool = True


@dataclass(frozen=True)
class Swing:
    """An axle on a hinge: the places of its two solids, and a mass of its own at `com`.

    `pivot` is on the hinge's line, along the unit vector `axis`; `stops` (rad) to either side.
    """

    solids: tuple[int, int]
    pivot: Floats
    axis: Floats
    stops: float
    mass: float
    com: Floats


class Primitives(NamedTuple):
    """Contacts as lutgen has them: centres and axes (n, 3), zeros unless discs, and radii (n,).

    `rolling` (n,) tells which of them turn freely.
    """

    centres: Floats
    axes: Floats
    radius: Floats
    rolling: NDArray[np.bool_]


@dataclass(frozen=True)
class Posture:
    """A rigid robot of solids; angles in rad, mass in kg."""

    solids: tuple[Solid, ...]
    mass: float = 10.0
    upright: float = math.radians(80.0)
    rock_angle: float = math.radians(30.0)
    swing: Swing | None = None

    @cached_property
    def primitives(self) -> Primitives:
        """The contacts: a cylinder is its two rims, a capsule its two balls."""
        rows = [
            (solid.centre + side * solid.half * solid.axis, solid)
            for solid in self.solids
            for side in ((-1.0, 1.0) if solid.half else (0.0,))
        ]
        discs = [s.axis if s.shape in ("disc", "cylinder") else np.zeros(3) for _, s in rows]
        return Primitives(
            np.array([centre for centre, _ in rows]),
            np.array(discs),
            np.array([solid.radius for _, solid in rows]),
            np.array([not solid.braked for _, solid in rows]),
        )

    @cached_property
    def size(self) -> float:
        """Largest distance of a primitive's points from the com."""
        found = self.primitives
        return float((np.linalg.norm(found.centres, axis=1) + found.radius).max())

    def recipe(self, keys: str = "") -> Recipe:
        """Return the robot's recipe, its com at the origin, with further lines for its table."""
        limits = f"upright = {math.degrees(self.upright)!r}"
        limits += f"\nrock_angle = {math.degrees(self.rock_angle)!r}\n{keys}"
        lines = [f'[robot]\nname = "judged"\nlength_unit = "m"\n{limits}']
        lines.append('[[robot.link]]\nname = "body"')
        swung: tuple[int, ...] = ()
        if self.swing is not None:
            swing, rest = self.swing, self.mass - self.swing.mass
            swung = swing.solids
            lines.append(f"mass = {rest!r}\ncom = {(-swing.mass / rest * swing.com).tolist()}")
            lines.append(f'[[robot.link]]\nname = "axle"\nparent = "body"\nmass = {swing.mass!r}')
            lines.append(f'com = {swing.com.tolist()}\n[[robot.axle]]\nname = "axle"')
            lines.append(f"contacts = {[f'c{k}' for k in swung]}")
            lines.append(f"pivot = {swing.pivot.tolist()}\naxis = {swing.axis.tolist()}")
        for k, (centre, axis, radius, rolls) in enumerate(zip(*self.primitives, strict=True)):
            link = "axle" if k in swung else "body"
            lines.append(f'[[robot.contact]]\nname = "c{k}"\nlink = "{link}"')
            lines.append(f"position = {centre.tolist()}")
            lines += [f"radius = {float(radius)!r}"] if radius else []
            lines += [f"axis = {axis.tolist()}"] if axis.any() else []
            lines += ["rolling = true"] if rolls else []
        return lutgen.parse_recipe("\n".join([*lines, "[sweep]", SWEEP]))

    def tip_angles(self, gravity_dir: Floats) -> Floats:
        """Return lutgen's tip angles (d,), rad, under directions (d, 3)."""
        nothing = np.zeros((1, 0))
        found = lutgen.evaluate(self.recipe(), nothing, gravity_dir, ("tip_angle",))
        return np.asarray(found["tip_angle"][0])


def body(
    centres: Floats, radius: Floats | float = 0.0, axes: Floats | None = None, mass: float = 10.0
) -> Posture:
    """Return a body on points, balls (radius) or discs (radius and axes)."""
    n = len(centres)
    about = np.broadcast_to(np.zeros(3) if axes is None else axes, (n, 3))
    return Posture(tuple(map(contact, centres, about, np.broadcast_to(radius, n))), mass)


def contact(centre: Floats, axis: Floats, radius: float) -> Solid:
    """Return the solid that is a primitive itself."""
    if axis.any():
        return Solid("disc", centre, float(radius), axis)
    return Solid("sphere" if radius else "point", centre, float(radius))


def recipe_posture(recipe: Recipe, params: Floats) -> Posture:
    """Return a recipe's robot at params (k,), with its true mass."""
    found, metre = forward(recipe, params[None]), METRES[recipe.length_unit]
    radius = radii_and_kinds(recipe)[0] * metre
    solids = map(contact, found.centres[0] * metre, found.axes[0], radius)
    mass = sum(link.mass for link in recipe.links) or 10.0
    return Posture(tuple(solids), mass, recipe.upright, recipe.rock_angle)


def turned_to(direction: Floats, target: Floats) -> Floats:
    """Return the rotation (3, 3) that takes a unit vector to another, by the shortest way."""
    return np.asarray(Rotation.align_vectors(target, direction)[0].as_matrix())


def mjcf(posture: Posture, rotation: Floats, height: float, gravity: Floats, mu: float) -> str:
    """Return the model: a level plane, tilted gravity (m/s2), the robot's com at a height.

    `rotation` (3, 3) takes body vectors to the world.  The inertia is that of a solid box as
    wide as the robot; it decides how fast the robot tips, not whether.
    """
    squares = (2.0 * np.abs(posture.primitives.centres).max(axis=0) + 0.05) ** 2
    # Braked solids are part of the body; free ones carry a ten-thousandth of its mass each.
    light, swing = 1e-4 * posture.mass, posture.swing
    loose = [(light, solid.centre) for solid in posture.solids if not solid.braked]
    loose += [] if swing is None else [(swing.mass, swing.com)]
    own = posture.mass - sum(mass for mass, _ in loose)
    com = -sum((mass / own * at for mass, at in loose), start=np.zeros(3))
    swung = () if swing is None else swing.solids
    fixed = [_geom(one, light) for k, one in enumerate(posture.solids) if k not in swung]
    inertia = own / 12.0 * (squares.sum() - squares)
    contacts = f'condim="3" {SOFTNESS} contype="1" conaffinity="0" friction="{mu!r} 0 0"'
    return (
        f'<mujoco><compiler angle="radian"/><option {OPTION} gravity="{_text(gravity)}"/>'
        f"<default><geom {contacts}/></default><worldbody>"
        '<geom type="plane" size="100 100 1" contype="0" conaffinity="1"/>'
        f'<body name="robot" pos="0 0 {height!r}" xyaxes="{_text(rotation[:, :2].T.ravel())}">'
        f'<freejoint/><inertial pos="{_text(com)}" mass="{own!r}" diaginertia="{_text(inertia)}"/>'
        f"{''.join(fixed)}{_axle(posture)}</body></worldbody></mujoco>"
    )


def _axle(posture: Posture) -> str:
    """Return the axle on its hinge, as wide and heavy as it is; nothing where none swings."""
    swing = posture.swing
    if swing is None:
        return ""
    ends = [posture.solids[k] for k in swing.solids]
    wide = float(np.linalg.norm(ends[0].centre - ends[1].centre))
    inertia = _text([swing.mass * wide * wide / 12.0] * 3)
    limits = f'limited="true" range="{_text([-swing.stops, swing.stops])}"'
    light = 1e-4 * posture.mass
    geoms = "".join(_geom(replace(one, centre=one.centre - swing.pivot), light) for one in ends)
    return (
        f'<body pos="{_text(swing.pivot)}">'
        f'<joint type="hinge" axis="{_text(swing.axis)}" {limits}/>'
        f'<inertial pos="{_text(swing.com - swing.pivot)}" mass="{swing.mass!r}" '
        f'diaginertia="{inertia}"/>{geoms}</body>'
    )


def _geom(solid: Solid, light: float) -> str:
    """Return a solid as part of the body, or on a joint and of a light mass (kg)."""
    shape = {"point": "sphere", "disc": "cylinder"}.get(solid.shape, solid.shape)
    sizes = [solid.radius or TINY, solid.half or TINY][: 1 if shape == "sphere" else 2]
    geom = f'<geom type="{shape}" size="{_text(sizes)}" zaxis="{_text(solid.axis)}"'
    if solid.braked:
        return f'{geom} pos="{_text(solid.centre)}"/>'
    spin = _text([light * solid.radius**2 / 2.0] * 3)
    joint = f'type="hinge" axis="{_text(solid.axis)}"' if shape != "sphere" else 'type="ball"'
    return (
        f'<body pos="{_text(solid.centre)}"><joint {joint}/>'
        f'<inertial pos="0 0 0" mass="{light!r}" diaginertia="{spin}"/>{geom}/></body>'
    )


def _text(values: Floats | list[float]) -> str:
    return " ".join(repr(float(value)) for value in values)

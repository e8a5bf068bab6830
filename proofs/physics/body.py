"""One posture as lutgen sees it and as the physics engine gets it.

Owns the steps from contact primitives to solids and from those to an MJCF model, and the one back
to a recipe without parameters: lutgen is asked as anybody would ask, so that the same question can
be put to any version of it.  Lengths in m, relative to the com, body frame.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

import lutgen
from lutgen.recipe import Recipe, forward, radii_and_kinds

Floats = NDArray[np.float64]

POINT, SPHERE, DISC = 0, 1, 2
METRES = {"m": 1.0, "cm": 0.01, "mm": 0.001, "1": 1.0}
# A point is a ball, and the rim of a disc a cylinder, of this radius and half width: far below the
# engine's own penetration of about 1e-5 m.
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
    """A ball, cylinder or capsule; `half` is half its length along `axis`, 0 for a ball.

    A solid that is not `braked` turns freely about its axis, a ball about any.
    """

    shape: str
    centre: Floats
    radius: float
    axis: Floats = field(default_factory=lambda: np.array([0.0, 1.0, 0.0]))
    half: float = 0.0
    braked: bool = True


@dataclass(frozen=True)
class Posture:
    """A rigid robot: primitives for lutgen (centres relative to the com), solids for the engine.

    `torsion` (m) is by how much of its force a contact resists being turned about the ground's
    normal; that of a point does not.
    """

    centres: Floats
    axes: Floats
    radius: Floats
    kind: NDArray[np.int64]
    solids: tuple[Solid, ...]
    mass: float = 10.0
    upright: float = np.radians(80.0)
    rock_angle: float = np.pi / 6
    torsion: float = 0.0

    @property
    def size(self) -> float:
        """Largest distance of a primitive's points from the com."""
        return float((np.linalg.norm(self.centres, axis=1) + self.radius).max())

    def tip_angle(self, gravity_dir: Floats, com_shift: Floats | float = 0.0) -> float:
        """Return lutgen's tip angle (rad), if wanted with the com off by a vector."""
        moved = replace(self, centres=self.centres - com_shift)
        limits = (math.degrees(self.upright), math.degrees(self.rock_angle))
        recipe = as_recipe(moved, "upright = {!r}\nrock_angle = {!r}".format(*limits))
        return float(tip_angles(recipe, gravity_dir[None])[0])


def as_recipe(posture: Posture, keys: str = "", rolling: Sequence[bool] = ()) -> Recipe:
    """Return a rigid robot's recipe in m, its com at the origin.

    `keys` are further lines of the table of the robot, such as its `upright`; without them the
    recipe's defaults hold.  `rolling` tells of every primitive whether it rolls; empty if none
    does.
    """
    lines = ['[robot]\nname = "judged"\nlength_unit = "m"', keys, '[[robot.link]]\nname = "body"']
    for k, kind in enumerate(posture.kind):
        lines.append(f'[[robot.contact]]\nname = "c{k}"\nlink = "body"')
        lines.append(f"position = {posture.centres[k].tolist()}")
        if kind != POINT:
            lines.append(f"radius = {float(posture.radius[k])!r}")
        if kind == DISC:
            lines.append(f"axis = {posture.axes[k].tolist()}")
        if rolling and rolling[k]:
            lines.append("rolling = true")
    return lutgen.parse_recipe("\n".join([*lines, "[sweep]", SWEEP]))


def tip_angles(recipe: Recipe, gravity_dir: Floats) -> Floats:
    """Return the tip angles (d,), rad, of a rigid robot's recipe under directions (d, 3)."""
    nothing = np.zeros((1, 0))
    return np.asarray(lutgen.evaluate(recipe, nothing, gravity_dir, ("tip_angle",))["tip_angle"][0])


def thin_solids(
    centres: Floats, axes: Floats, radius: Floats, kind: NDArray[np.int64]
) -> tuple[Solid, ...]:
    """Return the solids that are the primitives themselves."""
    solids = []
    for centre, axis, r, k in zip(centres, axes, radius, kind, strict=True):
        if k == DISC:
            solids.append(Solid("cylinder", centre, float(r), axis, TINY))
        else:
            solids.append(Solid("sphere", centre, float(r) if k == SPHERE else TINY))
    return tuple(solids)


def rigid_body(
    centres: Floats,
    radius: Floats | float = 0.0,
    axes: Floats | None = None,
    mass: float = 10.0,
) -> Posture:
    """Return a body on points, spheres (radius) or discs (radius and axes), one kind."""
    n = len(centres)
    radii = np.broadcast_to(np.asarray(radius, np.float64), n).copy()
    kind = np.full(n, DISC if axes is not None else SPHERE if radii.any() else POINT)
    about = np.zeros((n, 3)) if axes is None else np.broadcast_to(axes, (n, 3)).copy()
    return Posture(centres, about, radii, kind, thin_solids(centres, about, radii, kind), mass)


def on_solids(solids: tuple[Solid, ...], mass: float = 10.0) -> Posture:
    """Return a body on real solids: cylinders are their two rims, capsules their two balls."""
    centres, axes, radius, kind = [], [], [], []
    for solid in solids:
        for side in (-1.0, 1.0) if solid.half > 0.0 else (0.0,):
            centres.append(solid.centre + side * solid.half * solid.axis)
            is_disc = solid.shape == "cylinder"
            axes.append(solid.axis if is_disc else np.zeros(3))
            radius.append(solid.radius)
            kind.append(DISC if is_disc else SPHERE)
    return Posture(
        *(np.array(centres), np.array(axes), np.array(radius), np.array(kind, np.int64)),
        *(solids, mass),
    )


def recipe_postures(recipe: Recipe, params: Floats) -> list[Posture]:
    """Return the postures of a recipe's robot at params (m, k), with its true mass."""
    found = forward(recipe, params)
    radius, kind = radii_and_kinds(recipe)
    metre = METRES[recipe.length_unit]
    mass = sum(link.mass for link in recipe.links) or 10.0
    return [
        Posture(
            *(centres * metre, axes, radius * metre, kind),
            thin_solids(centres * metre, axes, radius * metre, kind),
            *(mass, recipe.upright, recipe.rock_angle),
        )
        for centres, axes in zip(found.centres, found.axes, strict=True)
    ]


def turned_to(direction: Floats, target: Floats) -> Floats:
    """Return a rotation (3, 3) that takes one unit vector to another, by the shortest way."""
    cosine = float(direction @ target)
    if cosine < -1.0 + 1e-12:
        across = np.eye(3)[np.argmin(np.abs(direction))]
        across -= direction * (across @ direction)
        across /= np.linalg.norm(across)
        return np.asarray(2.0 * np.outer(across, across) - np.eye(3))
    v = np.cross(direction, target)
    skew = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
    return np.asarray(np.eye(3) + skew + skew @ skew / (1.0 + cosine))


def mjcf(posture: Posture, rotation: Floats, height: float, gravity: Floats, mu: float) -> str:
    """Return the model: a level plane, tilted gravity (m/s2), the robot's com at a height.

    `rotation` (3, 3) takes body vectors to the world.  The inertia is that of a solid box as
    wide as the robot; it decides how fast the robot tips, not whether.
    """

    def text(values: Floats) -> str:
        return " ".join(repr(float(value)) for value in values)

    frame = text(np.concatenate([rotation[:, 0], rotation[:, 1]]))
    extent = 2.0 * np.abs(posture.centres).max(axis=0) + 0.05
    squares = extent**2
    # Braked solids are part of the body; free ones carry a ten-thousandth of its mass each.
    free = [solid for solid in posture.solids if not solid.braked]
    light = 1e-4 * posture.mass
    own = posture.mass - light * len(free)
    com = -light / own * np.sum([solid.centre for solid in free], axis=0) if free else np.zeros(3)
    inertia = own / 12.0 * (squares.sum() - squares)
    parts = []
    for solid in posture.solids:
        size = text(np.array([solid.radius, solid.half][: 1 if solid.shape == "sphere" else 2]))
        geom = f'<geom type="{solid.shape}" size="{size}" zaxis="{text(solid.axis)}"'
        if solid.braked:
            parts.append(f'{geom} pos="{text(solid.centre)}"/>')
        else:
            spin = light * solid.radius**2 / 2.0
            joint = f'<joint type="hinge" axis="{text(solid.axis)}"/>'
            if solid.shape == "sphere":
                joint = '<joint type="ball"/>'
            parts.append(
                f'<body pos="{text(solid.centre)}">{joint}'
                f'<inertial pos="0 0 0" mass="{light!r}" diaginertia="{spin!r} {spin!r} {spin!r}"/>'
                f"{geom}/></body>"
            )
    contact = f'condim="{4 if posture.torsion else 3}" {SOFTNESS} contype="1" conaffinity="0"'
    return (
        f'<mujoco><option {OPTION} gravity="{text(gravity)}"/>'
        f'<default><geom {contact} friction="{mu!r} {posture.torsion!r} 0"/></default>'
        '<worldbody><geom type="plane" size="100 100 1" contype="0" conaffinity="1"/>'
        f'<body name="robot" pos="0 0 {height!r}" xyaxes="{frame}"><freejoint/>'
        f'<inertial pos="{text(com)}" mass="{own!r}" diaginertia="{text(inertia)}"/>'
        f"{''.join(parts)}</body></worldbody></mujoco>"
    )

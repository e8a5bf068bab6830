"""From parameter values to postures: contacts, points where forces act, and the centre of mass.

One kernel walks the link tree for every posture.
"""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from lutgen.arrays import Floats, Ints
from lutgen.errors import InputError, reject
from lutgen.jit import njit
from lutgen.parts import KINDS, ZERO, Joint, Link, parents_first, way_up
from lutgen.recipe.described import answered
from lutgen.recipe.model import Recipe
from lutgen.vector import rotation

FIXED, REVOLUTE, PRISMATIC = 0, 1, 2
# Share of a parameter's limits by which a value may be beyond them.
ROUNDING = 1e-9


class Postures(NamedTuple):
    """Postures of a robot, body frame, in the recipe's length unit.

    `centres` (m, n, 3): contact centres relative to the com; `axes` (m, n, 3): unit
    axes of the discs, zero for other contacts; `com` (m, 3): in the recipe's frame;
    `force_points` (m, f, 3): where the recipe's forces act, relative to the com; `pivots` and
    `pivot_axes` (m, a, 3): a point of the line about which each axle swings, relative to the com,
    and the unit vector along it; `axle_coms` (m, a, 3) and `axle_shares` (m, a): the com of what
    swings, relative to that of the robot, and its share of the mass.
    """

    centres: Floats
    axes: Floats
    com: Floats
    force_points: Floats
    pivots: Floats
    pivot_axes: Floats
    axle_coms: Floats
    axle_shares: Floats


class Tree(NamedTuple):
    """The links as flat arrays, parents before children, and what is attached to them."""

    link: Ints  # (l, 3): parent; FIXED, REVOLUTE or PRISMATIC; column of params
    motion: Floats  # (l, 8): origin; joint's axis, scale and offset
    rotation: Floats  # (l, 3, 3)
    mass: Floats  # (l,) share of the whole mass
    com: Floats  # (l, 3)
    # Contacts, and after them the points where forces act, whose axes are zero, pivots, and
    # the coms of the links that swing.
    point_link: Ints  # (n + f + a + s,)
    point_position: Floats  # (n + f + a + s, 3)
    point_axis: Floats  # (n + f + a + s, 3)


def forward(recipe: Recipe, params: ArrayLike) -> Postures:
    """Compute postures from finite parameters (m, k), rad or length, within limits or not."""
    values = _checked(recipe, params)
    if recipe.python is not None and recipe.function is None:
        what, got = "the robot is given by code that was not loaded", f"python = {recipe.python!r}"
        reject(recipe.source, what, got, "load its recipe file with allow_python", InputError)
    if recipe.function is not None:
        own, com = answered(recipe.source, recipe.function, values, len(recipe.contacts))
        com = com + recipe.com_offset
        none = np.empty((len(values), 0, 3))
        centres = own - com[:, None, :]
        return Postures(centres, np.zeros(own.shape), com, none, none, none, none, none[..., 0])
    counts = len(recipe.contacts), len(recipe.forces), len(recipe.axles)
    tree, ends = _tree(recipe), np.cumsum(counts)
    points, axes = np.empty((2, len(values), len(tree.point_link), 3))
    com = np.empty((len(values), 3))
    turn = np.concatenate([tree.rotation, np.empty((2, 3, 3))])
    _forward(values, tree, turn, np.zeros((len(tree.link), 3)), points, axes, com)
    com += recipe.com_offset
    points -= recipe.com_offset
    contacts, forces, pivots, swung = np.split(points, ends, axis=1)
    return Postures(
        np.ascontiguousarray(contacts),
        np.ascontiguousarray(axes[:, : ends[0]]),
        com,
        np.ascontiguousarray(forces),
        pivots,
        axes[:, ends[1] : ends[2]],
        *_axle_masses(recipe, swung),
    )


def postures(recipe: Recipe, params: ArrayLike) -> tuple[Floats, Floats]:
    """Compute the contacts and the centres of mass of postures.

    Returns contact centres (m, n, 3) relative to the com, body frame, and the com (m, 3) in the
    recipe's frame, for parameters (m, k), rad or length.
    """
    result = forward(recipe, params)
    return result.centres, result.com


def radii_and_kinds(recipe: Recipe) -> tuple[Floats, Ints]:
    """Return radius (n,) and kind (n,), a place in `KINDS`, of the contacts."""
    radius = np.array([contact.radius for contact in recipe.contacts], dtype=np.float64)
    kind = np.array([KINDS.index(contact.kind) for contact in recipe.contacts], dtype=np.int64)
    return radius, kind


def _checked(recipe: Recipe, params: ArrayLike) -> Floats:
    """Return params as a C-contiguous (m, k) array of finite numbers."""
    values = np.ascontiguousarray(params, dtype=np.float64)
    names = ", ".join(p.name for p in recipe.parameters)
    if values.ndim != 2 or values.shape[1] != len(recipe.parameters):
        what = f"params must have shape (m, {len(recipe.parameters)})"
        way_out = f"give one row per posture with the columns: {names}"
        reject(recipe.source, what, values.shape, way_out, InputError)
    bad = ~np.isfinite(values)
    if bad.any():
        row, column = np.unravel_index(bad.argmax(), bad.shape)
        what = f"parameter `{recipe.parameters[column].name}` must be finite"
        got = f"{values[row, column]} in row {row}"
        reject(recipe.source, what, got, "pass numbers only", InputError)
    return values


def within_limits(
    recipe: Recipe, params: ArrayLike, ends: Sequence[tuple[float, float]] | None = None
) -> Floats:
    """Return params as `forward` takes them, if within `ends`, or the parameters' limits."""
    values = _checked(recipe, params)
    ends = ends or [(parameter.minimum, parameter.maximum) for parameter in recipe.parameters]
    for parameter, column, (low, high) in zip(recipe.parameters, values.T, ends, strict=True):
        # Angles in deg round when they become rad.
        rounding = ROUNDING * max(high - low, abs(low), abs(high))
        inside = (low - rounding <= column) & (column <= high + rounding)
        if not inside.all():
            row, shown = int(inside.argmin()), parameter.shown
            got = f"{shown(column[row]):.6g}"
            if parameter.display_unit == "deg":
                got += f" deg = {column[row]:.6g} rad"
            raise InputError(
                f"{recipe.source}: parameter {parameter.name} must lie in {shown(low):g} to "
                f"{shown(high):g} {parameter.display_unit} (got {got}"
                f"{f' in row {row}' if len(column) > 1 else ''}); the limits are in that file."
            )
    return values


def swung_links(recipe: Recipe) -> list[list[Link]]:
    """Return the links that swing with each axle: what carries its contacts below its pivot."""
    parents = {link.name: link.parent for link in recipe.links}
    ways = {name: way_up(parents, name) for name in parents}
    carrier = {contact.name: contact.link for contact in recipe.contacts}
    found = []
    for axle in recipe.axles:
        above = [ways[carrier[name]] for name in axle.contacts]
        roots = {way[way.index(axle.link) - 1] for way in above if way[0] != axle.link}
        found.append([link for link in recipe.links if roots & set(ways[link.name])])
    return found


def _axle_masses(recipe: Recipe, coms: Floats) -> tuple[Floats, Floats]:
    """Return the com (m, a, 3) of what swings with each axle, and its share (m, a) of the mass."""
    total = math.fsum(link.mass for link in recipe.links)
    middles, shares, first = np.zeros((len(coms), len(recipe.axles), 3)), [], 0
    for k, links in enumerate(swung_links(recipe)):
        mass = np.array([link.mass for link in links])
        if mass.any():
            middles[:, k] = mass @ coms[:, first : first + len(links)] / mass.sum()
        shares.append(float(mass.sum()) / total if total else 0.0)
        first += len(links)
    return middles, np.tile(np.array(shares), (len(coms), 1))


@lru_cache(maxsize=16)
def _tree(recipe: Recipe) -> Tree:
    order, _ = parents_first({link.name: link.parent for link in recipe.links})
    named = {link.name: link for link in recipe.links}
    links = [named[name] for name in order]
    row = {link.name: i for i, link in enumerate(links)}
    column = {p.name: i for i, p in enumerate(recipe.parameters)}
    mass = np.array([link.mass for link in links])
    total = mass.sum()
    # Without masses the com is the origin of the recipe's frame: no link has a share.
    share = mass / total if total > 0.0 else mass

    # What is attached to each link, and where: see `Tree`.
    spots = [(one.link, one.position, one.axis or ZERO) for one in recipe.contacts]
    spots += [(one.link, one.position, ZERO) for one in recipe.forces]
    spots += [(one.link, one.pivot, one.axis) for one in recipe.axles]
    spots += [(one.name, one.com, ZERO) for swung in swung_links(recipe) for one in swung]
    carriers, positions, axes = zip(*spots, strict=True)
    kinds = {"fixed": FIXED, "revolute": REVOLUTE, "prismatic": PRISMATIC}
    still, steps, motion = Joint("fixed", ZERO, "", 0.0, 0.0), [], []
    for link in links:
        joint, parent = link.joint or still, row.get(link.parent or "", 0)
        steps.append((parent, kinds[joint.kind], column.get(joint.parameter, 0)))
        motion.append((*link.origin, *joint.axis, joint.scale, joint.offset))
    return Tree(
        np.array(steps, np.int64),
        np.array(motion, np.float64),
        np.array([rotation(link.rpy) for link in links]),
        share,
        np.array([link.com for link in links], np.float64),
        np.array([row[name] for name in carriers], np.int64),
        np.array(positions, np.float64),
        np.array(axes, np.float64),
    )


@njit(bare=True)
def _turn(axis: Floats, angle: float, out: Floats) -> None:
    c, s = math.cos(angle), math.sin(angle)
    x, y, z, d = axis[0], axis[1], axis[2], 1.0 - c
    out[0, 0] = c + x * x * d
    out[0, 1] = x * y * d - z * s
    out[0, 2] = x * z * d + y * s
    out[1, 0] = x * y * d + z * s
    out[1, 1] = c + y * y * d
    out[1, 2] = y * z * d - x * s
    out[2, 0] = x * z * d - y * s
    out[2, 1] = y * z * d + x * s
    out[2, 2] = c + z * z * d


@njit(bare=True)
def _multiply(left: Floats, right: Floats, out: Floats) -> None:
    for i in range(3):
        for j in range(3):
            out[i, j] = (
                left[i, 0] * right[0, j] + left[i, 1] * right[1, j] + left[i, 2] * right[2, j]
            )


@njit(bare=True)
def _rotate(matrix: Floats, vector: Floats, i: int) -> float:
    return float(matrix[i, 0] * vector[0] + matrix[i, 1] * vector[1] + matrix[i, 2] * vector[2])


@njit(bare=True)
def _place(link: int, params: Floats, tree: Tree, turn: Floats, where: Floats) -> None:
    """Write rotation and origin of a link in the body frame, after those of its parent.

    `turn` has two matrices more than there are links, as scratch.
    """
    here, (above, joint, column) = turn[link], tree.link[link]
    motion, fixed, value = tree.motion[link], tree.rotation[link], 0.0
    for i in range(3):
        where[link, i] = where[above, i] + _rotate(turn[above], motion, i)
    if joint != FIXED:
        value = motion[6] * params[column] + motion[7]
    if joint == REVOLUTE:
        before, about = turn[turn.shape[0] - 2], turn[turn.shape[0] - 1]
        _multiply(turn[above], fixed, before)
        _turn(motion[3:6], value, about)
        _multiply(before, about, here)
        return
    _multiply(turn[above], fixed, here)
    if joint == PRISMATIC:
        for i in range(3):
            where[link, i] += value * _rotate(here, motion[3:6], i)


@njit(bare=True)
def _forward(
    params: Floats,
    tree: Tree,
    turn: Floats,
    where: Floats,
    points: Floats,
    axes: Floats,
    com: Floats,
) -> None:
    """Write postures, each one computed by itself; the root's place is in `turn` and `where`."""
    for m in range(len(params)):
        com[m, 0] = com[m, 1] = com[m, 2] = 0.0
        for link in range(len(tree.link)):
            if link > 0:
                _place(link, params[m], tree, turn, where)
            for i in range(3):
                own = where[link, i] + _rotate(turn[link], tree.com[link], i)
                com[m, i] += tree.mass[link] * own
        for n in range(len(tree.point_link)):
            link = tree.point_link[n]
            for i in range(3):
                centre = where[link, i] + _rotate(turn[link], tree.point_position[n], i)
                points[m, n, i] = centre - com[m, i]
                axes[m, n, i] = _rotate(turn[link], tree.point_axis[n], i)

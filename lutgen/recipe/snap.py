"""Size of a robot, and snap: discs that were meant to be on one axle are put exactly there.

A wheel that is described by two rims, with the noise of printed digits, must be a wheel: otherwise
three rims of two wheels make up a rest on which no robot stands.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import product
from typing import NamedTuple

import numpy as np

from lutgen.arrays import Floats
from lutgen.parts import Contact, Link, parents_first
from lutgen.recipe.kinematics import forward, radii_and_kinds
from lutgen.recipe.model import Recipe
from lutgen.vector import rotation

# Postures that are looked at: both ends and the middle of every parameter, or of so many parameters
# that they would be more than this, the ends of as many as possible.
POSTURES = 1024
# Part of the size: how near to a facet's plane a contact counts to its support polygon.
TOLERANCE = 1e-4


def contact_tolerance_of(recipe: Recipe) -> float:
    """Return `contact_tolerance` (length) of a recipe, or what it is by default."""
    tolerance = recipe.contact_tolerance
    return TOLERANCE * robot_size_of(recipe) if tolerance is None else tolerance


@lru_cache(maxsize=64)
def robot_size_of(recipe: Recipe) -> float:
    """Return the greatest distance of a contact's far side from the com over `POSTURES`."""
    places = []
    for place, one in enumerate(recipe.parameters):
        knots = [one.minimum, 0.5 * (one.minimum + one.maximum), one.maximum]
        if 3 ** len(recipe.parameters) > POSTURES:
            knots = knots[::2] if 2 ** (place + 1) <= POSTURES else knots[1:2]
        places.append(knots)
    radius, _ = radii_and_kinds(recipe)
    centres = forward(recipe, np.array(list(product(*places)), dtype=np.float64)).centres
    return float((np.sqrt((centres**2).sum(axis=2)) + radius).max(initial=0.0))


# Part of the size: what moves by less is exact but for rounding, and stays as it is.
ROUNDING = 1e-12
# Part of the size: what moves by more is said.
WORTH_SAYING = 1e-9


class Disc(NamedTuple):
    """A disc by its number, where its link is in the frame of its group, and its axle there."""

    number: int
    contact: Contact
    turn: Floats
    origin: Floats
    centre: Floats
    axis: Floats


def snap(recipe: Recipe) -> Recipe:
    """Return a recipe whose discs agree where they all but agree; `snapped` says what has moved.

    Discs without a parameter between them whose axes are one line within `contact_tolerance` are
    put on one line; of these, radii that differ by less become their mean; and one between two
    others that stands out of the straight cone between them by no more is made to stand back, so
    that it touches nothing.
    """
    places = _places(recipe.links)
    groups: dict[str, list[Disc]] = {}
    for i, one in enumerate(recipe.contacts):
        if one.kind == "disc":
            root, turn, origin = places[one.link]
            axle = origin + turn @ np.array(one.position), turn @ np.array(one.axis)
            groups.setdefault(root, []).append(Disc(i, one, turn, origin, *axle))
    if all(len(discs) == 1 for discs in groups.values()):
        return recipe
    tolerance, size = contact_tolerance_of(recipe), robot_size_of(recipe)
    contacts, said = list(recipe.contacts), []
    for line in (line for discs in groups.values() for line in _lines(discs, tolerance)):
        for disc, contact in zip(line, _agreed(line, tolerance), strict=True):
            away = _change(disc.contact, contact)
            if away > ROUNDING * size:
                contacts[disc.number] = contact
            if away > WORTH_SAYING * size:
                said.append(
                    f"disc {contact.name} was moved by {away:.2g} {recipe.length_unit}, to agree "
                    "with those on its axle"
                )
    return replace(recipe, contacts=tuple(contacts), snapped=tuple(said))


def _places(links: Sequence[Link]) -> dict[str, tuple[str, Floats, Floats]]:
    """Return for each link the nearest one above that a joint moves, and where it is in that.

    The place is a rotation (3, 3) and an origin (3,).
    """
    named = {link.name: link for link in links}
    found: dict[str, tuple[str, Floats, Floats]] = {}
    for name in parents_first({link.name: link.parent for link in links})[0]:
        link = named[name]
        if link.parent is None or link.joint is not None:
            found[name] = name, np.eye(3), np.zeros(3)
        else:
            root, turn, origin = found[link.parent]
            found[name] = root, turn @ rotation(link.rpy), origin + turn @ np.array(link.origin)
    return found


def _lines(discs: Sequence[Disc], tolerance: float) -> list[list[Disc]]:
    """Return discs in sets of two or more whose axes are one line, transitively."""
    lines: list[list[Disc]] = []
    for disc in discs:
        near, far = [disc], []
        for line in lines:
            if any(_apart(disc, other) <= tolerance for other in line):
                near += line
            else:
                far.append(line)
        lines = [*far, near]
    return [sorted(line, key=lambda disc: disc.number) for line in lines if len(line) > 1]


def _apart(disc: Disc, other: Disc) -> float:
    arm = other.centre - disc.centre
    aside = float(np.linalg.norm(arm - (arm @ disc.axis) * disc.axis))
    radius = max(disc.contact.radius, other.contact.radius)
    return max(aside, radius * float(np.linalg.norm(np.cross(disc.axis, other.axis))))


def _agreed(line: Sequence[Disc], tolerance: float) -> list[Contact]:
    signs = np.array([1.0 if disc.axis @ line[0].axis >= 0.0 else -1.0 for disc in line])
    axis = signs @ np.array([disc.axis for disc in line])
    axis /= np.linalg.norm(axis)
    centres = np.array([disc.centre for disc in line])
    middle = centres.mean(axis=0)
    along = (centres - middle) @ axis
    radii = _one_radius(np.array([disc.contact.radius for disc in line]), tolerance)
    result = []
    for k, disc in enumerate(line):
        x, y, z = (disc.turn.T @ (middle + along[k] * axis - disc.origin)).tolist()
        a, b, c = (disc.turn.T @ (signs[k] * axis)).tolist()
        radius = _behind_the_cone(along, radii, k, tolerance)
        result.append(replace(disc.contact, position=(x, y, z), axis=(a, b, c), radius=radius))
    return result


def _one_radius(radii: Floats, tolerance: float) -> Floats:
    """Return radii with those that differ by no more than the tolerance at their mean."""
    order = np.argsort(radii)
    apart = np.flatnonzero(np.diff(radii[order]) > tolerance) + 1
    result = radii.copy()
    for some in np.split(order, apart):
        result[some] = radii[some].mean()
    return result


def _behind_the_cone(along: Floats, radii: Floats, k: int, tolerance: float) -> float:
    """Return the radius of disc k: less if it all but lies on the cone between two others."""
    radius = float(radii[k])
    for i in np.flatnonzero(along < along[k]):
        for j in np.flatnonzero(along > along[k]):
            share = (along[k] - along[i]) / (along[j] - along[i])
            cone = radii[i] + share * (radii[j] - radii[i])
            if 0.0 < radii[k] - cone <= tolerance:
                radius = min(radius, float(cone) - 2.0 * tolerance)
    return radius


def _change(before: Contact, after: Contact) -> float:
    away = float(np.linalg.norm(np.subtract(before.position, after.position)))
    lean = float(np.linalg.norm(np.subtract(before.axis or (), after.axis or ())))
    return away + abs(before.radius - after.radius) + before.radius * lean

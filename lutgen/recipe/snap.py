"""Snap: discs that were meant to be on one axle are put exactly there.

A wheel that is described by two rims, with the noise of printed digits, must be a wheel: otherwise
three rims of two wheels make up a rest on which no robot stands.
"""

from dataclasses import replace

import numpy as np

from lutgen.parts import Contact, Link
from lutgen.recipe.recipe import Recipe
from lutgen.recipe.size import contact_tolerance_of, robot_size_of
from lutgen.rotation import rotation
from lutgen.vector import Floats

# Part of the size: what moves by less is exact but for rounding, and stays as it is.
ROUNDING = 1e-12
# Part of the size: what moves by more is said.
WORTH_SAYING = 1e-9


def snap(recipe: Recipe) -> Recipe:
    """Return a recipe whose discs agree where they all but agree.

    Discs without a parameter between them whose axes are one line within `contact_tolerance` are
    put on one line; of these, radii that differ by less become their mean; and one between two
    others that stands out of the straight cone between them by no more is made to stand back, so
    that it touches nothing.

    Parameters
    ----------
    recipe : Recipe
        Checked; one given by code is returned as it is.

    Returns
    -------
    Recipe
        `snapped` says what has moved by more than rounding.
    """
    contacts = list(recipe.contacts)
    groups: dict[str, list[int]] = {}
    places = _places(recipe.links)
    for i, contact in enumerate(contacts):
        if contact.kind == "disc":
            groups.setdefault(places[contact.link][0], []).append(i)
    groups = {root: some for root, some in groups.items() if len(some) > 1}
    if not groups:
        return recipe
    tolerance, size = contact_tolerance_of(recipe), robot_size_of(recipe)
    moved: dict[str, float] = {}
    for some in groups.values():
        for line in _lines(contacts, some, places, tolerance):
            for i, disc in _agreed(contacts, line, places, tolerance):
                away = _change(contacts[i], disc)
                if away > ROUNDING * size:
                    contacts[i] = disc
                if away > WORTH_SAYING * size:
                    moved[disc.name] = away
    said = tuple(
        f"disc {name} was moved by {away:.2g} {recipe.length_unit}, to agree with those on its axle"
        for name, away in moved.items()
    )
    return replace(recipe, contacts=tuple(contacts), snapped=said)


def _places(links: tuple[Link, ...]) -> dict[str, tuple[str, Floats, Floats]]:
    """Return for each link the nearest one above that a joint moves, and where it is in that.

    The place is a rotation (3, 3) and an origin (3,).
    """
    named = {link.name: link for link in links}
    found: dict[str, tuple[str, Floats, Floats]] = {}

    def place(link: Link) -> tuple[str, Floats, Floats]:
        if link.name not in found:
            if link.parent is None or link.joint is not None:
                found[link.name] = link.name, np.eye(3), np.zeros(3)
            else:
                root, turn, origin = place(named[link.parent])
                found[link.name] = (
                    root,
                    turn @ rotation(link.rpy),
                    origin + turn @ np.array(link.origin),
                )
        return found[link.name]

    for link in links:
        place(link)
    return found


def _axle(contact: Contact, places: dict[str, tuple[str, Floats, Floats]]) -> tuple[Floats, Floats]:
    """Return centre and axis (3,) of a disc in the frame of its group."""
    _, turn, origin = places[contact.link]
    return origin + turn @ np.array(contact.position), turn @ np.array(contact.axis)


def _lines(
    contacts: list[Contact],
    some: list[int],
    places: dict[str, tuple[str, Floats, Floats]],
    tolerance: float,
) -> list[list[int]]:
    """Return discs in sets of two or more whose axes are one line, transitively."""
    lines: list[list[int]] = []
    for i in some:
        centre, axis = _axle(contacts[i], places)
        near = []
        for line in lines:
            for j in line:
                other, along = _axle(contacts[j], places)
                # How far the rims of both are off, by their places and by their axes.
                arm = other - centre
                aside = float(np.linalg.norm(arm - (arm @ axis) * axis))
                radius = max(contacts[i].radius, contacts[j].radius)
                lean = radius * float(np.linalg.norm(np.cross(axis, along)))
                if max(aside, lean) <= tolerance:
                    near.append(line)
                    break
        lines = [line for line in lines if line not in near]
        lines.append([*(j for line in near for j in line), i])
    return [sorted(line) for line in lines if len(line) > 1]


def _agreed(
    contacts: list[Contact],
    line: list[int],
    places: dict[str, tuple[str, Floats, Floats]],
    tolerance: float,
) -> list[tuple[int, Contact]]:
    """Return the discs of one line as they agree."""
    axles = [_axle(contacts[i], places) for i in line]
    first = axles[0][1]
    signs = [1.0 if axis @ first >= 0.0 else -1.0 for _, axis in axles]
    axis = np.array(signs) @ np.array([one for _, one in axles])
    axis /= np.linalg.norm(axis)
    centres = np.array([centre for centre, _ in axles])
    middle = centres.mean(axis=0)
    along = (centres - middle) @ axis
    radii = _one_radius(np.array([contacts[i].radius for i in line]), tolerance)
    result = []
    for k, i in enumerate(line):
        _, turn, origin = places[contacts[i].link]
        position = turn.T @ (middle + along[k] * axis - origin)
        direction = turn.T @ (signs[k] * axis)
        radius = _behind_the_cone(along, radii, k, tolerance)
        x, y, z = position.tolist()
        a, b, c = direction.tolist()
        result.append((i, replace(contacts[i], position=(x, y, z), axis=(a, b, c), radius=radius)))
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
    """Return how far (length) a point of a disc has moved at most."""
    away = float(np.linalg.norm(np.subtract(before.position, after.position)))
    lean = float(np.linalg.norm(np.subtract(before.axis or (), after.axis or ())))
    return away + abs(before.radius - after.radius) + before.radius * lean

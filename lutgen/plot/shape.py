"""Shape: what of a robot's body a drawing shows, from its links and contacts.

A recipe has no outlines, so the body is a sketch: a link is the hull of what it carries, a bone
where that is two places; discs in one plane on one link that is called a track or the like are the
wheels of a belt.
"""

import math
import re
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.parts import Contact
from lutgen.recipe import Recipe, forward

Floats = NDArray[np.float64]

# Parts of the robot's size within which two places are one, and discs lie in one plane.
SAME = 1e-6
CORNERS = 49
# In the names of links or contacts; nothing else tells a track's ends from two wheels.
BELT = re.compile(r"track|flipper|belt|crawler|caterpillar", re.IGNORECASE)


class Shape(NamedTuple):
    """The parts of a body relative to the com, body frame, the recipe's length unit.

    `bones`: lines (2, 3); `faces`: polygons (k, 3) of the hulls of links; `belts`: closed outlines
    (k, 3) of discs that run in one plane on one link.
    """

    bones: list[Floats]
    faces: list[Floats]
    belts: list[Floats]


def circle(centre: Floats, normal: Floats, radius: float) -> Floats:
    """Return (49, 3) points of a circle around a unit axis, the first and last the same."""
    across = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    across /= np.linalg.norm(across)
    turn = np.linspace(0.0, 2.0 * math.pi, CORNERS)[:, None]
    rim = np.cos(turn) * across + np.sin(turn) * np.cross(normal, across)
    return np.asarray(centre + radius * rim)


def shape_of(recipe: Recipe, params: ArrayLike) -> Shape:
    """Return the body's shape at a posture (k,), rad or length.

    Of a robot given by code, whose links nobody knows, a bone from the com to each contact.
    """
    row = np.asarray(params, dtype=np.float64)[None, :]
    shape = Shape([], [], [])
    if recipe.python is not None:
        centres = forward(recipe, row).centres[0]
        return shape._replace(bones=[np.stack([np.zeros(3), centre]) for centre in centres])
    marked, links, carried = _marked(recipe)
    found = forward(marked, row)
    centres, axes = found.centres[0], found.axes[0]
    size = float(np.linalg.norm(centres, axis=1).max())
    for name in links:
        _add_link(shape, centres[list(carried[name])], SAME * size)
        discs = [
            at
            for at, c in enumerate(recipe.contacts)
            if c.link == name and c.kind == "disc" and BELT.search(f"{name} {c.name}")
        ]
        _add_belts(shape, recipe, centres, axes, discs)
    return shape


@lru_cache(maxsize=4)
def _marked(recipe: Recipe) -> tuple[Recipe, tuple[str, ...], dict[str, tuple[int, ...]]]:
    """Return the robot with a contact at each link's origin and com, and what each link carries.

    Links that carry nothing, and whose children do not either, are left out; what a link carries
    are places among the contacts: its own, the origins of its children, its com and its origin.
    """
    kept = {contact.link for contact in recipe.contacts}
    # What is bolted on has weight, but no shape that anybody knows.
    kept |= {link.name for link in recipe.links if link.mass > 0.0 and link.joint is not None}
    parents = {link.name: link.parent for link in recipe.links}
    for name in list(kept):
        while (parent := parents[name]) is not None:
            name = parent
            kept.add(name)
    marks: list[Contact] = []
    carried: dict[str, list[int]] = {name: [] for name in kept}
    for at, contact in enumerate(recipe.contacts):
        carried[contact.link].append(at)
    carries = {
        name: any(c.link == name for c in recipe.contacts)
        or any(link.parent == name and link.name in kept for link in recipe.links)
        for name in kept
    }
    for link in recipe.links:
        if link.name not in kept:
            continue
        if link.parent is not None:
            at = len(recipe.contacts) + len(marks)
            marks.append(Contact(link.name, link.name, (0.0, 0.0, 0.0)))
            carried[link.name].append(at)
            carried[link.parent].append(at)
        if link.mass > 0.0 and link.joint is not None and not carries[link.name]:
            # An arm's last part ends where nobody says; its com is on the way there.
            carried[link.name].append(len(recipe.contacts) + len(marks))
            marks.append(Contact(link.name, link.name, link.com))
    if not any(link.mass > 0.0 for link in recipe.links):
        # The com of a robot without masses is the origin of its body.
        root = next(link.name for link in recipe.links if link.parent is None)
        carried.setdefault(root, []).append(len(recipe.contacts) + len(marks))
        marks.append(Contact(root, root, (0.0, 0.0, 0.0)))
    links = tuple(link.name for link in recipe.links if carried.get(link.name))
    marked = replace(recipe, contacts=(*recipe.contacts, *marks))
    return marked, links, {name: tuple(places) for name, places in carried.items()}


def _add_link(shape: Shape, places: Floats, same: float) -> None:
    """Add the hull of places (k, 3): faces, one polygon where it is flat, a bone where straight."""
    apart = [p for at, p in enumerate(places) if not _is_among(p, places[:at], same)]
    if len(apart) < 2:
        return
    places = np.array(apart)
    middle = places.mean(axis=0)
    _, spread, directions = np.linalg.svd(places - middle)
    rank = int((spread > 1e3 * same).sum())
    flat = (places - middle) @ directions[:2].T
    if rank <= 1:
        along = flat[:, 0]
        shape.bones.append(places[[int(along.argmin()), int(along.argmax())]])
        return
    # Loading it takes a while, and few figures need it.
    from scipy.spatial import ConvexHull

    if rank == 2:
        shape.faces.append(places[ConvexHull(flat).vertices])
    else:
        shape.faces.extend(places[corners] for corners in ConvexHull(places).simplices)


def _is_among(place: Floats, others: Floats, same: float) -> bool:
    return bool((np.linalg.norm(others - place, axis=1) <= same).any())


def _add_belts(
    shape: Shape, recipe: Recipe, centres: Floats, axes: Floats, discs: list[int]
) -> None:
    """Add the outline of every group of discs, some of one link's, that lie in one plane."""
    from scipy.spatial import ConvexHull

    left = list(discs)
    while len(left) > 1:
        first, *others = left
        axis = axes[first]
        reach = float(np.linalg.norm(centres[discs] - centres[first], axis=1).max())
        group = [first] + [
            at
            for at in others
            if abs(axis @ axes[at]) > 1.0 - SAME
            and abs((centres[at] - centres[first]) @ axis) <= 1e3 * SAME * reach
        ]
        left = [at for at in others if at not in group]
        if len(group) > 1:
            rims = np.concatenate(
                [circle(centres[at], axis, recipe.contacts[at].radius) for at in group]
            )
            basis = np.linalg.svd(axis[None, :])[2][1:]
            corners = ConvexHull((rims - centres[first]) @ basis.T).vertices
            shape.belts.append(rims[[*corners, corners[0]]])

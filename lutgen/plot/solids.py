"""Solids: what a robot looks like, from its links, discs and masses.

1. Discs of one `belt` are a track; other discs are wheels, 0.65 radii wide or their `width`,
   inwards.  Without any `belt`, discs in one plane of a link called track or flipper are one.
2. A link between tracks, many or hinged wheels gets a box, a link between two wheels an axle.
3. A link on a joint is a tube from its origin to its contacts and to the origins of its children.
4. A mass without contacts is a box: its `shape`, or a block with the density of water.
5. Three or more hinges on the first link are joined by a plate.
"""

import re
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import ConvexHull

from lutgen.parts import Contact, Link
from lutgen.plot.painter import Solid, box, circle, tube
from lutgen.plot.style import colours
from lutgen.recipe import Recipe, forward
from lutgen.vector import Floats

TRACK = re.compile(r"track|flipper|belt|crawler|caterpillar", re.IGNORECASE)
UNITS = {"m": 1.0, "cm": 100.0, "mm": 1000.0}
# Widths of wheels and radii of axles and hubs in radii of a disc; of tubes and arms, and how thick
# a plate is, in sizes of the robot.
WHEEL, AXLE, HUB, TUBE, ARM, PLATE = 0.65, 0.22, 0.62, 0.035, 0.05, 0.12
# kg/m^3.  A block with a longer edge (m) than BULKY is a body, to which its joint needs no tube.
WATER, BULKY = 1000.0, 0.6


@dataclass(frozen=True)
class Body:
    """A robot's parts, com at the origin, body frame.

    `places` and `axes` (n, 3) are those of its contacts; `origin`, `com` (3,) and `turn` (3, 3)
    those of its links by name; `size` is the reach of its contacts.
    """

    recipe: Recipe
    places: Floats
    axes: Floats
    origin: dict[str, Floats]
    com: dict[str, Floats]
    turn: dict[str, Floats]
    size: float

    def mine(self, link: Link, kind: str = "") -> list[int]:
        """Return the contacts of a link, all or of one kind."""
        every = enumerate(self.recipe.contacts)
        return [i for i, c in every if c.link == link.name and kind in ("", c.kind)]

    def children(self, link: Link) -> list[Link]:
        """Return the links on a link."""
        return [other for other in self.recipe.links if other.parent == link.name]

    def block(self, link: Link) -> float:
        """Return the edge of a cube of water as heavy as a link; 0 if it is part of a track."""
        unit = UNITS.get(self.recipe.length_unit, 0.0)
        return 0.0 if TRACK.search(link.name) else (link.mass / WATER) ** (1.0 / 3.0) * unit

    def is_bulky(self, link: Link) -> bool:
        """Return True if the block of a link is a body and no arm."""
        return self.block(link) > BULKY * UNITS.get(self.recipe.length_unit, 1.0)

    def cube(self, link: Link) -> list[Solid]:
        """Return the box of a link's mass, if it has one."""
        edge = self.block(link)
        # Sensors of a few grams are not drawn.
        half = np.array(link.shape or [edge if edge > 0.04 * self.size else 0.0] * 3) / 2.0
        turn, at = self.turn[link.name], self.com[link.name]
        if link.shape_at is not None:
            at = self.origin[link.name] + turn @ link.shape_at
        return [box(-half, half, colours().body, turn, at)] if half.all() else []

    def bars(self, start: Floats, ends: list[Floats], radius: float) -> list[Solid]:
        """Return tubes of a radius (in sizes of the robot) to all ends that are not too near."""
        far = [end for end in ends if np.linalg.norm(end - start) > 0.02 * self.size]
        return [tube(start, end, radius * self.size, colours().body) for end in far]


@lru_cache(maxsize=8)
def _marked(recipe: Recipe) -> Recipe:
    """Return a robot with the origins, centres of mass and axes of its links among its contacts."""
    marks = list(recipe.contacts)
    for link in recipe.links:
        ends = [(0.0, 0.0, 0.0), link.com, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
        marks += [Contact(link.name, link.name, end) for end in ends]
    return replace(recipe, contacts=tuple(marks), wheels=())


def _body_of(recipe: Recipe, params: ArrayLike) -> Body:
    """Return where the parts of a robot are at a posture (k,), rad or length."""
    links = () if recipe.python else recipe.links
    whole = _marked(recipe) if links else recipe
    found = forward(whole, np.asarray(params, np.float64)[None, :])
    count = len(found.centres[0]) - 5 * len(links)
    places, marks = np.split(found.centres[0], [count])
    marks = marks.reshape(-1, 5, 3)
    by_name = dict(zip((link.name for link in links), marks, strict=True))
    origin, com = ({name: mark[i] for name, mark in by_name.items()} for i in (0, 1))
    turn = {name: (mark[2:] - mark[0]).T for name, mark in by_name.items()}
    size = reach_of(recipe, places)
    return Body(recipe, places, found.axes[0][:count], origin, com, turn, size)


def reach_of(recipe: Recipe, places: Floats) -> float:
    """Return how far contacts (n, 3) reach from the com."""
    radii = np.array([contact.radius for contact in recipe.contacts] or [0.0])
    return max(float((np.linalg.norm(places, axis=1) + radii).max()), 1e-9)


def solids_of(recipe: Recipe, params: ArrayLike) -> list[Solid]:
    """Return a robot's solids at a posture (k,); of a robot of code, tubes to its contacts."""
    body, made = _body_of(recipe, params), []
    for link in () if recipe.python else recipe.links:
        tracked, rims = _rims(body, link)
        between = [] if link.shape else _between(body, link, tracked, len(rims))
        made += rims + between
        feet, arm = body.mine(link), link.joint is not None and body.children(link)
        if link.shape or not (between or rims or feet or (arm and not body.is_bulky(link))):
            made += body.cube(link)
        elif len(rims) == 2 and not tracked and not between:
            made += _axle(body, link, rims)
        if (link.joint or feet) and not rims and not body.is_bulky(link):
            ends = [body.places[i] for i in feet]
            ends += [body.origin[child.name] for child in body.children(link)]
            made += body.bars(body.origin[link.name], ends, TUBE)
        if link.parent is None and not (between or link.shape):
            made += _plate(body, link)
    for place, contact in zip(body.places, recipe.contacts, strict=False):
        if contact.kind == "sphere":
            made += _ball(place, contact.radius)
    return made or body.bars(np.zeros(3), list(body.places), TUBE)


def _rims(body: Body, link: Link) -> tuple[bool, list[Solid]]:
    """Return the tracks and wheels of a link, after True if it runs on tracks."""
    contacts, left, rims = body.recipe.contacts, body.mine(link, "disc"), []
    belts = any(contact.belt for contact in contacts)
    named = any(TRACK.search(f"{link.name} {contacts[i].name}") for i in left) and not belts
    tracked = named or any(contacts[i].belt for i in left)
    while left:
        first = left[0]
        group = [first]
        if named or contacts[first].belt:
            offset = np.abs((body.places[left] - body.places[first]) @ body.axes[first])
            plane = [i for i, far in zip(left, offset, strict=True) if far < 1e-6 * body.size]
            group = [i for i in plane if contacts[i].belt == contacts[first].belt]
        left = [i for i in left if i not in group]
        rims.append(_rim(body, group))
    return tracked, rims


def _rim(body: Body, group: list[int]) -> Solid:
    """Return a track around discs, or a wheel, from its rim inwards."""
    radii = [body.recipe.contacts[i].radius for i in group]
    centres, axis = body.places[group], body.axes[group[0]]
    width = body.recipe.contacts[group[0]].width or WHEEL * max(radii)
    rims = np.concatenate([circle(c, axis, r, 48) for c, r in zip(centres, radii, strict=True)])
    basis = np.linalg.svd(axis[None, :])[2][1:]
    outline = rims[ConvexHull((rims - centres[0]) @ basis.T).vertices]
    side = float(centres.mean(axis=0) @ axis)
    along = -np.sign(side or 1.0) * width * axis
    # A wheel in the middle of the robot is as wide to both sides.
    shift = along / 2.0 if abs(side) < width else 0.0 * along
    hubs = [(c - shift, HUB * r) for c, r in zip(centres, radii, strict=True)]
    return Solid(outline - shift, along, colours().track, hubs=hubs)


def _between(body: Body, link: Link, tracked: bool, rims: int) -> list[Solid]:
    """Return the box between the tracks of a link, or between wheels that are hinged to it."""
    turn, origin = body.turn[link.name], body.origin[link.name]
    around = body.mine(link, "disc") if rims > (1 if tracked else 2) else []
    for child in body.children(link) if not rims else ():
        for i in body.mine(child, "disc"):
            away = np.cross(body.places[i] - body.origin[child.name], body.axes[i])
            around += [i] if np.linalg.norm(away) < 1e-6 * body.size else []
    if len(around) < 3:
        return []
    side, spots = int(np.argmax(np.abs(turn.T @ body.axes[around[0]]))), body.places[around]
    spots = (spots - origin) @ turn
    radius = max(body.recipe.contacts[i].radius for i in around)
    half = np.abs(spots[:, side]).min() - 0.75 * radius
    if side == 2 or half <= 0.0 or np.ptp(spots[:, 1 - side]) <= 0.0:
        return []
    top = spots[:, 2].max() + 0.5 * radius
    if link.mass:
        top = max(top, (body.com[link.name] - origin) @ turn[:, 2] + 0.45 * body.block(link))
    low, high = spots.min(axis=0) - 0.45 * radius, spots.max(axis=0) + 0.1 * radius
    low[side], high[side], high[2] = -half, half, top
    return [box(low, high, colours().body, turn, origin)]


def _axle(body: Body, link: Link, rims: list[Solid]) -> list[Solid]:
    """Return the axle between two wheels, the block of the mass on it, and arms to its joints."""
    start, stop = (rim.outline.mean(axis=0) + rim.along for rim in rims)
    if np.linalg.norm(stop - start) < 1e-6 * body.size:
        return []
    made = [tube(start, stop, AXLE * np.ptp(rims[0].outline, axis=0).max() / 2.0, colours().track)]
    made += body.cube(link)
    if made[1:]:
        at = body.com[link.name]
        joints = [c.name for c in [*body.children(link), link] if c.joint is not None]
        arms = [body.origin[name] - at for name in joints]
        long = [arm for arm in arms if np.linalg.norm(arm) > BULKY * body.block(link)]
        made += [made_ for arm in long for made_ in body.bars(at + 0.4 * arm, [at + arm], ARM)]
    return made


def _plate(body: Body, link: Link) -> list[Solid]:
    """Return the plate that joins the hinges of the first link."""
    hips = np.array([body.origin[child.name] for child in body.children(link)]).reshape(-1, 3)
    turn = body.turn[link.name]
    flat = (hips - hips.mean(axis=0)) @ turn if len(hips) > 2 else np.zeros((3, 3))
    if np.linalg.svd(flat[:, :2])[1].min() < 0.02 * body.size:
        return []
    corners = ConvexHull(flat[:, :2]).vertices
    level = hips[corners] - np.outer(flat[corners, 2], turn[:, 2])
    thick = PLATE * body.size * turn[:, 2]
    return [Solid(level - thick / 2.0, thick, colours().body, hard=True)]


def _ball(place: Floats, radius: float) -> list[Solid]:
    """Return a ball as three discs on each other."""
    up, made = np.array([0.0, 0.0, 0.5 * radius]), []
    for level in (-1.5, -0.5, 0.5):
        wide = radius * float(np.sqrt(1.0 - ((level + 0.5) / 2.0) ** 2))
        rim = circle(place + level * up, np.array([0.0, 0.0, 1.0]), wide, 24)
        made.append(Solid(rim, up, colours().track))
    return made

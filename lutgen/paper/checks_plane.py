"""Checks of Eqs 2 to 11: which wheels stand on the ground, and where gravity meets it."""

from itertools import combinations

import numpy as np

from lutgen.channels import stability
from lutgen.paper import printed, reference
from lutgen.paper.erratum import Checks, Example, check, coordinates
from lutgen.paper.forces import pierced_point
from lutgen.paper.nominal import Array
from lutgen.paper.triples import CONTACTS, passing_triples, triple_statistics


def combinations_of_three(_: Example) -> Checks:
    """Compare how many attempts take every triple once: n, Eq 2, and counting."""
    for n in (3, 5, 6):
        claim = f"attempts that take every triple of {n} contact points once"
        yield check(claim, n, printed.eq2(n), len(list(combinations(range(n), 3))))


def direction_of_line(example: Example) -> Checks:
    """Compare where the line of Eq 3 meets the plane for v = g, for v = -g, and by solving."""
    wheels, gravity = example.wheels, example.gravity
    t1 = printed.eq7(printed.normal_of(wheels), wheels[0], gravity)
    along, ours = gravity * (1.0 + t1), printed.eq4_to_6(gravity, t1)
    truth = reference.pierced_by_solving(wheels, gravity)
    yield check("$z$ of $D_g$, with $t_1$ of Eq 7", along[2], ours[2], truth[2])


def pierced_point_of_eq_7(example: Example) -> Checks:
    """Compare D_g of Eqs 4 to 7, its shorter form, and by solving."""
    wheels, gravity = example.wheels, example.gravity
    normal = printed.normal_of(wheels)
    form = printed.eq4_to_6(gravity, printed.eq7(normal, wheels[0], gravity))
    short = gravity * (normal @ wheels[0]) / (normal @ gravity)
    yield from coordinates("$D_g$", form, short, reference.pierced_by_solving(wheels, gravity))


def line_or_ray(example: Example) -> Checks:
    """Compare in how many directions the robot stands: the line, the ray, and the library."""
    wheels = example.wheels
    half = np.random.default_rng(example.seed).normal(size=(500, 3))
    directions = np.vstack([half, -half])
    normal = printed.normal_of(wheels)
    line = ray = 0
    for gravity in directions:
        t1 = printed.eq7(normal, wheels[0], gravity)
        weights = np.linalg.solve(wheels.T, printed.eq4_to_6(gravity, t1))
        inside = bool((weights > 0.0).all())
        line += inside
        ray += inside and 1.0 - t1 > 0.0
    angle = stability(wheels[None], directions, ("tip_angle",))["tip_angle"]
    claim = f"of {len(half)} random directions and their opposites, those in which the robot stands"
    yield check(claim, line, ray, (angle >= 0.0).sum())


def triple_and_hull(example: Example) -> Checks:
    """Compare how often the triples that pass both tests are the facet of the convex hull."""
    found = triple_statistics(400, example.seed)
    yield check(
        f"of {found.sets} random sets of {min(CONTACTS)} to {max(CONTACTS)} contacts, those in "
        "which the triples that pass both tests are the facet through which gravity's ray leaves "
        "the convex hull",
        found.sets,
        found.agree,
        found.sets,
    )
    yield check("most triples of one set that pass both tests", 1, found.most_passing, 1)


def coplanar_wheels(example: Example) -> Checks:
    """Compare four wheels in a plane: the first triple, the polygon, and Green's theorem."""
    contacts, gravity = reference.four_contacts(example.wheels), example.gravity
    passing = passing_triples(contacts, gravity)
    pierced = reference.pierced_by_solving(contacts, gravity)
    holding = sum(_holds(contacts[list(t)], pierced) for t in combinations(range(4), 3))
    yield check("triples of four coplanar contacts that pass both tests", 1, len(passing), holding)
    first = contacts[list(passing[0])].mean(axis=0)
    form = printed.eq29(pierced_point(contacts, gravity), first)
    truth = np.linalg.norm(pierced - reference.contour_centroid(contacts))
    ours = reference.stability_factor(contacts, gravity)
    yield check("$|SD_g|$ on four coplanar contacts", form, ours, truth)


def foot_of_eq_11(example: Example) -> Checks:
    """Compare D_c of Eqs 8 to 11, its shorter form, and by least squares."""
    wheels = example.wheels
    normal = printed.normal_of(wheels)
    form = printed.eq8_to_11(normal, wheels[0])
    short = normal * (normal @ wheels[0]) / (normal @ normal)
    yield from coordinates("$D_c$", form, short, reference.foot_by_least_squares(wheels))


def name_of_foot(example: Example) -> Checks:
    """Compare the height from D_g, from D_c, and from a volume over an area."""
    wheels, gravity = example.wheels, example.gravity
    form = printed.eq28(pierced_point(wheels, gravity))
    ours = printed.eq28(printed.eq8_to_11(printed.normal_of(wheels), wheels[0]))
    across = np.cross(wheels[1] - wheels[0], wheels[2] - wheels[0])
    truth = abs(np.linalg.det(wheels)) / np.linalg.norm(across)
    claim = "$|OC|$ by Eq 28 from the named point; reference: volume over area"
    yield check(claim, form, ours, truth)


def _holds(triangle: Array, point: Array) -> bool:
    """Return whether a point is inside a triangle, by the three turns in the XY plane."""
    arms = triangle[:, :2] - point[:2]
    ahead = np.roll(arms, -1, axis=0)
    turns = arms[:, 0] * ahead[:, 1] - arms[:, 1] * ahead[:, 0]
    return bool((turns > 0.0).all() or (turns < 0.0).all())

"""Errata of Eqs 2 to 11: which wheels stand on the ground, and where gravity meets it."""

from itertools import combinations

import numpy as np

from lutgen.channels import stability
from lutgen.paper import printed
from lutgen.paper.erratum import Array, Erratum, Example, check, coordinates
from lutgen.paper.forces import pierced_point
from lutgen.paper.reference import (
    contour_centroid,
    foot_by_least_squares,
    four_contacts,
    pierced_by_solving,
    stability_factor,
)
from lutgen.paper.triples import passing_triples, triple_statistics


def errata(example: Example) -> tuple[Erratum, ...]:
    """Return the errata of Eqs 2 to 11 in the order of the paper."""
    return (
        _combinations(),
        _line(example),
        _pierced(example),
        _ray(example),
        _triples(example),
        _coplanar(example),
        _foot(example),
        _foot_name(example),
    )


def _combinations() -> Erratum:
    checks = tuple(
        check(
            f"attempts that take every triple of {n} contact points once",
            float(n),
            printed.eq2(n),
            float(len(list(combinations(range(n), 3)))),
        )
        for n in (3, 5, 6)
    )
    return Erratum(
        "Eq 2, text before Eq 8",
        "the iteration runs maximally once with every combination (n times)",
        "k_max = n(n - 1)(n - 2)/6 times",
        "Eq 2 itself is right; n and k_max are equal for n = 4 only.",
        checks,
    )


def _line(example: Example) -> Erratum:
    wheels, gravity = example.wheels, example.gravity
    t1 = printed.eq7(printed.normal_of(wheels), wheels[0], gravity)
    along = gravity * (1.0 + t1)
    ours = printed.eq4_to_6(gravity, t1)
    truth = pierced_by_solving(wheels, gravity)
    checks = (check("z of D_g, with t_1 of Eq 7", along[2], ours[2], truth[2]),)
    return Erratum(
        "Eq 3",
        "r - r_0 = t v, v is the direction vector of the line",
        "r - r_0 = t v with r_0 = g and v = -g",
        "The direction is never given.  Eqs 4 to 7 hold for v = -g; with the natural v = g the "
        "same t_1 leads to g(1 + t_1), which is not in the plane.",
        checks,
    )


def _pierced(example: Example) -> Erratum:
    wheels, gravity = example.wheels, example.gravity
    normal = printed.normal_of(wheels)
    form = printed.eq4_to_6(gravity, printed.eq7(normal, wheels[0], gravity))
    short = gravity * (normal @ wheels[0]) / (normal @ gravity)
    truth = pierced_by_solving(wheels, gravity)
    return Erratum(
        "Eqs 4 to 7",
        "t_1 = -n.(P1 - g)/(n.g), D_g = g(1 - t_1)",
        "as printed; shorter: D_g = g (n.P1)/(n.g)",
        "1 - t_1 = n.P1/(n.g).  There is no such point where n.g = 0.",
        coordinates("D_g", form, short, truth),
        confirmed=True,
    )


def _ray(example: Example) -> Erratum:
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
    checks = (
        check(
            "of 500 random directions and their opposites, those in which the robot stands",
            float(line),
            float(ray),
            float((angle >= 0.0).sum()),
        ),
    )
    return Erratum(
        "text before Eq 3",
        "the continuance of the vector (3D line) should intersect the plane inside the triangle",
        "the ray from the com along g, so 1 - t_1 > 0 as well",
        "The line has two ends: without this test a robot that hangs upside down from its wheels "
        "is found to stand.",
        checks,
    )


def _triples(example: Example) -> Erratum:
    found = triple_statistics(400, example.seed)
    checks = (
        check(
            "of 400 random sets of 4 to 7 contacts, those in which the triples that pass both "
            "tests are the facet through which gravity's ray leaves the convex hull",
            float(found.sets),
            float(found.agree),
            400.0,
        ),
        check("most triples of one set that pass both tests", 1.0, float(found.most_passing), 1.0),
    )
    return Erratum(
        "text before Eq 3, point error and intersection error",
        "the three wheels pass when no contact is beyond their plane and g goes through their "
        "triangle",
        "as printed, with the ray instead of the line and no four contacts in a plane",
        "The triple is then the hull's facet and unique, so the order of the attempts changes "
        "the time and not the answer.",
        checks,
        confirmed=True,
    )


def _coplanar(example: Example) -> Erratum:
    contacts, gravity = four_contacts(example.wheels), example.gravity
    passing = passing_triples(contacts, gravity)
    pierced = pierced_by_solving(contacts, gravity)
    first = contacts[list(passing[0])].mean(axis=0)
    holding = sum(_holds(contacts[list(t)], pierced) for t in combinations(range(4), 3))
    checks = (
        check("triples of four coplanar contacts that pass both tests", 1.0, len(passing), holding),
        check(
            "|SD_g| on four coplanar contacts",
            printed.eq29(pierced_point(contacts, gravity), first),
            stability_factor(contacts, gravity),
            float(np.linalg.norm(pierced - contour_centroid(contacts))),
        ),
    )
    return Erratum(
        "text before Eq 8, first successful case",
        "the first triple that passes gives the ground plane and its wheels",
        "all contacts on that plane make one convex polygon; test the ray against it",
        "On four wheels in a plane two triples pass, and which comes first decides the centre S.",
        checks,
    )


def _foot(example: Example) -> Erratum:
    wheels = example.wheels
    normal = printed.normal_of(wheels)
    form = printed.eq8_to_11(normal, wheels[0])
    short = normal * (normal @ wheels[0]) / (normal @ normal)
    return Erratum(
        "Eqs 8 to 11",
        "t_2 = -n.(P1 - n)/(n.n), D_c = n(1 - t_2)",
        "as printed; shorter: D_c = n (n.P1)/(n.n)",
        "1 - t_2 = n.P1/(n.n), for n of any length and sign.",
        coordinates("D_c", form, short, foot_by_least_squares(wheels)),
        confirmed=True,
    )


def _foot_name(example: Example) -> Erratum:
    wheels, gravity = example.wheels, example.gravity
    tripled = abs(float(np.linalg.det(wheels)))
    doubled = float(np.linalg.norm(np.cross(wheels[1] - wheels[0], wheels[2] - wheels[0])))
    checks = (
        check(
            "|OC| by Eq 28 from the named point; reference: volume over area",
            printed.eq28(pierced_point(wheels, gravity)),
            printed.eq28(printed.eq8_to_11(printed.normal_of(wheels), wheels[0])),
            tripled / doubled,
        ),
    )
    return Erratum(
        "text before Eq 8",
        "d_cx, d_cy, d_cz are the coordinates of the intersection point (D_g)",
        "of the intersection point (D_c)",
        "D_c is where the plane's normal through the com meets the plane; D_g is where gravity "
        "does.",
        checks,
    )


def _holds(triangle: Array, point: Array) -> bool:
    """Return whether a point is inside a triangle, by the three turns in the XY plane."""
    arms = triangle[:, :2] - point[:2]
    ahead = np.roll(arms, -1, axis=0)
    turns = arms[:, 0] * ahead[:, 1] - arms[:, 1] * ahead[:, 0]
    return bool((turns > 0.0).all() or (turns < 0.0).all())

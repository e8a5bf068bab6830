"""Errata of Eqs 22 to 29: the centre of the support polygon and the stability factor."""

import numpy as np

from lutgen.paper import printed
from lutgen.paper.erratum import AXES, Array, Erratum, Example, check, coordinates
from lutgen.paper.forces import nominal_wheels, pierced_point
from lutgen.paper.reference import (
    contour_centroid,
    factor_at_tipping,
    four_contacts,
    pierced_by_solving,
    polygon_centre,
    stability_factor,
)

# Weights of a fifth contact on the three wheels, outside all edges, and the share by which it is
# pulled from the plane towards the com.
FIFTH = np.array([0.4, 1.0, -0.4])
LIFT = 0.9


def errata(example: Example) -> tuple[Erratum, ...]:
    """Return the errata of Eqs 22 to 29 in the order of the paper."""
    return (
        _vertex_mean(example),
        _projected_area(example),
        _fan(example),
        _vertical(example),
        _height(example),
        _factor(example),
        _limit(),
    )


def eq27_corrected(normal: Array, contact: Array, sx: float, sy: float) -> float:
    """Return s_z = (n . P1 - a s_x - b s_y) / c."""
    a, b, c = normal
    return float((normal @ contact - a * sx - b * sy) / c)


def _vertex_mean(example: Example) -> Erratum:
    contacts = four_contacts(example.wheels)
    return Erratum(
        "text before Eq 22",
        "the centre of the polygon is the average of all points of the polygon",
        "the area centroid, as Eqs 22 to 26 have it",
        "The average of the corners is another point unless there are three.",
        coordinates(
            "the centre of four contacts",
            contacts.mean(axis=0),
            polygon_centre(contacts),
            contour_centroid(contacts),
        ),
    )


def _projected_area(example: Example) -> Erratum:
    wheels = example.wheels
    arms = wheels[1:, :2] - wheels[0, :2]
    across = np.cross(wheels[1] - wheels[0], wheels[2] - wheels[0])
    ours = float(np.linalg.norm(across)) / 2.0 * float(printed.normal_of(wheels)[2])
    checks = (
        check(
            "T of the wheels' triangle; ours: its area in 3-D times c",
            printed.eq24(wheels),
            ours,
            abs(float(np.linalg.det(arms))) / 2.0,
        ),
    )
    return Erratum(
        "Eq 24",
        "T = |x1(y2 - y3) + x2(y3 - y1) + x3(y1 - y2)|/2",
        "as printed",
        "It is the projected area, which serves as weight as long as the plane is not vertical.",
        checks,
        confirmed=True,
    )


def _fan(example: Example) -> Erratum:
    contacts = four_contacts(example.wheels)
    fifth = LIFT * (FIFTH @ example.wheels)
    around = np.vstack([contacts[[0, 1]], contacts[[3, 2]]])
    # The polygon's order with the fifth between the first and the second contact.
    with_hovering = np.vstack([around[:1], fifth, around[1:]])
    ours, truth = polygon_centre(contacts), contour_centroid(contacts)
    claim = "{} of the centre of four contacts, {}"
    unordered = "in the order of their numbers"
    hovering = "with a fifth that hovers"
    checks = tuple(
        check(claim.format(AXES[i], words), form[i], ours[i], truth[i])
        for form, words in (
            (printed.eq25_26(contacts), unordered),
            (printed.eq25_26(with_hovering), hovering),
        )
        for i in (0, 1)
    )
    return Erratum(
        "Eqs 25 and 26",
        "s_x = sum(i = 1..n) T_i S_ix / sum(i = 1..n) T_i",
        "the sums run over the n_a - 2 triangles of a fan in the convex polygon of the n_a "
        "contacts on the plane, taken in order round it; s_ix as in Eq 22",
        "n counts contact points, hovering ones too, and a fan in any other order overlaps "
        "itself, which |T| hides.",
        checks,
    )


def _vertical(example: Example) -> Erratum:
    # With coordinates of few bits the projected area is 0 and not rounding noise.
    wheels = np.round(example.wheels[:, [2, 0, 1]] * 1024.0) / 1024.0
    wheels[:, 0] = wheels[0, 0]
    normal = printed.normal_of(wheels)
    sx, sy = printed.eq25_26(wheels)
    form = np.array([sx, sy, printed.eq27(normal, wheels[0], sx, sy)])
    return Erratum(
        "Eqs 24 to 27, vertical plane",
        "projected to the XY plane",
        "weigh with the areas in the polygon's own plane, in 3-D",
        "A vertical plane has c = 0 and a projected area of 0, so the printed centre is 0/0; a "
        "robot on its side has such planes.",
        coordinates(
            "the centre in a vertical plane", form, polygon_centre(wheels), wheels.mean(axis=0)
        ),
    )


def _height(example: Example) -> Erratum:
    wheels = example.wheels
    sx, sy = printed.eq25_26(wheels)
    truth = float(wheels[:, 2].mean())
    checks = tuple(
        check(
            f"s_z of the wheels' triangle, {words}; reference: mean of the corners",
            printed.eq27(normal, wheels[0], sx, sy),
            eq27_corrected(normal, wheels[0], sx, sy),
            truth,
        )
        for words, normal in (
            ("unit normal", printed.normal_of(wheels)),
            ("normal of length 3.7", 3.7 * printed.normal_of(wheels)),
            ("unit normal of the other sign", -printed.normal_of(wheels)),
        )
    )
    return Erratum(
        "Eq 27",
        "s_z = a x1 + b y1 + c z1 - (a s_x + b s_y)/c",
        "s_z = (a x1 + b y1 + c z1 - a s_x - b s_y)/c",
        "Only a part is divided by c, so the result depends on the length and the sign of n; it "
        "is right for c = 1 only.  For a unit normal the error is n.P1 (1 - 1/c).",
        checks,
    )


def _factor(example: Example) -> Erratum:
    wheels, gravity = example.wheels, example.gravity
    pierced = pierced_by_solving(wheels, gravity)
    checks = (
        check(
            "|SD_g| with s_z of the corrected Eq 27",
            printed.eq29(pierced_point(wheels, gravity), polygon_centre(wheels)),
            stability_factor(wheels, gravity),
            float(np.linalg.norm(pierced - wheels.mean(axis=0))),
        ),
    )
    return Erratum(
        "Eq 29",
        "|SD_g| = sqrt((d_gx - s_x)^2 + (d_gy - s_y)^2 + (d_gz - s_z)^2)",
        "as printed",
        "It is a length and grows with the robot.",
        checks,
        confirmed=True,
    )


def _limit() -> Erratum:
    wheels = nominal_wheels()
    radius = float(np.hypot(*wheels[0, :2]))
    checks = (
        check(
            "|SD_g| at which the nominal robot tips over a wheel",
            10.0,
            radius,
            factor_at_tipping(wheels, 0.0),
        ),
        check(
            "|SD_g| at which a robot of twice the size tips over an edge",
            10.0,
            2.0 * radius * np.cos(np.pi / 3),
            factor_at_tipping(2.0 * wheels, np.pi),
        ),
    )
    return Erratum(
        "limit of |SD_g|, text before Table 1",
        "|SD_g| > 10 tips over",
        "the ray outside the support polygon tips over",
        "10 is the distance from the centre to an edge of a triangle of circumradius 20; the "
        "limit is twice that towards a wheel and scales with the robot.",
        checks,
    )

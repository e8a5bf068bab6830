"""Errata of Eqs 12 to 21: normal forces, static moments, and what a small |SD_g| means."""

import numpy as np

from lutgen.analysis import heuristic_forces, normal_forces
from lutgen.channels import stability
from lutgen.paper import printed
from lutgen.paper.closed_form import NOMINAL, tripods
from lutgen.paper.erratum import Array, Check, Erratum, Example, check
from lutgen.paper.forces import RADIUS, exact_forces, nominal_wheels, pierced_point, slope_gravity
from lutgen.paper.reference import (
    contour_centroid,
    edge_distance,
    four_contacts,
    incentre,
    largest_inscribed_radius,
    polygon_centre,
)

DOWN = np.array([0.0, 0.0, -1.0])


def errata(example: Example) -> tuple[Erratum, ...]:
    """Return the errata of Eqs 12 to 21 and of the block diagram in the order of the paper."""
    return (
        _ratios(example),
        _sign(),
        _moments(example),
        _reference(),
        _static_moment(example),
        _torque(example),
        _equal_loads(example),
        _indeterminate(example),
        _stability(example),
        _objective(example),
    )


def line_distances(wheels: Array, gravity: Array) -> Array:
    """Return L, (n,), as the text before Eq 1 has it: from gravity's line, projected to XY."""
    down = gravity / np.linalg.norm(gravity)
    arms = wheels - np.outer(wheels @ down, down)
    return np.asarray(np.linalg.norm(arms[:, :2], axis=1))


def point_distances(wheels: Array, gravity: Array) -> Array:
    """Return L, (n,), as the text before Eq 12 has it: from D_g."""
    return np.asarray(np.linalg.norm(wheels - pierced_point(wheels, gravity), axis=1))


def _ratios(example: Example) -> Erratum:
    wheels, gravity = example.wheels, example.gravity
    b = np.linalg.solve(wheels.T, gravity)
    from_line = line_distances(wheels, gravity)
    from_point = point_distances(wheels, gravity)
    truth = np.linalg.norm(wheels - wheels.T @ b / b.sum(), axis=1)
    return Erratum(
        "text before Eq 1 against text before Eq 12",
        "distances between the gravitational vector and the contact points, projected to the XY "
        "plane",
        "distances of the contact points from D_g, in the contact plane",
        "Two definitions of the ratio numbers L.  They are equal only where the plane is parallel "
        "to XY and gravity perpendicular to both.",
        tuple(
            check(f"L of wheel {i + 1}", from_line[i], from_point[i], truth[i]) for i in range(3)
        ),
    )


def _sign() -> Erratum:
    wheels = nominal_wheels()
    distances = point_distances(wheels, DOWN)
    pierced = pierced_point(wheels, DOWN)
    checks: list[Check] = [
        check(
            "force on wheel 1 of the nominal robot, share of |N_g|",
            printed.eq12(distances)[0],
            heuristic_forces(wheels, pierced)[0],
            normal_forces(wheels, pierced)[0],
        )
    ]
    for n in (3, 4, 5, 6):
        angle = np.arange(n) ** 1.1
        points = np.column_stack([RADIUS * np.cos(angle), RADIUS * np.sin(angle), np.zeros(n)])
        off = np.array([1.0, 2.0, 0.0])
        checks.append(
            check(
                f"sum of the forces on {n} contacts, share of |N_g|",
                printed.eq12(np.linalg.norm(points - off, axis=1)).sum(),
                heuristic_forces(points, off).sum(),
                1.0,
            )
        )
    return Erratum(
        "Eq 12, sign",
        "|F_ni| = -|N_g|/sum(L) (sum(L)/(n_a/2) - L_i)",
        "the same without the leading minus",
        "As printed, every force of the nominal robot is negative; without the minus they add up "
        "to |N_g| for every n_a.",
        tuple(checks),
    )


def _moments(example: Example) -> Erratum:
    cases = [("the example robot", example.wheels, example.gravity)]
    cases += [
        (
            f"the nominal robot, wheel {which} on a slope of {pitch} deg",
            nominal_wheels(),
            slope_gravity(np.radians(pitch), heading),
        )
        for which, pitch, heading in (("1 uphill", 30.0, 0.0), ("1 downhill", 58.0, np.pi))
    ]
    checks = []
    for words, wheels, gravity in cases:
        pierced = pierced_point(wheels, gravity)
        checks.append(
            check(
                f"force on wheel 1 of {words}, share of |N_g|, minus dropped",
                heuristic_forces(wheels, pierced)[0],
                exact_forces(wheels, gravity)[0],
                normal_forces(wheels, pierced)[0],
            )
        )
    return Erratum(
        "Eq 12, moments",
        "|F_ni| = |N_g|/sum(L) (sum(L)/(n_a/2) - L_i), the minus dropped",
        "n_a = 3: F_i = |N_g| b_i/sum(b) with [P1 P2 P3] b = g",
        "The forces add up but their moment about D_g is not zero: a wheel that lifts off still "
        "carries a fifth, and in narrow triangles a wheel pulls at the ground.",
        tuple(checks),
    )


def _reference() -> Erratum:
    return Erratum(
        "text before Eq 14",
        "from Equation (4.13)",
        "from Equation (13)",
        "A number of another document.",
    )


def _static_moment(example: Example) -> Erratum:
    places, masses = example.elements, example.masses
    total = float(masses.sum())
    about_origin = masses @ places
    centre = about_origin / total
    checks = (
        check(
            "|S_MS| of the point masses, r being the place of the first",
            np.linalg.norm(printed.eq16(about_origin, total, places[0])),
            np.linalg.norm(about_origin - total * centre),
            np.linalg.norm(sum(m * (p - centre) for m, p in zip(masses, places, strict=True))),
        ),
    )
    return Erratum(
        "Eq 16",
        "S_MS = S_MO - m r = 0",
        "S_MS = S_MO - m r_s = 0",
        "r is the variable of the integral; only r_s, the centre of mass, makes it zero.",
        checks,
    )


def _torque(example: Example) -> Erratum:
    places, masses, gravity = example.elements, example.masses, example.gravity
    middle = example.wheels.mean(axis=0)
    arm = masses @ places / masses.sum() - middle
    weights = masses[:, None] * gravity
    checks = (
        check(
            "torque of gravity on the point masses about the polygon's centre",
            0.0,
            np.linalg.norm(np.cross(arm, masses.sum() * gravity)),
            np.linalg.norm(np.cross(places - middle, weights).sum(axis=0)),
        ),
    )
    return Erratum(
        "text before Eq 18",
        "torque calculated to the centre of the polygon is zero",
        "about the centre of MASS",
        "Eq 18 is M_S with S the centre of mass.  About the polygon's centre it is zero only if "
        "gravity's ray goes through it.",
        checks,
    )


def _equal_loads(example: Example) -> Erratum:
    wheels = example.wheels
    middle = wheels.mean(axis=0)
    forces = normal_forces(wheels, middle)
    rough = heuristic_forces(wheels, middle)
    return Erratum(
        "text before Eq 20",
        "|SD_g| = 0 results in a normal distribution of the mass on the wheels",
        "equal loads N/3 on three wheels",
        "Nothing is Gaussian here.  The paper's own Eq 12, its minus dropped, gives unequal "
        "loads for it unless the triangle is equilateral.",
        tuple(
            check(f"force on wheel {i + 1}, share of |N_g|, D_g = S", rough[i], forces[i], 1 / 3)
            for i in range(3)
        ),
    )


def _indeterminate(example: Example) -> Erratum:
    contacts = four_contacts(example.wheels)
    arms = contacts - contacts[0]
    resultant = np.full(4, 0.25) @ contacts
    checks = (
        check(
            "distance from S of the resultant of four equal loads",
            0.0,
            np.linalg.norm(resultant - polygon_centre(contacts)),
            np.linalg.norm(resultant - contour_centroid(contacts)),
        ),
        check(
            "loads of four wheels that balance does not determine",
            0.0,
            len(contacts) - 3.0,
            len(contacts) - np.linalg.matrix_rank(np.vstack([np.ones(4), arms.T])),
        ),
    )
    return Erratum(
        "text before Eq 20, four wheels and more",
        "|SD_g| = 0 results in a normal distribution of the mass on each of the wheels",
        "for n_a > 3 force and moment balance leave n_a - 3 loads open",
        "Equal loads are not even among the solutions unless S is the average of the contacts.",
        checks,
    )


def _stability(example: Example) -> Erratum:
    wheels = example.wheels
    checks = (
        check(
            "largest possible distance of D_g from the nearest edge",
            edge_distance(wheels, wheels.mean(axis=0)),
            edge_distance(wheels, incentre(wheels)),
            largest_inscribed_radius(wheels),
        ),
    )
    return Erratum(
        "text before Eq 21",
        "r_SDg = 0, so the stability of the robot is maximal",
        "|SD_g| = 0 is equal load; the distance to the nearest edge is largest at the incentre",
        "Centroid and incentre coincide in equilateral triangles only.",
        checks,
    )


def _objective(example: Example) -> Erratum:
    angles = NOMINAL + np.radians(np.arange(-30.0, 16.0, 5.0))
    alpha, gamma = (grid.ravel() for grid in np.meshgrid(angles, angles))
    shapes = tripods(alpha, gamma)
    factor = stability(shapes, DOWN[None], ("sdg",))["sdg"][:, 0]
    furthest, nearest = (shapes[i] for i in (factor.argmax(), factor.argmin()))
    foot = printed.eq8_to_11(printed.normal_of(example.wheels), example.wheels[0])
    low, high = example.wheels, example.wheels + foot
    angle = stability(np.stack([high, low]), foot[None], ("tip_angle",))["tip_angle"][:, 0]
    checks = (
        check("|SD_g| of the chosen shape of simulation 2", factor.max(), factor.min(), 0.0),
        check(
            "share of the most loaded wheel in that shape",
            normal_forces(furthest, pierced_point(furthest, DOWN)).max(),
            normal_forces(nearest, pierced_point(nearest, DOWN)).max(),
            1 / 3,
        ),
        check(
            "tip angle (rad) over the foot of the com, at twice the height and at the height",
            angle[0],
            angle[1],
            np.arctan(edge_distance(low, foot) / np.linalg.norm(foot)),
        ),
    )
    return Erratum(
        "block diagram, Figure 6",
        "max |SD_g|, |OC| are the optimization requirements for the stability",
        "min |SD_g|, and a small |OC|",
        "The text minimises |SD_g| everywhere else, and a lower com tips later.",
        checks,
    )

"""Checks of Eqs 12 to 21: normal forces, static moments, and what a small |SD_g| means."""

import numpy as np

from lutgen.analysis import heuristic_forces, normal_forces
from lutgen.channels import stability
from lutgen.paper import printed, reference
from lutgen.paper.erratum import Checks, Example, check
from lutgen.paper.forces import exact_forces, pierced_point, slope_gravity
from lutgen.paper.nominal import CIRCUMRADIUS, DOWN, NOMINAL, Array, nominal_wheels, tripods


def line_distances(wheels: Array, gravity: Array) -> Array:
    """Return L, (n,), as the text before Eq 1 has it: from gravity's line, projected to XY."""
    down = gravity / np.linalg.norm(gravity)
    arms = wheels - np.outer(wheels @ down, down)
    return np.asarray(np.linalg.norm(arms[:, :2], axis=1))


def point_distances(wheels: Array, gravity: Array) -> Array:
    """Return L, (n,), as the text before Eq 12 has it: from D_g."""
    return np.asarray(np.linalg.norm(wheels - pierced_point(wheels, gravity), axis=1))


def two_ratios(example: Example) -> Checks:
    """Compare the distances L from gravity's line, from D_g, and with D_g by solving."""
    wheels, gravity = example.wheels, example.gravity
    b = np.linalg.solve(wheels.T, gravity)
    from_line, from_point = line_distances(wheels, gravity), point_distances(wheels, gravity)
    truth = np.linalg.norm(wheels - wheels.T @ b / b.sum(), axis=1)
    for i in range(3):
        yield check(f"$L$ of wheel {i + 1}", from_line[i], from_point[i], truth[i])


def sign_of_eq_12(_: Example) -> Checks:
    """Compare forces with the leading minus, without it, and what they must add up to."""
    wheels = nominal_wheels()
    pierced = pierced_point(wheels, DOWN)
    form, ours = printed.eq12(point_distances(wheels, DOWN)), heuristic_forces(wheels, pierced)
    claim = "force on wheel 1 of the nominal robot, share of $|N_g|$"
    yield check(claim, form[0], ours[0], normal_forces(wheels, pierced)[0])
    off = np.array([1.0, 2.0, 0.0])
    for n in (3, 4, 5, 6):
        angle = np.arange(n) ** 1.1
        points = CIRCUMRADIUS * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(n)])
        form = printed.eq12(np.linalg.norm(points - off, axis=1))
        claim = f"sum of the forces on {n} contacts, share of $|N_g|$"
        yield check(claim, form.sum(), heuristic_forces(points, off).sum(), 1.0)


def moments_of_eq_12(example: Example) -> Checks:
    """Compare the force on wheel 1 by Eq 12, by the matrix of contacts, and by the library."""
    cases = [("the example robot", example.wheels, example.gravity)]
    for way, pitch, heading in (("uphill", 30.0, 0.0), ("downhill", 58.0, np.pi)):
        words = f"the nominal robot, wheel 1 {way} on a slope of {pitch:g}°"
        cases.append((words, nominal_wheels(), slope_gravity(np.radians(pitch), heading)))
    for words, wheels, gravity in cases:
        pierced = pierced_point(wheels, gravity)
        yield check(
            f"force on wheel 1 of {words}, share of $|N_g|$, minus dropped",
            heuristic_forces(wheels, pierced)[0],
            exact_forces(wheels, gravity)[0],
            normal_forces(wheels, pierced)[0],
        )


def static_moment(example: Example) -> Checks:
    """Compare S_MS with r, with r_s, and summed over the point masses."""
    places, masses = example.elements, example.masses
    total, about_origin = float(masses.sum()), masses @ places
    centre = about_origin / total
    form = np.linalg.norm(printed.eq16(about_origin, total, places[0]))
    truth = np.linalg.norm(sum(m * (p - centre) for m, p in zip(masses, places, strict=True)))
    claim = "$|S_MS|$ of the point masses, $r$ being the place of the first"
    yield check(claim, form, np.linalg.norm(about_origin - total * centre), truth)


def torque_about_polygon(example: Example) -> Checks:
    """Compare the torque about the polygon's centre: none, that of the sum, the sum of those."""
    places, masses, gravity = example.elements, example.masses, example.gravity
    middle = example.wheels.mean(axis=0)
    arm = masses @ places / masses.sum() - middle
    ours = np.linalg.norm(np.cross(arm, masses.sum() * gravity))
    truth = np.linalg.norm(np.cross(places - middle, masses[:, None] * gravity).sum(axis=0))
    yield check("torque of gravity on the point masses about the polygon's centre", 0, ours, truth)


def equal_loads(example: Example) -> Checks:
    """Compare the forces for |SD_g| = 0 by Eq 12 and by balance."""
    wheels = example.wheels
    middle = wheels.mean(axis=0)
    rough, forces = heuristic_forces(wheels, middle), normal_forces(wheels, middle)
    for i in range(3):
        claim = f"force on wheel {i + 1}, share of $|N_g|$, $D_g = S$"
        yield check(claim, rough[i], forces[i], 1 / 3)


def open_loads(example: Example) -> Checks:
    """Compare four wheels: where equal loads act, and how many loads balance leaves open."""
    contacts = reference.four_contacts(example.wheels)
    resultant = np.full(4, 0.25) @ contacts
    ours = np.linalg.norm(resultant - reference.polygon_centre(contacts))
    truth = np.linalg.norm(resultant - reference.contour_centroid(contacts))
    yield check("distance from $S$ of the resultant of four equal loads", 0, ours, truth)
    arms = contacts - contacts[0]
    left = len(contacts) - np.linalg.matrix_rank(np.vstack([np.ones(4), arms.T]))
    yield check("loads of four wheels that balance does not determine", 0, len(contacts) - 3, left)


def incentre_distance(example: Example) -> Checks:
    """Compare the largest distance from all edges: at S, at the incentre, area over perimeter."""
    wheels = example.wheels
    at_centre, at_incentre = (
        reference.edge_distance(wheels, point)
        for point in (wheels.mean(axis=0), reference.incentre(wheels))
    )
    claim = "largest possible distance of $D_g$ from the nearest edge"
    yield check(claim, at_centre, at_incentre, reference.largest_inscribed_radius(wheels))


def objective(example: Example) -> Checks:
    """Compare what the largest and the smallest |SD_g| mean, and what height does."""
    angles = NOMINAL + np.radians(np.arange(-30.0, 16.0, 5.0))
    shapes = tripods(*(grid.ravel() for grid in np.meshgrid(angles, angles)))
    factor = stability(shapes, DOWN[None], ("sdg",))["sdg"][:, 0]
    claim = "$|SD_g|$ of the chosen shape of simulation 2"
    yield check(claim, factor.max(), factor.min(), 0.0)
    furthest, nearest = (
        normal_forces(shape, pierced_point(shape, DOWN)).max()
        for shape in (shapes[factor.argmax()], shapes[factor.argmin()])
    )
    yield check("share of the most loaded wheel in that shape", furthest, nearest, 1 / 3)
    foot = printed.eq8_to_11(printed.normal_of(example.wheels), example.wheels[0])
    low, high = example.wheels, example.wheels + foot
    angle = stability(np.stack([high, low]), foot[None], ("tip_angle",))["tip_angle"][:, 0]
    truth = np.arctan(reference.edge_distance(low, foot) / np.linalg.norm(foot))
    claim = "tip angle (rad) over the foot of the com, at twice the height and at the height"
    yield check(claim, angle[0], angle[1], truth)

"""Checks of Eqs 22 to 29: the centre of the support polygon and the stability factor."""

import numpy as np

from lutgen.paper import printed, reference
from lutgen.paper.erratum import AXES, Checks, Example, check, coordinates
from lutgen.paper.forces import pierced_point
from lutgen.paper.nominal import Array, nominal_wheels
from lutgen.paper.published import TIPS_AT

# Weights of a fifth contact on the three wheels, outside all edges, and the share by which it is
# pulled from the plane towards the com.
FIFTH = np.array([0.4, 1.0, -0.4])
LIFT = 0.9


def eq27_corrected(normal: Array, contact: Array, sx: float, sy: float) -> float:
    """Return s_z = (n . P1 - a s_x - b s_y) / c."""
    a, b, c = normal
    return float((normal @ contact - a * sx - b * sy) / c)


def vertex_mean(example: Example) -> Checks:
    """Compare the centre of four contacts: mean of the corners, of the area, by Green's theorem."""
    contacts = reference.four_contacts(example.wheels)
    mean, ours, truth = (
        contacts.mean(axis=0),
        reference.polygon_centre(contacts),
        reference.contour_centroid(contacts),
    )
    yield from coordinates("the centre of four contacts", mean, ours, truth)


def projected_area(example: Example) -> Checks:
    """Compare the area of Eq 24, the area in space times c, and a determinant."""
    wheels = example.wheels
    across = np.cross(wheels[1] - wheels[0], wheels[2] - wheels[0])
    ours = np.linalg.norm(across) / 2.0 * printed.normal_of(wheels)[2]
    truth = abs(np.linalg.det(wheels[1:, :2] - wheels[0, :2])) / 2.0
    claim = "$T$ of the wheels' triangle; ours: its area in space times $c$"
    yield check(claim, printed.eq24(wheels), ours, truth)


def fan_of_triangles(example: Example) -> Checks:
    """Compare the centre by a fan in any order, of the ordered polygon, by Green's theorem."""
    contacts = reference.four_contacts(example.wheels)
    fifth = LIFT * (FIFTH @ example.wheels)
    around = np.vstack([contacts[[0, 1]], contacts[[3, 2]]])
    # The polygon's order with the fifth between the first and the second contact.
    hovering = printed.eq25_26(np.vstack([around[:1], fifth, around[1:]]))
    unordered = printed.eq25_26(contacts)
    ours, truth = reference.polygon_centre(contacts), reference.contour_centroid(contacts)
    for i in (0, 1):
        claim = f"${AXES[i]}$ of the centre of four contacts"
        yield check(f"{claim}, in the order of their numbers", unordered[i], ours[i], truth[i])
        yield check(f"{claim}, with a fifth that hovers", hovering[i], ours[i], truth[i])


def vertical_plane(example: Example) -> Checks:
    """Compare the centre in a vertical plane: projected, in space, and the mean of the corners."""
    # With coordinates of few bits the projected area is 0 and not rounding noise.
    wheels = np.round(example.wheels[:, [2, 0, 1]] * 1024.0) / 1024.0
    wheels[:, 0] = wheels[0, 0]
    sx, sy = printed.eq25_26(wheels)
    form = np.array([sx, sy, printed.eq27(printed.normal_of(wheels), wheels[0], sx, sy)])
    ours, truth = reference.polygon_centre(wheels), wheels.mean(axis=0)
    yield from coordinates("the centre in a vertical plane", form, ours, truth)


def height_of_eq_27(example: Example) -> Checks:
    """Compare s_z for three normals: Eq 27, corrected, and the mean of the corners."""
    wheels = example.wheels
    sx, sy = printed.eq25_26(wheels)
    unit, truth = printed.normal_of(wheels), wheels[:, 2].mean()
    for words, normal in (
        ("unit normal", unit),
        ("normal of length 3.7", 3.7 * unit),
        ("unit normal of the other sign", -unit),
    ):
        form = printed.eq27(normal, wheels[0], sx, sy)
        ours = eq27_corrected(normal, wheels[0], sx, sy)
        claim = f"$s_z$ of the wheels' triangle, {words}; reference: mean of the corners"
        yield check(claim, form, ours, truth)


def stability_factor_of_eq_29(example: Example) -> Checks:
    """Compare |SD_g| of Eq 29, of the library, and with D_g by solving."""
    wheels, gravity = example.wheels, example.gravity
    form = printed.eq29(pierced_point(wheels, gravity), reference.polygon_centre(wheels))
    truth = np.linalg.norm(reference.pierced_by_solving(wheels, gravity) - wheels.mean(axis=0))
    claim = "$|SD_g|$ with $s_z$ of the corrected Eq 27"
    yield check(claim, form, reference.stability_factor(wheels, gravity), truth)


def limit_of_10(_: Example) -> Checks:
    """Compare where |SD_g| tips: the printed 10, from the triangle, and by tilting."""
    wheels = nominal_wheels()
    radius = float(np.hypot(*wheels[0, :2]))
    over_wheel, over_edge = (
        reference.factor_at_tipping(wheels, 0.0),
        reference.factor_at_tipping(2.0 * wheels, np.pi),
    )
    claim = "$|SD_g|$ at which {}".format
    yield check(claim("the nominal robot tips over a wheel"), TIPS_AT, radius, over_wheel)
    twice = 2.0 * radius * np.cos(np.pi / 3)
    yield check(claim("a robot of twice the size tips over an edge"), TIPS_AT, twice, over_edge)

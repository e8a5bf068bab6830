"""A recipe as the page knows it: links, contacts, parameters, limits, and shapes to draw.

Owns the names and units of that; radians and the recipe's length unit throughout.
"""

import math
from typing import Any

import numpy as np

from lutgen.channels import acceptance_of
from lutgen.parts import Link, parents_first
from lutgen.recipe import Recipe, robot_size_of
from lutgen.rotation import rotation
from lutgen.support import RELATIVE_TOLERANCE
from lutgen.urdf import parse_urdf, used_shapes

# In a URDF; meshes are not read.
DRAWN = ("box", "cylinder", "sphere")
# The most tilt of the page's disc where the recipe's chart has every direction.
WHOLE = math.pi
SIGNS = {"deg": "°", "1": "", "rad": " rad"}
# Angles beyond which nothing is asked, and what the definition adds to its own.
NO_LIMIT, SAME_ANGLE = 4.0, 1e-12


def scene_of(recipe: Recipe) -> dict[str, Any]:
    """Return what the page is told of a robot, ready for JSON."""
    by_name = {link.name: link for link in recipe.links}
    order, _ = parents_first({link.name: link.parent for link in recipe.links})
    place = {name: at for at, name in enumerate(order)}
    column = {parameter.name: at for at, parameter in enumerate(recipe.parameters)}
    shapes = _shapes(recipe)
    return {
        "name": recipe.name,
        "unit": recipe.length_unit,
        "digest": recipe.digest,
        "friction": recipe.friction,
        "size": robot_size_of(recipe),
        "numbers": _numbers(recipe),
        "rim": WHOLE if recipe.chart.kind == "sphere" else max(recipe.chart.max_tilt, 0.2),
        "parameters": [
            {
                "name": parameter.name,
                "min": parameter.minimum,
                "max": parameter.maximum,
                "home": home,
                "unit": float(parameter.stored(1.0)),
                "sign": SIGNS.get(parameter.display_unit, f" {parameter.display_unit}"),
            }
            for parameter, home in zip(recipe.parameters, recipe.home_params, strict=True)
        ],
        "links": [
            _link(by_name[name], place, column, sum(map(_mass, recipe.links)) == 0.0)
            | {"shapes": shapes.get(name, [])}
            for name in order
        ],
        "contacts": [
            {
                "name": contact.name,
                "link": place[contact.link],
                "position": list(contact.position),
                "radius": contact.radius,
                "axis": None if contact.axis is None else list(contact.axis),
            }
            for contact in recipe.contacts
        ],
    }


def _mass(link: Link) -> float:
    return link.mass


def _link(
    link: Link, place: dict[str, int], column: dict[str, int], massless: bool
) -> dict[str, Any]:
    """Return a link; the root of a robot without masses has them all, at its origin."""
    joint = link.joint
    return {
        "name": link.name,
        "parent": -1 if link.parent is None else place[link.parent],
        "origin": list(link.origin),
        "turn": rotation(link.rpy).ravel().tolist(),
        "mass": 1.0 if massless and link.parent is None else link.mass,
        "com": list(link.com),
        "joint": None
        if joint is None
        else {
            "kind": joint.kind,
            "axis": list(joint.axis),
            "parameter": column[joint.parameter],
            "scale": joint.scale,
            "offset": joint.offset,
        },
    }


def _numbers(recipe: Recipe) -> list[float]:
    """Return the limits in the order of engine/exact.c, as the definition widens them."""
    accept, size = acceptance_of(recipe), robot_size_of(recipe)
    hair = RELATIVE_TOLERANCE * size
    return [
        size,
        accept.steepest,
        max(accept.least_height, hair),
        accept.rest_width,
        max(accept.contact_tolerance, hair),
        min(accept.rock_angle, NO_LIMIT) + SAME_ANGLE,
        max(0.5 * accept.rest_width, hair),
    ]


def _shapes(recipe: Recipe) -> dict[str, list[dict[str, Any]]]:
    """Return the boxes, cylinders and balls of a description by link."""
    if recipe.urdf is None:
        return {}
    return {
        link.name: [
            {
                "kind": shape.kind,
                "size": np.asarray(shape.size, dtype=np.float64).ravel().tolist(),
                "at": list(shape.origin),
                "turn": rotation(shape.rpy).ravel().tolist(),
            }
            for shape in used_shapes(link)
            if shape.kind in DRAWN
        ]
        for link in parse_urdf(recipe.urdf, recipe.source).links
    }

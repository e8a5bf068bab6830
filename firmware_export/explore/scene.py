"""A recipe as the page knows it: links, contacts, parameters, and shapes to draw.

Owns the names and units of that; radians and the recipe's length unit throughout.
"""

import math
from typing import Any

from lutgen.parts import Link, parents_first
from lutgen.recipe import Recipe, robot_size_of
from lutgen.urdf import parse_urdf, used_shapes

# In a URDF; meshes are not read.
DRAWN = ("box", "cylinder", "sphere")
# The most tilt of the page's disc where the recipe's chart has every direction.
WHOLE = math.pi
SIGNS = {"deg": "°", "1": "", "rad": " rad"}


def scene_of(recipe: Recipe) -> dict[str, Any]:
    """Return what the page is told of a robot, ready for JSON."""
    by_name = {link.name: link for link in recipe.links}
    order, _ = parents_first({link.name: link.parent for link in recipe.links})
    place = {name: at for at, name in enumerate(order)}
    column = {parameter.name: at for at, parameter in enumerate(recipe.parameters)}
    shapes = _shapes(recipe)
    # A robot without masses has them all at the origin of its root.
    massless = not any(link.mass for link in recipe.links)
    return {
        "name": recipe.name,
        "unit": recipe.length_unit,
        "friction": recipe.friction,
        "size": robot_size_of(recipe),
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
            {
                "parent": -1 if link.parent is None else place[link.parent],
                "origin": list(link.origin),
                "rpy": list(link.rpy),
                "mass": 1.0 if massless and link.parent is None else link.mass,
                "com": list(link.com),
                "joint": _joint(link, column),
                "shapes": shapes.get(link.name, []),
            }
            for link in (by_name[name] for name in order)
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


def _joint(link: Link, column: dict[str, int]) -> dict[str, Any] | None:
    """Return how a link moves, if it does."""
    joint = link.joint
    if joint is None:
        return None
    return {
        "kind": joint.kind,
        "axis": list(joint.axis),
        "parameter": column[joint.parameter],
        "scale": joint.scale,
        "offset": joint.offset,
    }


def _shapes(recipe: Recipe) -> dict[str, list[dict[str, Any]]]:
    """Return the boxes, cylinders and balls of a description by link."""
    if recipe.urdf is None:
        return {}
    return {
        link.name: [
            {
                "kind": shape.kind,
                "size": [float(x) for x in shape.size],
                "at": list(shape.origin),
                "rpy": list(shape.rpy),
            }
            for shape in used_shapes(link)
            if shape.kind in DRAWN
        ]
        for link in parse_urdf(recipe.urdf, recipe.source).links
    }

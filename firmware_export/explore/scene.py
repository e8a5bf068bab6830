"""A recipe as the page knows it: links, contacts, parameters, and shapes to draw.

Angles are in radians and lengths in the recipe's unit; parameters keep their own units.
"""

import math
from dataclasses import asdict
from typing import Any

from lutgen.recipe import Recipe, robot_size_of
from lutgen.urdf.links import used_shapes
from lutgen.urdf.read import parse_urdf

# In a URDF; meshes are not read.
DRAWN = ("box", "cylinder", "sphere")
# The most tilt of the page's disc where the recipe's chart has every direction.
WHOLE = math.pi
SIGNS = {"deg": "°", "1": ""}


def scene_of(recipe: Recipe) -> dict[str, Any]:
    """Return the page's data of a robot, ready for JSON."""
    shapes = _shapes(recipe)
    parameters = []
    for parameter, home in zip(recipe.parameters, recipe.home_params, strict=True):
        unit = {"unit": float(parameter.stored(1.0)), "sign": _sign(parameter.display_unit)}
        numbers = {"min": parameter.minimum, "max": parameter.maximum, "home": home}
        shown = {name: float(f"{parameter.shown(number):.12g}") for name, number in numbers.items()}
        parameters.append({"name": parameter.name} | unit | shown)
    return {
        "unit": _sign(recipe.length_unit),
        "friction": recipe.friction,
        "size": robot_size_of(recipe),
        "rim": WHOLE if recipe.chart.kind == "sphere" else max(recipe.chart.max_tilt, 0.2),
        "parameters": parameters,
        "links": [asdict(link) | {"shapes": shapes.get(link.name, [])} for link in recipe.links],
        "contacts": [asdict(contact) for contact in recipe.contacts],
    }


def _sign(unit: str) -> str:
    """Return what stands behind a number."""
    return SIGNS.get(unit, f" {unit}")


def _shapes(recipe: Recipe) -> dict[str, list[dict[str, Any]]]:
    """Return the boxes, cylinders and balls of a description by link."""
    if recipe.urdf is None:
        return {}
    return {
        link.name: [asdict(shape) for shape in used_shapes(link) if shape.kind in DRAWN]
        for link in parse_urdf(recipe.urdf, recipe.source).links
    }

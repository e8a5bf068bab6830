"""The file of `lutgen stance`: feet on uneven ground, and the weight on them."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from lutgen.analysis.uneven import Footing
from lutgen.recipe import read_tables, read_text
from lutgen.recipe.load import NOTHING, Fault, refuse
from lutgen.recipe.model import unit
from lutgen.recipe.schema import Direction, LengthUnit, NotNegative, Place, Table, Text, key

DOWN = [0.0, 0.0, -1.0]


class Foot(Table):
    """A point contact on ground of its own slope."""

    name: Text | None = key("A name of its own.", "left", None)
    position: Place = key("Where it touches the ground.", [0.2, 0.1, 0])
    normal: Direction | None = key("Of the ground, upwards; else against gravity.", [0, 0, 1], None)
    friction: NotNegative | None = key("Its coefficient, if not that of all.", 0.5, None)


class Feet(Table):
    """What a file of `lutgen stance` holds."""

    title: Text | None = key("What figures call it, if not the file's name.", "stair", None)
    length_unit: LengthUnit = key("The unit of all lengths.", "m", "m")
    com: Place = key("The centre of mass.", [0, 0, 0.5])
    gravity: Direction = key("Gravity, pointing down.", [0, 0, -1], DOWN)
    friction: NotNegative | None = key("Coefficient of all feet that have none.", 0.5, None)
    foot: list[Foot] = key("At least one.", [], [])


def read_footing(path: str) -> Footing:
    """Read the feet and the centre of mass; a file with any fault raises RecipeError."""
    feet = read_tables(read_text(path), path, Feet)
    refuse(path, _faults(feet))
    down = unit(feet.gravity)
    # Zero has no sign, not even turned round.
    up = [0.0 - part for part in down]
    return Footing(
        feet.title or Path(path).stem,
        feet.length_unit,
        tuple(_names(feet)),
        points=np.array([foot.position for foot in feet.foot]),
        normals=np.array([unit(foot.normal) if foot.normal else up for foot in feet.foot]),
        friction=np.array([_friction(feet, foot) for foot in feet.foot]),
        com=np.array(feet.com),
        gravity_dir=np.array(down),
    )


def _names(feet: Feet) -> list[str]:
    return [foot.name or f"P{place}" for place, foot in enumerate(feet.foot, 1)]


def _friction(feet: Feet, foot: Foot) -> float | None:
    return feet.friction if foot.friction is None else foot.friction


def _faults(feet: Feet) -> Iterator[Fault]:
    if not feet.foot:
        yield Fault("foot", "is missing", NOTHING, "add a [[foot]] for each contact")
    if any(_friction(feet, foot) is None for foot in feet.foot):
        yield Fault("friction", "is missing", NOTHING, "write for example friction = 0.5")
    names = _names(feet)
    for place, name in enumerate(names, 1):
        # The name that it would have may be taken.
        if name in names[: place - 1]:
            yield Fault(f"foot[{place}].name", "is given twice", name, "choose another name")

"""Contact primitives from the collision shapes of a robot description.

A sphere is a sphere, a cylinder its two rim discs, a capsule the spheres at its ends, a box its
eight corners; a mesh is what was recognised in it.  Which links touch the ground is not known here.
"""

import itertools
from collections.abc import Iterator

import numpy as np

from lutgen.parts import Contact
from lutgen.rotation import rotation
from lutgen.urdf.description import Collision, UrdfLink
from lutgen.urdf.links import as_vector
from lutgen.vector import Vector

# Shapes that are taken for feet and wheels; points are what a mesh that was opened has at its foot.
TOUCHING = ("sphere", "cylinder", "capsule", "points")


def used_shapes(link: UrdfLink) -> list[Collision]:
    """Return the collision shapes that touch the ground: all but boxes, or else the boxes.

    A box between the wheels of a track is no further out than they are, where it meets the ground.
    """
    shapes = [shape for shape in link.collisions if shape.kind in TOUCHING]
    return shapes or [shape for shape in link.collisions if shape.kind == "box"]


def link_contacts(link: UrdfLink, name: str | None = None) -> list[Contact]:
    """Return the contacts of a link's collision shapes, in its frame (m), in order of the file.

    They have the given name, the link's by default; where there are several, the number of the
    shape and that of the disc, corner or point follow it.
    """
    shapes, name = used_shapes(link), name or link.name
    result = []
    for i, shape in enumerate(shapes, 1):
        first = name if len(shapes) == 1 else f"{name}_{i}"
        parts = list(_primitives(shape))
        for k, (position, radius, axis) in enumerate(parts, 1):
            full = first if len(parts) == 1 else f"{first}_{k}"
            result.append(Contact(full, link.name, position, radius, axis))
    return result


def _primitives(shape: Collision) -> Iterator[tuple[Vector, float, Vector | None]]:
    """Yield position, radius and axis; a radius of 0 makes a point."""
    turn, centre = rotation(shape.rpy), np.array(shape.origin)
    if shape.kind == "sphere":
        yield shape.origin, shape.size[0], None
    elif shape.kind in ("cylinder", "capsule"):
        radius, length = shape.size
        flat = shape.kind == "cylinder" and radius > 0.0
        for end in (0.5, -0.5):
            axis = as_vector(turn[:, 2]) if flat else None
            yield as_vector(centre + end * length * turn[:, 2]), radius, axis
    elif shape.kind == "points":
        for point in np.array(shape.size).reshape(-1, 3):
            yield as_vector(point), 0.0, None
    else:
        for corner in itertools.product((0.5, -0.5), repeat=3):
            yield as_vector(centre + turn @ (np.array(corner) * shape.size)), 0.0, None

"""The meshes of a robot description: found, read once within bounds, and placed in their links.

STL, OBJ and Collada, files alone and nothing that they name.  Only the convex hull of a mesh is
kept: level ground and any slope touch nothing else.
"""

import io
import math
import warnings
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from lutgen import bounds
from lutgen.arrays import Floats
from lutgen.errors import InputError, optional
from lutgen.urdf.description import Collision
from lutgen.urdf.sources import Sources, quoted
from lutgen.urdf.xml import LARGEST
from lutgen.vector import rotation

# Collada instantiates nodes of nodes: what a short file may become.
MAX_NODES, MAX_CORNERS = 10_000, 4_000_000
FORMATS = (".stl", ".obj", ".dae")
# Decimals of a metre: a guess is no better, and the same mesh in single precision or in text gives
# the same numbers.
DIGITS = 6


class Meshes:
    """The meshes that a description names; each file is read once."""

    def __init__(self, sources: Sources, known: Mapping[str, Floats] | None = None) -> None:
        self.sources = sources
        # Corners that are there without a file, by the name that shapes give.
        self._hulls: dict[str, Floats | InputError] = {
            name: _hull(corners) for name, corners in (known or {}).items()
        }

    def corners(self, shape: Collision) -> Floats:
        """Return the corners (n, 3) of a mesh's convex hull in the frame of its link, m, sorted.

        InputError is raised where the file is not found or not read, and says why.
        """
        if not shape.file:
            raise InputError("a mesh names no file")
        scale = np.array(shape.scale)
        if len(scale) != 3 or not np.all(np.isfinite(scale) & (scale != 0.0)):
            raise InputError(f"{shape.file}: has no scale of three numbers but 0")
        if np.abs(scale).max() > LARGEST:
            raise InputError(f"{shape.file}: has a scale beyond {LARGEST:g}")
        if shape.file not in self._hulls:
            path = self.sources.file(shape.file)
            try:
                self._hulls[shape.file] = _hull(_corners(path))
            except InputError as error:
                self._hulls[shape.file] = InputError(f"{shape.file}: {error}")
        found = self._hulls[shape.file]
        if isinstance(found, InputError):
            raise found
        placed = (found * scale) @ rotation(shape.rpy).T + shape.origin
        # To a micrometre, so that they have the same order in every format's precision.
        return np.unique(np.round(placed, DIGITS) + 0.0, axis=0)


def _hull(corners: Floats) -> Floats:
    distinct = np.unique(corners, axis=0)
    size = float(np.ptp(distinct, axis=0).max())
    if not math.isfinite(size) or size > LARGEST:
        raise InputError(f"is larger than {LARGEST:g} m")
    try:
        return np.asarray(distinct[np.sort(ConvexHull(distinct).vertices)])
    except QhullError:
        return distinct


def _corners(path: Path) -> Floats:
    """Return the corners (n, 3) in a file, m; of Collada with its axes as they are, as in ROS."""
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"{path.suffix or 'no ending'} is none of {', '.join(FORMATS)}")
    raw, kind = bounds.read(str(path), bounds.MESH_BYTES, InputError), path.suffix.lower()[1:]
    # An archive, also behind other bytes, unpacks to any size, and XML may define entities.
    if kind == "dae" and (zipfile.is_zipfile(io.BytesIO(raw)) or b"<!DOCTYPE" in raw):
        raise InputError("is an archive or has a document type declaration")
    otherwise = "give the contacts with --contact"
    collada, trimesh = (
        optional("its reader", name, "lutgen[meshes]", otherwise) for name in ("collada", "trimesh")
    )
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            if kind == "dae":
                document = collada.Collada(io.BytesIO(raw), ignore=[collada.common.DaeError])
                corners = _instances(document.scene.nodes, collada.scene.GeometryNode)
                corners *= float(document.assetInfo.unitmeter or 1.0)
            else:
                if kind == "obj":
                    # Materials and groups take time without end, and shape nothing.
                    lines = (line for line in raw.splitlines() if line.lstrip()[:1] in b"vf")
                    raw = b"\n".join(lines)
                # Nothing is merged or mended, and without a resolver nothing else is opened.
                scene = trimesh.load_scene(io.BytesIO(raw), file_type=kind, process=False)
                parts = [geometry.vertices for geometry in scene.geometry.values()]
                corners = np.concatenate([np.zeros((0, 3)), *parts]).astype(np.float64)
    except InputError:
        raise
    except Exception as error:
        # Broken files fail in any way that Python can.
        raise InputError(f"cannot be read as {kind.upper()}: {quoted(error)}") from None
    if len(corners) < 3:
        raise InputError("has no triangle")
    if not np.isfinite(corners).all():
        raise InputError("has a corner that is no number")
    return corners


def _instances(nodes: Sequence[Any], leaf: Any) -> Floats:
    """Return the corners (n, 3) of all geometries below the nodes of a Collada scene."""
    open_: list[tuple[Any, Floats]] = [(node, np.eye(4)) for node in nodes]
    parts = [np.zeros((0, 3))]
    count = total = 0
    while open_:
        node, place = open_.pop()
        count += 1
        if isinstance(node, leaf):
            for one in node.geometry.primitives:
                points = one.vertex[np.unique(one.vertex_index)].astype(np.float64)
                parts.append(points @ place[:3, :3].T + place[:3, 3])
                total += len(points)
        elif hasattr(node, "children"):
            open_ += [(child, place @ node.matrix) for child in node.children]
        if count + len(open_) > MAX_NODES or total > MAX_CORNERS:
            raise InputError(f"instantiates more than {MAX_NODES} nodes, or {MAX_CORNERS} corners")
    return np.concatenate(parts)

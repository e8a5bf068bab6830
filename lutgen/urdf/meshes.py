"""The meshes of a robot description: found, read once, and placed in their links.

Owns the way from a mesh's name to its file.  Of a mesh only its convex hull is kept: level ground
and any slope touch nothing else.
"""

import math
from pathlib import Path
from urllib.parse import unquote

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from lutgen.errors import InputError
from lutgen.rotation import rotation
from lutgen.urdf.description import Collision
from lutgen.urdf.mesh_file import load_corners
from lutgen.urdf.packages import Packages
from lutgen.urdf.reach import DIGITS
from lutgen.urdf.read import LARGEST
from lutgen.vector import Floats


class Meshes:
    """The meshes that a description names, by the folders of packages; each file is read once."""

    def __init__(self, packages: Packages) -> None:
        self.packages = packages
        self._hulls: dict[Path, Floats | InputError] = {}

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
        path = self._path(shape.file)
        if path not in self._hulls:
            try:
                self._hulls[path] = _hull(load_corners(path))
            except InputError as error:
                self._hulls[path] = InputError(f"{shape.file}: {error}")
        found = self._hulls[path]
        if isinstance(found, InputError):
            raise found
        placed = (found * scale) @ rotation(shape.rpy).T + shape.origin
        # To a micrometre, so that they have the same order whatever the format's precision is.
        return np.unique(np.round(placed, DIGITS) + 0.0, axis=0)

    def _path(self, name: str) -> Path:
        """Return the file that a description names; InputError where its package is not found."""
        kind, mark, rest = name.partition("://")
        if not mark:
            return self.packages.start / name
        if kind == "file":
            return Path(unquote(rest))
        if kind != "package":
            raise InputError(f"{name}: is neither a path nor file:// nor package://")
        package, _, inside = rest.partition("/")
        folder = self.packages.find(package)
        if folder is None:
            raise InputError(f"package {package!r} was not found; give --package {package}=DIR")
        return folder / inside


def _hull(corners: Floats) -> Floats:
    """Return the corners of a convex hull; of what is flat all."""
    distinct = np.unique(corners, axis=0)
    size = float(np.ptp(distinct, axis=0).max())
    if not math.isfinite(size) or size > LARGEST:
        raise InputError(f"is larger than {LARGEST:g} m")
    try:
        return np.asarray(distinct[np.sort(ConvexHull(distinct).vertices)])
    except QhullError:
        return distinct

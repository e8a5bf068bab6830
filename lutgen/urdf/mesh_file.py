"""Read the corners of a mesh from a file, through an optional package.

Owns which formats and how much of them: STL, OBJ and Collada, files alone and nothing that they
name.  What a mesh is for is not known here.
"""

import io
import warnings
from pathlib import Path

import numpy as np

from lutgen import bounds
from lutgen.errors import InputError
from lutgen.vector import Floats

# Larger files are not read: they have more than a million triangles, and no foot needs that.
MAX_BYTES = bounds.MESH_BYTES.most
FORMATS = (".stl", ".obj", ".dae")
# Characters that a message quotes of a reader's failure.
LONGEST = 120


def load_corners(path: Path) -> Floats:
    """Return the corners of a mesh.

    Parameters
    ----------
    path : Path
        A regular file of at most 64 MiB.

    Returns
    -------
    (n, 3) float64
        m, in order of the file, each as often as it is in it; Collada in the unit that the file
        declares, and with its axes as they are, as ROS reads it.

    Raises
    ------
    InputError
        Why there are none: a file that is missing, too long, broken or of another format, or the
        package trimesh is not installed.  The message does not name the file.
    """
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        raise InputError(f"{path.suffix or 'no ending'} is none of {', '.join(FORMATS)}")
    try:
        # Of a pipe or a device nobody knows the length.
        if not path.is_file():
            raise InputError("there is no such file")
        with path.open("rb") as file:
            raw = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}") from None
    if len(raw) > MAX_BYTES:
        raise InputError(f"is longer than {MAX_BYTES} bytes")
    # Collada may be packed, to any size, and XML may define entities.
    if suffix == ".dae" and (raw[:2] == b"PK" or b"<!DOCTYPE" in raw):
        raise InputError("is an archive or has a document type declaration")
    corners = _parsed(raw, suffix[1:])
    if len(corners) < 3:
        raise InputError("has no triangle")
    if not np.isfinite(corners).all():
        raise InputError("has a corner that is no number")
    return corners


def _parsed(raw: bytes, kind: str) -> Floats:
    """Return the corners in the content of a file."""
    try:
        import collada
        import trimesh
    except ImportError:
        raise InputError("needs a reader of meshes: `pip install lutgen[meshes]`") from None
    try:
        # What a reader warns of is the file's author's affair, or its own.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            if kind == "dae":
                document = collada.Collada(io.BytesIO(raw), ignore=[collada.common.DaeError])
                faces = [p for one in document.scene.objects("geometry") for p in one.primitives()]
                parts = [one.vertex[np.unique(one.vertex_index)] for one in faces]
                factor = float(document.assetInfo.unitmeter or 1.0)
            else:
                # Nothing is merged or mended, and without a resolver nothing else is opened.
                more = {"skip_materials": True} if kind == "obj" else {}
                scene = trimesh.load_scene(io.BytesIO(raw), file_type=kind, process=False, **more)
                nodes = [scene.graph[node] for node in scene.graph.nodes_geometry]
                parts = [
                    trimesh.transform_points(scene.geometry[name].vertices, place)
                    for place, name in nodes
                ]
                factor = 1.0
        return factor * np.concatenate([np.zeros((0, 3)), *parts]).astype(np.float64)
    except Exception as error:
        # Broken files fail in any way that Python can.
        said = " ".join(str(error).split()) or type(error).__name__
        said = said if len(said) <= LONGEST else said[: LONGEST - 3] + "..."
        raise InputError(f"cannot be read as {kind.upper()}: {said}") from None

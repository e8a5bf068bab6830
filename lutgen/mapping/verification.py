"""The check of a whole map file against the digests that it carries.

Owns the reading of chunks without HDF5: in memory for one of them, and at the speed of the disk.
"""

import os
from pathlib import Path

import h5py
import numpy as np

from lutgen.errors import MapFileError
from lutgen.mapping.blocks import Plan
from lutgen.mapping.checksum import own_sum, sum_of
from lutgen.mapping.identity import DIGEST, Identity
from lutgen.mapping.map import StabilityMap, damaged
from lutgen.mapping.seal import check_head
from lutgen.mapping.template import DIGESTS, chunk_places


def verify(stability_map: StabilityMap) -> None:
    """Read the whole file and check it against its digests; memory for one chunk.

    Raises
    ------
    MapFileError
        At the first chunk that does not have the digest of its place in this map, or if the head
        does not match its own, or if there is none.
    """
    path = Path(stability_map.path)
    if check_head(path) is None:
        raise MapFileError(
            f"{path}: cannot be verified (got a file without a digest, edited or damaged); sweep "
            "it again"
        )
    recipe, attributes = stability_map.recipe, stability_map.attributes
    try:
        with h5py.File(path, "r") as file, path.open("rb", buffering=0) as raw:
            digests = file[DIGESTS][...]
            for index, name in enumerate(recipe.channels):
                variable = file[name]
                layout = Plan(variable.shape, variable.chunks)
                identity = Identity(
                    recipe.digest,
                    int(attributes["lutgen_definition"]),
                    str(attributes["lutgen_version"]),
                    layout.chunk,
                    recipe.channels,
                )
                chunk = np.empty(layout.chunk_bytes(name), np.uint8)
                if digests.shape != (layout.count, len(recipe.channels), DIGEST):
                    raise ValueError(f"digests of the shape {digests.shape}")
                for number, place in enumerate(chunk_places(variable, layout)):
                    count = os.preadv(raw.fileno(), [memoryview(chunk.data)], int(place))
                    own = identity.digest(chunk, name, number)
                    if count != chunk.nbytes or own != digests[number, index].tobytes():
                        raise _foreign(path, name, number, chunk)
    except (OSError, RuntimeError, KeyError, ValueError) as error:
        if isinstance(error, MapFileError):
            raise
        raise damaged(str(path), "cannot be read to its end", error) from error


def _foreign(path: Path, name: str, number: int, chunk: np.ndarray) -> MapFileError:
    """Return the error of a block that is not what was written at its place."""
    held, own = own_sum(chunk), sum_of(chunk)
    if held != own:
        return MapFileError(
            f"{path}: channel {name} has values that do not match their checksum (got {own:08x} "
            f"instead of {held:08x} in block {number}); the file is damaged: sweep it again"
        )
    return MapFileError(
        f"{path}: channel {name} has values of another map or place, or edited ones (got block "
        f"{number} with a checksum of its own, but without its digest); sweep it again"
    )

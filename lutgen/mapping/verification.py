"""The check of a whole map file against the digest that it carries.

Owns the reading of chunks without HDF5: in memory for one of them, and at the speed of the disk.
"""

import io
import os
from pathlib import Path

import h5py
import numpy as np

from lutgen.errors import MapFileError
from lutgen.mapping.blocks import Plan
from lutgen.mapping.checksum import own_sum, sum_of
from lutgen.mapping.map import StabilityMap, chunk_places, damaged
from lutgen.mapping.seal import check_head, checksums_digest


def verify(stability_map: StabilityMap) -> None:
    """Read the whole file and check it against its digest; memory for one chunk.

    Raises
    ------
    MapFileError
        At the first chunk whose checksum does not hold, or if head or checksums are not those of
        the digest, or if there is none.
    """
    path = Path(stability_map.path)
    seal = check_head(path)
    if seal is None:
        raise MapFileError(
            f"{path}: cannot be verified (got a file without a digest, from an earlier lutgen or "
            "damaged); sweep it again"
        )
    sums = []
    try:
        with h5py.File(path, "r") as file, path.open("rb", buffering=0) as raw:
            for name in stability_map.channels:
                variable = file[name]
                layout = Plan(variable.shape, variable.chunks)
                places = chunk_places(variable, layout)
                sums.append(np.array([_checksum(raw, p, layout, name) for p in places], np.uint32))
    except (OSError, RuntimeError, KeyError) as error:
        if isinstance(error, MapFileError):
            raise
        raise damaged(str(path), "cannot be read to its end", error) from error
    own = checksums_digest(np.stack(sums))
    if own != seal.chunks:
        raise MapFileError(
            f"{path}: its values do not match its digest (got {own[:12]} instead of"
            f" {seal.chunks[:12]}); they were changed after the sweep: sweep it again"
        )


def _checksum(file: io.FileIO, place: int, layout: Plan, name: str) -> int:
    """Return the checksum that stands in a chunk, which must be that of its values."""
    chunk = np.empty(layout.chunk_bytes(name), np.uint8)
    count = os.preadv(file.fileno(), [memoryview(chunk.data)], place)
    held, own = own_sum(chunk), sum_of(chunk)
    if count != chunk.nbytes or held != own:
        raise MapFileError(
            f"{file.name}: channel {name} has values that do not match their checksum (got "
            f"{own:08x} instead of {held:08x}); the file is damaged: sweep it again"
        )
    return held

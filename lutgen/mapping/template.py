"""A map file without values: HDF5 that xarray, MATLAB and h5dump read without us.

Owns the layout of format version 1 (docs/reference/format.md).  Every chunk has its place when the
file is laid out and is written there with its checksum, so any number of threads or processes can
fill one file and HDF5 has nothing to do meanwhile.
"""

import io
from typing import Any, NamedTuple

import h5py
import numpy as np
from numpy.typing import NDArray

from lutgen._version import __version__
from lutgen.mapping.blocks import Plan
from lutgen.mapping.identity import DIGEST, Identity
from lutgen.mapping.seal import ATTRIBUTE, UNSEALED
from lutgen.quantities import QUANTITIES
from lutgen.recipe import Recipe

FORMAT = 1
# Which definition of what stands the values are by (docs/reference/conventions.md).  That of 0.1
# wrote no number; 2 had stages and chains of rolls; 3 has one roll and one landing.
DEFINITION = 3
COMPLETE, BITMAP = "complete", "blocks_done"
# Where the digests of blocks are; in a group, so that who reads the map does not meet them.
DIGESTS = "seal/blocks"
# Chunks of at least so many bytes begin on a page: two processes never write to the same one.
ALIGN_FROM, ALIGNMENT = 1 << 15, 1 << 12


def identity_of(recipe: Recipe, layout: Plan) -> Identity:
    """Return what the blocks of a map that is computed here and now belong to."""
    return Identity(recipe.digest, DEFINITION, __version__, layout.chunk, recipe.channels)


class Places(NamedTuple):
    """Where things are in a file, in bytes: per channel its chunks (blocks,), and the digests."""

    chunks: dict[str, NDArray[np.int64]]
    digests: slice


def create(target: io.RawIOBase, recipe: Recipe, layout: Plan) -> Places:
    """Write a map whose chunks are all zeros, that is without values yet, into a file object.

    Channel after channel, block after block they follow upon each other, large ones on whole
    pages; what is not a chunk comes before them.
    """
    with h5py.File(
        target,
        "w",
        libver=("earliest", "v110"),
        alignment_threshold=ALIGN_FROM,
        alignment_interval=ALIGNMENT,
    ) as file:
        # First, so that it is found near the beginning of the file without HDF5.
        file.attrs[ATTRIBUTE] = UNSEALED
        file.attrs["Conventions"] = "CF-1.10"
        file.attrs["title"] = f"stability map of {recipe.name}"
        file.attrs["lutgen_format"] = FORMAT
        file.attrs["lutgen_definition"] = DEFINITION
        file.attrs["lutgen_version"] = __version__
        file.attrs["recipe"] = recipe.text
        if recipe.urdf is not None:
            file.attrs["urdf"] = recipe.urdf
        file.attrs["recipe_sha256"] = recipe.digest
        file.attrs["chart"] = recipe.chart.kind
        file.attrs[COMPLETE] = 0
        file.attrs[BITMAP] = np.zeros(-(-layout.count // 8), np.uint8)
        digests = _digests(file, layout, len(recipe.channels))
        scales = [
            _scale(file, axis.name, axis.knots, axis.unit, f"geometry parameter {axis.name}")
            for axis in recipe.grid.axes
        ]
        faces = np.arange(recipe.chart.faces, dtype=np.int32)
        scales.append(_scale(file, "face", faces, "1", "face of the gravity chart"))
        file["face"].attrs["flag_values"] = faces
        file["face"].attrs["flag_meanings"] = "-z +x -x +y -y +z"[: 3 * recipe.chart.faces - 1]
        for name in ("v", "u"):
            text = f"gnomonic face coordinate {name} of the gravity direction"
            scales.append(_scale(file, name, recipe.chart.coords, "1", text))
        for name in recipe.channels:
            quantity, variable = QUANTITIES[name], _variable(file, name, layout)
            if quantity.words:
                # Every node has a word, so there is no fill value to turn bytes into floats.
                variable.attrs["flag_values"] = np.arange(len(quantity.words), dtype=np.uint8)
                variable.attrs["flag_meanings"] = " ".join(quantity.words)
            else:
                variable.attrs["_FillValue"] = np.array([np.nan], np.float32)
            variable.attrs["units"] = quantity.stored_unit(recipe.length_unit)
            variable.attrs["long_name"] = quantity.title
            for axis, scale in enumerate(scales):
                variable.dims[axis].attach_scale(scale)
        # One byte per chunk first: the whole index comes to lie before the first real chunk.
        for first in (True, False):
            for name in recipe.channels:
                variable = file[name].id
                chunk = bytes(1 if first else layout.chunk_bytes(name))
                for block in layout.blocks():
                    variable.write_direct_chunk(block.offset, chunk)
        chunks = {name: chunk_places(file[name], layout) for name in recipe.channels}
        return Places(chunks, digests)


def _digests(file: h5py.File, layout: Plan, channels: int) -> slice:
    """Make room for a digest of each block and channel, all zeros; return where it is."""
    create_list = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    create_list.set_obj_track_times(False)
    create_list.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    space = h5py.h5s.create_simple((layout.count, channels, DIGEST))
    group, name = DIGESTS.split("/")
    made = h5py.h5d.create(
        file.create_group(group).id, name.encode(), h5py.h5t.STD_U8LE, space, create_list
    )
    start = int(made.get_offset())
    return slice(start, start + layout.count * channels * DIGEST)


def _scale(
    file: h5py.File, name: str, values: NDArray[Any], unit: str, long_name: str
) -> h5py.Dataset:
    scale = file.create_dataset(name, data=values)
    scale.make_scale(name)
    scale.attrs["units"] = unit
    scale.attrs["long_name"] = long_name
    return scale


def _variable(file: h5py.File, name: str, layout: Plan) -> h5py.Dataset:
    """Make a channel's variable without any chunk."""
    create_list = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    create_list.set_chunk(layout.chunk)
    # No time of making in the file: the same recipe gives the same bytes.
    create_list.set_obj_track_times(False)
    create_list.set_fletcher32()
    words, kind = QUANTITIES[name].words, QUANTITIES[name].stored_type
    # Whatever is missing is the worst.
    create_list.set_fill_value(np.array(len(words) - 1 if words else np.nan, kind))
    create_list.set_alloc_time(h5py.h5d.ALLOC_TIME_INCR)
    create_list.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    space = h5py.h5s.create_simple(layout.shape)
    stored = h5py.h5t.STD_U8LE if words else h5py.h5t.IEEE_F32LE
    h5py.h5d.create(file.id, name.encode(), stored, space, create_list)
    return file[name]


def chunk_places(variable: h5py.Dataset, layout: Plan) -> NDArray[np.int64]:
    """Return the place of every chunk of a variable in the file, in bytes."""
    places = np.zeros(layout.count, np.int64)

    def note(info: Any) -> None:
        grid = tuple(o // c for o, c in zip(info.chunk_offset, layout.chunk, strict=True))
        places[np.ravel_multi_index(grid, layout.counts)] = info.byte_offset

    variable.id.chunk_iter(note)
    return places

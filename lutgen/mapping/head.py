"""Lay out a map file: all of its bytes but the values, and where each channel's values go.

HDF5 writes this *head* into memory.  The values of the channels follow it, one after the other, so
the head is a prefix of the file and each value has a fixed place (docs/reference/format.md).
"""

import io
from dataclasses import dataclass
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from lutgen._version import __version__
from lutgen.mapping.seal import ATTRIBUTE, BLANK, DEFINITION, DIGEST, Plan, Storage
from lutgen.quantities import QUANTITIES
from lutgen.recipe import Recipe

FORMAT = 2
COMPLETE = "complete"
# The digests of blocks are in a group of their own, so that readers of channels do not meet them.
DIGESTS, ROWS = "seal/blocks", "rows"


@dataclass(frozen=True)
class Head:
    """The layout of one map file of `size` bytes.

    `data` is its beginning, with zeros for the digests of blocks, at the bytes `digests`.
    """

    data: bytes
    digests: slice
    storage: Storage
    size: int


class _Memory(io.BytesIO):
    """A file in memory; `end`, once it is set, is where writing has no effect any more."""

    end: int | None = None

    def write(self, data: Any) -> int:
        if self.end is not None and self.tell() >= self.end:
            return len(data)
        return super().write(data)


def lay_out(recipe: Recipe, layout: Plan, complete: bool) -> Head:
    """Return the head of a recipe's map; the same bytes every time."""
    memory = _Memory()
    with h5py.File(memory, "w", libver=("earliest", "v110")) as file:
        for name, value in _attributes(recipe, complete).items():
            file.attrs[name] = value
        group, name = DIGESTS.split("/")
        shape = (layout.count, len(recipe.channels), DIGEST)
        early = h5py.h5d.ALLOC_TIME_EARLY
        digests = _variable(file.create_group(group), name, "uint8", shape, early)
        digests.attrs[ROWS] = layout.rows
        scales = [
            _scale(file, axis.name, axis.knots, axis.unit, f"geometry parameter {axis.name}")
            for axis in recipe.grid.axes
        ]
        faces = np.arange(recipe.chart.faces, dtype=np.int32)
        scales.append(_scale(file, "face", faces, "1", "face of the gravity chart"))
        scales[-1].attrs["flag_values"] = faces
        scales[-1].attrs["flag_meanings"] = "-z +x -x +y -y +z"[: 3 * len(faces) - 1]
        for name in ("v", "u"):
            text = f"gnomonic face coordinate {name} of the gravity direction"
            scales.append(_scale(file, name, recipe.chart.coords, "1", text))
        channels = [_channel(file, name, recipe, layout, scales) for name in recipe.channels]
        file.flush()
        memory.end = memory.seek(0, io.SEEK_END)
        for channel in channels:
            # HDF5 gives a variable its place at the first value, which is not kept.
            channel[(0,) * channel.ndim] = 0
        places = tuple(channel.id.get_offset() for channel in channels)
        start = digests.id.get_offset()
        held, size = slice(start, start + digests.nbytes), places[-1] + channels[-1].nbytes
    storage = Storage(recipe, layout, places, __version__)
    return Head(memory.getvalue().ljust(places[0], b"\0"), held, storage, size)


def _attributes(recipe: Recipe, complete: bool) -> dict[str, Any]:
    """Return the root attributes; the seal comes first, to be found near the file's beginning."""
    return {
        ATTRIBUTE: BLANK,
        "Conventions": "CF-1.10",
        "title": f"stability map of {recipe.name}",
        "history": f"computed by `lutgen sweep` of lutgen {__version__}",
        "lutgen_format": FORMAT,
        "lutgen_definition": DEFINITION,
        "lutgen_version": __version__,
        "recipe": recipe.text,
        **({} if recipe.urdf is None else {"urdf": recipe.urdf}),
        "recipe_sha256": recipe.digest,
        "chart": recipe.chart.kind,
        COMPLETE: int(complete),
    }


def _variable(
    group: h5py.Group, name: str, kind: str, shape: tuple[int, ...], allocated: int
) -> h5py.Dataset:
    """Make a contiguous variable into which HDF5 writes nothing, not even the time of making it."""
    made = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    made.set_layout(h5py.h5d.CONTIGUOUS)
    made.set_obj_track_times(False)
    made.set_alloc_time(allocated)
    made.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    stored = h5py.h5t.py_create(np.dtype(kind).newbyteorder("<"))
    h5py.h5d.create(group.id, name.encode(), stored, h5py.h5s.create_simple(shape), made)
    return group[name]


def _scale(
    file: h5py.File, name: str, values: NDArray[Any], unit: str, long_name: str
) -> h5py.Dataset:
    scale = file.create_dataset(name, data=values)
    scale.make_scale(name)
    scale.attrs["units"] = unit
    scale.attrs["long_name"] = long_name
    return scale


def _channel(
    file: h5py.File, name: str, recipe: Recipe, layout: Plan, scales: list[h5py.Dataset]
) -> h5py.Dataset:
    quantity = QUANTITIES[name]
    late = h5py.h5d.ALLOC_TIME_LATE
    variable = _variable(file, name, quantity.stored_type, layout.shape, late)
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
    return variable

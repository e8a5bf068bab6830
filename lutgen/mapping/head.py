"""Lay out a map file: all of its bytes but the values, and where each channel's values go.

HDF5 writes this *head* into memory.  The values of the channels follow it, one after the other, so
the head is a prefix of the file and each value has a fixed place (docs/reference/format.md).  It
holds the digests of all blocks, so its seal stands for every byte of the file; that is checked
before HDF5 reads the file, because HDF5 can crash on damaged metadata.
"""

import io
import math
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import h5py
import numpy as np
from blake3 import blake3
from numpy.typing import NDArray

from lutgen._version import __version__
from lutgen.errors import MapFileError
from lutgen.quantities import QUANTITIES
from lutgen.recipe import HDF5 as SIGNATURE
from lutgen.recipe import Recipe

# Nodes of a block per channel: 4 MiB of float32, large enough that the cost of a block vanishes and
# small enough to stay in the last-level cache between computing and writing.
BLOCK_NODES = 1 << 20
# Postures of a block, where each has few directions: their contacts must fit in the cache too.
BLOCK_POSTURES = 1 << 14


class Block(NamedTuple):
    """Rows [first, last) of a map; row = posture * (faces * nodes) + face * nodes + v."""

    number: int
    first: int
    last: int


@dataclass(frozen=True)
class Layout:
    """The blocks of a recipe's map and, once HDF5 has chosen them, the `places` of its channels.

    A block has `rows` rows, whole postures; the last may have fewer.  `places` are the bytes at
    which the channels begin; the digests of blocks depend on `version`.
    """

    recipe: Recipe
    rows: int
    places: tuple[int, ...] = ()
    version: str = __version__

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of each channel: parameters..., face, v, u."""
        return (*self.recipe.grid.shape, *self.recipe.chart.shape)

    @property
    def count(self) -> int:
        """Number of blocks."""
        return -(-math.prod(self.shape[:-1]) // self.rows)

    def block(self, number: int) -> Block:
        """Return a block by its number, 0 <= number < count."""
        first = number * self.rows
        return Block(number, first, min(first + self.rows, math.prod(self.shape[:-1])))

    def span(self, index: int, number: int) -> tuple[int, int]:
        """Return place and size of one block of a channel, in bytes."""
        kind = np.dtype(QUANTITIES[self.recipe.channels[index]].stored_type)
        block, row = self.block(number), self.shape[-1] * kind.itemsize
        return self.places[index] + block.first * row, (block.last - block.first) * row

    @property
    def size(self) -> int:
        """Bytes of the whole file."""
        return sum(self.span(len(self.places) - 1, self.count - 1))

    def digest(self, values: bytes | memoryview, index: int, number: int) -> bytes:
        """Return the digest (`DIGEST` bytes) of one block of a channel, for this place and map."""
        facts = (self.recipe.digest, DEFINITION, self.version, self.rows)
        text = "\n".join(map(str, ("lutgen block", *facts, self.recipe.channels[index], number)))
        key = blake3(text.encode()).digest()
        return blake3(values, key=key).digest()


def plan(recipe: Recipe, block_nodes: int = BLOCK_NODES) -> Layout:
    """Return the blocks of a recipe's map: of at most `block_nodes` nodes each, or one posture."""
    faces, side, width = recipe.chart.shape
    most = max(1, min(block_nodes // (faces * side * width), BLOCK_POSTURES))
    blocks = -(-recipe.grid.size // most)
    return Layout(recipe, faces * side * -(-recipe.grid.size // blocks))


# The definition of what stands (docs/reference/conventions.md).
DEFINITION = 3
ATTRIBUTE = "digest"
# Bytes of the digest of a block; one that is not written yet is zeros.
DIGEST = 32
# The number of this way of sealing; 1 and 2 belong to map format 1.
_WAY = 3
_TEXT = f"lutgen-digest-{_WAY} at={{:012d}} head={{:012d}} size={{:015d}} blake3={{}}"
# Stands in a file whose sweep is not done.
BLANK = _TEXT.format(0, 0, 0, "." * 64)
_ANY = re.compile(rb"lutgen-digest-(\d{1,9}) (?:at=(\d{12}) head=(\d{12}) size=(\d{15}) )?")
# The seal is the first attribute of a file, within this many bytes.
_SEARCHED = 1 << 16
# The byte that HDF5 sets while it writes to a file of this superblock (version 0).
_WRITTEN = 20
_AS_IT_IS = (
    "sweep it again, or read it as it is: `lutgen info --unsealed`, `load_map(path, unsealed=True)`"
)


def sealed(head: bytes, size: int) -> bytes:
    """Return the head of a file of `size` bytes with a seal in the place of `BLANK`."""
    at = head.index(BLANK.encode())

    def with_digest(digest: str) -> bytes:
        text = _TEXT.format(at, len(head), size, digest).encode()
        return head[:at] + text + head[at + len(text) :]

    return with_digest(blake3(with_digest("0" * 64)).hexdigest())


def check_seal(path: Path) -> None:
    """Refuse a file whose head does not match its seal; MapFileError or OSError is raised."""
    with path.open("rb") as file:
        fault = _fault(file)
    if fault:
        raise MapFileError(f"{path}: {fault}")


def _fault(file: BinaryIO) -> str:
    """Return what is wrong with the head of a file, and what to do; "" for nothing."""
    begin = file.read(_SEARCHED)
    size = file.seek(0, io.SEEK_END)
    if not begin.startswith(SIGNATURE):
        return f"is no HDF5 file (got {begin[:8]!r}); name a map that `lutgen sweep` has made"
    found = _ANY.search(begin)
    if found is None:
        what = "HDF5 of another program, or a map that another program has rewritten"
        return f"has no seal (got {what}); {_AS_IT_IS}"
    if int(found[1]) != _WAY:
        kind = "map format 1" if int(found[1]) < _WAY else "a later map format"
        what = f"lutgen-digest-{int(found[1])} instead of {_WAY}"
        return f"has {kind}, which this lutgen does not read (got {what}); sweep it again"
    at, length, whole = (int(found[k] or -1) for k in (2, 3, 4))
    if length == 0:
        return "is not complete (got no digest yet); finish it with `lutgen sweep --resume`"
    if at >= 0 and (at != found.start() or size > whole):
        what = f"{size} bytes with a seal at byte {found.start()}, not {whole} bytes and byte {at}"
        return f"was rewritten or edited by another program (got {what}); {_AS_IT_IS}"
    if size < whole:
        return f"is cut off (got {size} bytes instead of {whole}); copy it or sweep it again"
    if begin[_WRITTEN]:
        what = f"HDF5's mark of it, {begin[_WRITTEN]}"
        return f"is open for writing in another program (got {what}); close it there, then read it"
    file.seek(0)
    head, start = file.read(max(length, 0)), found.end() + len("blake3=")
    sealed_by, end = head[start : start + 64], start + 64
    own = blake3(head[:start] + b"0" * 64 + head[end:]).hexdigest().encode()
    if own != sealed_by:
        what = f"{own[:12]!r} instead of {sealed_by[:12]!r}"
        return (
            f"has a head that does not match its digest (got {what}); it is damaged or was edited: "
            "copy it or sweep it again"
        )
    return ""


FORMAT = 2
COMPLETE = "complete"
# The digests of blocks are in a group of their own, so that readers of channels do not meet them.
DIGESTS, ROWS = "seal/blocks", "rows"


class Head(NamedTuple):
    """The beginning of a map file, and its layout with the places of the channels.

    `data` has zeros for the digests of blocks, at the bytes `digests`.
    """

    data: bytes
    digests: slice
    layout: Layout


class _Memory(io.BytesIO):
    """A file in memory; `end`, once it is set, is where writing has no effect any more."""

    end: int | None = None

    def write(self, data: Any) -> int:
        if self.end is not None and self.tell() >= self.end:
            return len(data)
        return super().write(data)


def lay_out(layout: Layout, complete: bool) -> Head:
    """Return the head of a map; the same bytes every time."""
    memory, recipe = _Memory(), layout.recipe
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
        channels = [_channel(file, name, layout, scales) for name in recipe.channels]
        file.flush()
        memory.end = memory.seek(0, io.SEEK_END)
        for channel in channels:
            # HDF5 gives a variable its place at the first value, which is not kept.
            channel[(0,) * channel.ndim] = 0
        places = tuple(channel.id.get_offset() for channel in channels)
        start = digests.id.get_offset()
        found = slice(start, start + digests.nbytes)
    data = memory.getvalue().ljust(places[0], b"\0")
    return Head(data, found, replace(layout, places=places))


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
    file: h5py.File, name: str, layout: Layout, scales: list[h5py.Dataset]
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
    variable.attrs["units"] = quantity.stored_unit(layout.recipe.length_unit)
    variable.attrs["long_name"] = quantity.title
    for axis, scale in enumerate(scales):
        variable.dims[axis].attach_scale(scale)
    return variable

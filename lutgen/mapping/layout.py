"""All bytes of a map file but its values, made before the first value is computed.

HDF5 writes into memory, never to the disk, so that it neither writes the values a first time when
it makes room for them, nor has anything to lose when a sweep is killed.  Everything that is not a
chunk lies in the head, before the first chunk (chunks of a few bytes can lie in its gaps).
"""

import io
from dataclasses import dataclass

import h5py
import numpy as np
from numpy.typing import NDArray

from lutgen.mapping.blocks import Plan
from lutgen.mapping.seal import UNSEALED
from lutgen.mapping.template import BITMAP, COMPLETE, create
from lutgen.recipe import Recipe


class Image(io.RawIOBase):
    """A file in memory; the zeros at its end are counted and not stored.

    `head` holds the bytes up to there; `size` is the size of the file.
    """

    def __init__(self, head: bytes = b"", size: int = 0) -> None:
        self.head, self.size, self._at = bytearray(head), size, 0

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Go to a place."""
        self._at = offset + {io.SEEK_SET: 0, io.SEEK_CUR: self._at, io.SEEK_END: self.size}[whence]
        return self._at

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        """Fill a buffer; past the head with zeros."""
        part = self.head[self._at : self._at + len(buffer)]
        # The view of older versions of h5py takes no bytes.
        target = np.frombuffer(buffer, np.uint8)
        target[: len(part)] = np.frombuffer(part, np.uint8)
        target[len(part) :] = 0
        self._at += len(buffer)
        return len(buffer)

    def write(self, data: memoryview) -> int:  # type: ignore[override]
        """Write a buffer; zeros past the head only make the file longer."""
        end = self._at + len(data)
        if self._at < len(self.head) or np.frombuffer(data, np.uint8).max(initial=0):
            self.head.extend(bytes(max(0, end - len(self.head))))
            self.head[self._at : end] = data
        self._at, self.size = end, max(self.size, end)
        return len(data)

    def truncate(self, size: int | None = None) -> int:
        """Set the size of the file."""
        self.size = self._at if size is None else size
        del self.head[self.size :]
        return self.size


@dataclass(frozen=True)
class Skeleton:
    """The layout of one map file.

    `head` is its beginning while the sweep is running, `finished` the same afterwards but for
    the digest; `size` is that of the file, `places` (channels, blocks) and `chunk_bytes`
    (channels,) say where its chunks are; `bitmap` is where the head keeps the set of finished
    blocks, and `digests` where it keeps those of all blocks (blocks, channels, bytes).
    """

    head: bytes
    finished: bytes
    size: int
    places: NDArray[np.int64]
    chunk_bytes: NDArray[np.int64]
    bitmap: slice
    digests: slice

    def values(self) -> NDArray[np.bool_]:
        """Return which bytes of the head belong to chunks (none, unless chunks are tiny)."""
        mask = np.zeros(len(self.head), np.bool_)
        for places, size in zip(self.places, self.chunk_bytes, strict=True):
            for place in places[places < len(self.head)]:
                mask[place : place + size] = True
        return mask

    def state(self) -> NDArray[np.bool_]:
        """Return which bytes of the head say how far the sweep is."""
        mask = _differs(self.head, self.finished)
        mask[self.bitmap] = mask[self.digests] = True
        start = self.head.index(UNSEALED.encode())
        mask[start : start + len(UNSEALED)] = True
        return mask


def lay_out(recipe: Recipe, layout: Plan) -> Skeleton:
    """Return the skeleton of a recipe's map; the same bytes every time."""
    image = Image()
    places = create(image, recipe, layout)
    # Of the zeros at its end only the digests are to come.
    head = bytes(image.head).ljust(places.digests.stop, b"\0")
    # HDF5 itself says where it keeps the set of finished blocks, and what ends a sweep.
    marked, ended = Image(head, image.size), Image(head, image.size)
    with h5py.File(marked, "r+") as file:
        attribute = h5py.h5a.open(file.id, BITMAP.encode())
        attribute.write(np.full(attribute.shape, 255, np.uint8))
    with h5py.File(ended, "r+") as file:
        h5py.h5a.open(file.id, COMPLETE.encode()).write(np.array(1, np.int64))
        h5py.h5a.delete(file.id, BITMAP.encode())
    touched = np.flatnonzero(_differs(head, marked.head))
    return Skeleton(
        head,
        bytes(ended.head),
        image.size,
        np.stack([places.chunks[name] for name in recipe.channels]),
        np.array([layout.chunk_bytes(name) for name in recipe.channels]),
        slice(int(touched[0]), int(touched[-1]) + 1),
        places.digests,
    )


def _differs(one: bytes | bytearray, other: bytes | bytearray) -> NDArray[np.bool_]:
    """Return at which bytes two heads differ."""
    mask: NDArray[np.bool_] = np.frombuffer(one, np.uint8) != np.frombuffer(other, np.uint8)
    return mask

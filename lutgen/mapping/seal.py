"""Cut a map into blocks of rows; compute the digest of each block, and the seal of the head.

The head holds the digests of all blocks, so the seal stands for every byte of the file.  It is
checked before HDF5 reads the file, because HDF5 can crash on damaged metadata.
"""

import io
import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np
from blake3 import blake3

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
class Plan:
    """The blocks of one map, whose channels have a `shape` (parameters..., face, v, u).

    A block has `rows` rows, whole postures or a part of one; the last of either may have fewer.
    """

    shape: tuple[int, ...]
    rows: int

    @property
    def nodes(self) -> int:
        """Nodes of the map, per channel."""
        return math.prod(self.shape)

    @property
    def _uncut(self) -> int:
        """Rows of which blocks are cut: those of the whole map, or of one posture."""
        posture = math.prod(self.shape[-3:-1])
        return posture if self.rows % posture else self.nodes // self.shape[-1]

    @property
    def count(self) -> int:
        """Number of blocks."""
        return self.nodes // self.shape[-1] // self._uncut * -(-self._uncut // self.rows)

    def block(self, number: int) -> Block:
        """Return a block by its number, 0 <= number < count."""
        uncut = self._uncut
        whole, part = divmod(number, -(-uncut // self.rows))
        first = whole * uncut + part * self.rows
        return Block(number, first, min(first + self.rows, (whole + 1) * uncut))


def plan(recipe: Recipe, block_nodes: int = BLOCK_NODES) -> Plan:
    """Return the plan of a recipe's map, with blocks of at most `block_nodes` nodes or one row."""
    faces, side, width = recipe.chart.shape
    posture = faces * side
    most = min(block_nodes // (posture * width), BLOCK_POSTURES)
    if most:
        rows = posture * _even(recipe.grid.size, most)
    else:
        rows = _even(posture, max(1, block_nodes // width))
    return Plan((*recipe.grid.shape, *recipe.chart.shape), rows)


def _even(count: int, most: int) -> int:
    """Return the size of the fewest parts of nearly equal size, each at most `most`."""
    return -(-count // -(-count // most))


# Which definition of what stands the values are by (docs/reference/conventions.md).
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


@dataclass(frozen=True)
class Storage:
    """The bytes at which a map file's channels begin, and the facts that digests depend on."""

    recipe: Recipe
    layout: Plan
    places: tuple[int, ...]
    version: str

    def span(self, index: int, number: int) -> tuple[int, int]:
        """Return place and size of one block of a channel, in bytes."""
        kind = np.dtype(QUANTITIES[self.recipe.channels[index]].stored_type)
        block, row = self.layout.block(number), self.layout.shape[-1] * kind.itemsize
        return self.places[index] + block.first * row, (block.last - block.first) * row

    def digest(self, values: bytes | memoryview, index: int, number: int) -> bytes:
        """Return the digest (`DIGEST` bytes) of one block of a channel, for this place and map."""
        facts = (self.recipe.digest, DEFINITION, self.version, self.layout.rows)
        text = "\n".join(map(str, ("lutgen block", *facts, self.recipe.channels[index], number)))
        key = blake3(text.encode()).digest()
        return blake3(values, key=key).digest()


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
    held, end = head[start : start + 64], start + 64
    own = blake3(head[:start] + b"0" * 64 + head[end:]).hexdigest().encode()
    if own != held:
        what = f"{own[:12]!r} instead of {held[:12]!r}"
        return (
            f"has a head that does not match its digest (got {what}); it is damaged or was edited: "
            "copy it or sweep it again"
        )
    return ""

"""The digest that a finished map file carries, and the check of its head before HDF5 reads it.

Owns the text of the attribute `digest` (docs/reference/format.md): SHA-256 of the file's head,
which is all that is not values, and of the checksums of its chunks.  Damage anywhere shows in one
of the two.
HDF5 can crash on damaged metadata, so the head is compared before HDF5 sees it.
"""

import hashlib
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from lutgen.errors import MapFileError

ATTRIBUTE = "digest"
_TEXT = "lutgen-digest-1 head={:012d} sha256={} chunks={}"
_NONE = "." * 64
UNSEALED = _TEXT.format(0, _NONE, _NONE)
_PATTERN = re.compile(rb"lutgen-digest-1 head=(\d{12}) sha256=([0-9a-f]{64}) chunks=([0-9a-f]{64})")
# The attribute is the first of the file, within this many bytes.
_SEARCHED = 1 << 16


@dataclass(frozen=True)
class Seal:
    """What the digest says: length of the head in bytes, SHA-256 of head and of checksums, hex."""

    length: int
    head: str
    chunks: str


def checksums_digest(sums: NDArray[np.uint32]) -> str:
    """Return the SHA-256, in hex, of chunk checksums (channels, blocks), little-endian."""
    return hashlib.sha256(np.ascontiguousarray(sums, "<u4").tobytes()).hexdigest()


def sealed(head: bytes, sums: NDArray[np.uint32]) -> bytes:
    """Return a head, with `UNSEALED` as its digest, with that of itself and of the checksums."""
    chunks = checksums_digest(sums)

    def with_digest(own: str) -> bytes:
        return head.replace(UNSEALED.encode(), _TEXT.format(len(head), own, chunks).encode(), 1)

    return with_digest(hashlib.sha256(with_digest("0" * 64)).hexdigest())


def check_head(path: Path) -> Seal | None:
    """Check the head of a map file against its digest; MapFileError or OSError is raised.

    None for a file without a digest: foreign, unfinished, or of an earlier lutgen.
    """
    with path.open("rb") as file:
        found = _PATTERN.search(file.read(_SEARCHED))
        if found is None:
            return None
        seal = Seal(int(found[1]), found[2].decode(), found[3].decode())
        file.seek(0)
        head = file.read(seal.length) if seal.length < 1 << 32 else b""
    if len(head) < seal.length:
        raise MapFileError(
            f"{path}: cannot be read to its end (got {len(head)} bytes where its head alone has "
            f"{seal.length}); the file is damaged: sweep it again"
        )
    start, end = found.span(2)
    own = hashlib.sha256(head[:start] + b"0" * (end - start) + head[end:]).hexdigest()
    if own != seal.head:
        raise MapFileError(
            f"{path}: its head does not match its digest (got {own[:12]} instead of "
            f"{seal.head[:12]}); the file is damaged or was edited: sweep it again"
        )
    return seal

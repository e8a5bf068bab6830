"""The digest that a finished map file carries, and the check of its head before HDF5 reads it.

Owns the text of the attribute `digest` (docs/reference/format.md): SHA-256 of the file's head,
which is all that is not values, among it the digests of all blocks.  Damage anywhere shows in one
of the two.
HDF5 can crash on damaged metadata, so the head is compared before HDF5 sees it.
"""

import hashlib
import re
from dataclasses import dataclass
from pathlib import Path

from lutgen.errors import MapFileError

ATTRIBUTE = "digest"
# The number of this way of sealing: 1 had no digests of blocks.
_WAY = 2
_TEXT = f"lutgen-digest-{_WAY} head={{:012d}} sha256={{}}"
UNSEALED = _TEXT.format(0, "." * 64)
_PATTERN = re.compile(rb"lutgen-digest-(\d{1,9}) head=(\d{12}) sha256=([0-9a-f]{64})")
# The attribute is the first of the file, within this many bytes.
_SEARCHED = 1 << 16


@dataclass(frozen=True)
class Seal:
    """What the digest says: length of the head in bytes, and its SHA-256 in hex."""

    length: int
    head: str


def sealed(head: bytes) -> bytes:
    """Return a head, with `UNSEALED` as its digest, with that of itself."""

    def with_digest(own: str) -> bytes:
        return head.replace(UNSEALED.encode(), _TEXT.format(len(head), own).encode(), 1)

    return with_digest(hashlib.sha256(with_digest("0" * 64)).hexdigest())


def seal_of(data: bytes) -> Seal | None:
    """Return what the digest in a file's beginning says; None where there is none of ours."""
    found = _PATTERN.search(data[:_SEARCHED])
    return Seal(int(found[2]), found[3].decode()) if found and int(found[1]) == _WAY else None


def check_head(path: Path) -> Seal | None:
    """Check the head of a map file against its digest; MapFileError or OSError is raised.

    None for a file without a digest: foreign, unfinished, or edited.
    """
    with path.open("rb") as file:
        begin = file.read(_SEARCHED)
        found, seal = _PATTERN.search(begin), seal_of(begin)
        if found is None:
            return None
        if seal is None:
            raise MapFileError(
                f"{path}: was sealed in another way (got lutgen-digest-{int(found[1])}, this "
                f"lutgen has {_WAY}), by an earlier or a later version; sweep it again"
            )
        file.seek(0)
        head = file.read(seal.length) if seal.length < 1 << 32 else b""
    if len(head) < seal.length:
        raise MapFileError(
            f"{path}: cannot be read to its end (got {len(head)} bytes where its head alone has "
            f"{seal.length}); the file is damaged: sweep it again"
        )
    start, end = found.span(3)
    own = hashlib.sha256(head[:start] + b"0" * (end - start) + head[end:]).hexdigest()
    if own != seal.head:
        raise MapFileError(
            f"{path}: its head does not match its digest (got {own[:12]} instead of "
            f"{seal.head[:12]}); the file is damaged or was edited: sweep it again"
        )
    return seal

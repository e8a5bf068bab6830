"""What a block of a map belongs to, and the digest that says so.

Owns the key of a block: of which recipe, by which definition and version, how cut, which channel
and which number.  The digest of a chunk is BLAKE3 with that key, so a block of another map, or of
another place of the same one, does not have the digest that is expected there.
"""

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

from blake3 import blake3
from numpy.typing import NDArray

from lutgen.mapping.checksum import enter_sum

# Bytes of a digest; one that is not written yet is zeros.
DIGEST = 32


class Identity(NamedTuple):
    """What all blocks of one map have in common.

    `recipe` is its digest, `definition` and `version` (of lutgen) say how it was computed, `chunk`
    is the shape of a block, `channels` are their names in order.
    """

    recipe: str
    definition: int
    version: str
    chunk: tuple[int, ...]
    channels: tuple[str, ...]

    def key(self, channel: str, number: int) -> bytes:
        """Return the key (32 bytes) of one block of a channel."""
        text = "\n".join(
            (
                "lutgen block",
                self.recipe,
                str(self.definition),
                self.version,
                " ".join(map(str, self.chunk)),
                channel,
                str(number),
            )
        )
        return blake3(text.encode()).digest()

    def digest(self, chunk: NDArray[Any], channel: str, number: int) -> bytes:
        """Return the digest of one chunk with its checksum, as it stands in the file."""
        return blake3(memoryview(chunk.data).cast("B"), key=self.key(channel, number)).digest()

    def seal(self, number: int, chunks: Sequence[NDArray[Any]]) -> list[bytes]:
        """Enter the checksums of a block's chunks, of all channels; return their digests."""
        digests = []
        for channel, chunk in zip(self.channels, chunks, strict=True):
            enter_sum(chunk)
            digests.append(self.digest(chunk, channel, number))
        return digests

    def holds(self, number: int, chunks: Iterable[NDArray[Any]], digests: Sequence[bytes]) -> bool:
        """Return whether the chunks of a block have these digests."""
        return all(
            self.digest(chunk, channel, number) == digest
            for channel, chunk, digest in zip(self.channels, chunks, digests, strict=True)
        )

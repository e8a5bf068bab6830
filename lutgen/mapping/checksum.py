"""The Fletcher-32 checksum that HDF5 appends to every chunk.

Owns the sum, and where it stands: in the last four bytes.  HDF5's own filter takes longer than
computing the map; this one takes a tenth of that time, on data that is still in the cache, and the
chunk is then written as it is.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit

# Words of which the weighted sum fits 32 bits, of which a processor adds many at a time; and words
# after which sums are folded.
_RUN, _BLOCK = 1 << 8, 1 << 14
_MODULUS = 65535


def own_sum(chunk: NDArray[Any]) -> int:
    """Return the checksum that stands in the last four bytes of a chunk."""
    return int.from_bytes(chunk.view(np.uint8)[-4:].tobytes(), "little")


def sum_of(chunk: NDArray[Any]) -> int:
    """Return the checksum of what is before the last four bytes of a chunk.

    Of an odd number of bytes HDF5 takes the last as the higher half of a word.
    """
    data = chunk.view(np.uint8)[:-4]
    return fletcher32((np.append(data, np.uint8(0)) if data.size % 2 else data).view(np.uint16))


def enter_sum(chunk: NDArray[Any]) -> None:
    """Write the checksum of a chunk into its last four bytes."""
    chunk.view(np.uint8)[-4:] = np.frombuffer(sum_of(chunk).to_bytes(4, "little"), np.uint8)


def fletcher32(words: NDArray[np.uint16]) -> int:
    """Return HDF5's Fletcher-32 of little-endian data given as (n,) 16-bit words.

    HDF5 reads the words big-endian and folds its two sums modulo 65535, where a sum that is not
    zero never folds to zero.  Swapping the bytes of a word is a factor of 256 in that arithmetic,
    so it is left to the end.
    """
    even = words.size // 2 * 2
    low, high = _sums(words[:even].view(np.uint32), words[even:])
    return _swapped(int(high)) << 16 | _swapped(int(low))


def _swapped(word: int) -> int:
    """Return a 16-bit word with its bytes in the other order."""
    return (word & 0xFF) << 8 | word >> 8


@njit()
def _sums(pairs: NDArray[np.uint32], rest: NDArray[np.uint16]) -> tuple[np.uint64, np.uint64]:
    """Return the folded sum of words, two in each item and at most one more, and of such sums."""
    low = np.uint64(0)
    high = np.uint64(0)
    n = pairs.shape[0]
    for start in range(0, n, _BLOCK // 2):
        stop = min(start + _BLOCK // 2, n)
        for begin in range(start, stop, _RUN // 2):
            part = pairs[begin : min(begin + _RUN // 2, stop)]
            words = np.uint32(2 * part.shape[0])
            plain = np.uint32(0)
            weighted = np.uint32(0)
            second = np.uint32(0)
            for i in range(part.shape[0]):
                other = part[i] >> np.uint32(16)
                both = (part[i] & np.uint32(0xFFFF)) + other
                plain += both
                # The second of a pair counts once less; at most 2^16 (1 + ... + 256) below 2^32.
                second += other
                weighted += both * (words - np.uint32(2) * np.uint32(i))
            high += low * np.uint64(words) + np.uint64(weighted) - np.uint64(second)
            low += np.uint64(plain)
        low, high = _folded(low), _folded(high)
    for word in rest:
        low += np.uint64(word)
        high += low
    return _folded(low), _folded(high)


@njit(inline=True)
def _folded(total: np.uint64) -> np.uint64:
    """Return a sum modulo 65535; multiples of it other than zero stay other than zero."""
    if total == 0:
        return total
    return (total - np.uint64(1)) % np.uint64(_MODULUS) + np.uint64(1)

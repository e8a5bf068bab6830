"""The Fletcher-32 checksum that HDF5 appends to every chunk.

Owns nothing but the sum.  HDF5's own filter takes longer than computing the map; this one runs in
all threads on data that is still in the cache, and the chunk is then written as it is.
"""

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit, prange

_BLOCK = 1 << 14
_MODULUS = 65535


@njit(parallel=True)
def fletcher32(words: NDArray[np.uint16]) -> int:
    """Return HDF5's Fletcher-32 of little-endian data given as 16-bit words.

    HDF5 reads the words big-endian and folds its two sums modulo 65535, where a sum that is not
    zero never folds to zero.  Each block's sums are taken apart and joined in order, so the
    answer does not depend on the number of threads.
    """
    n = words.shape[0]
    blocks = (n + _BLOCK - 1) // _BLOCK
    plain = np.zeros(blocks, np.uint64)
    weighted = np.zeros(blocks, np.uint64)
    for b in prange(blocks):
        part = words[b * _BLOCK : min((b + 1) * _BLOCK, n)]
        first = np.uint64(0)
        second = np.uint64(0)
        for i in range(part.shape[0]):
            word = np.uint32(part[i])
            swapped = ((word & np.uint32(0xFF)) << np.uint32(8)) | (word >> np.uint32(8))
            first += np.uint64(swapped)
            # At most 2^14 words of 2^16 with weights up to 2^14: below 2^44.
            second += np.uint64(swapped) * np.uint64(part.shape[0] - i)
        plain[b] = first
        weighted[b] = second
    low = np.uint64(0)
    high = np.uint64(0)
    for b in range(blocks):
        size = np.uint64(min(_BLOCK, n - b * _BLOCK))
        high = _fold(high + low * size + weighted[b])
        low = _fold(low + plain[b])
    return int((high << np.uint64(16)) | low)


@njit()
def _fold(total: np.uint64) -> np.uint64:
    """Return total modulo 65535, with 65535 for multiples of it other than zero."""
    if total == 0:
        return total
    rest = np.uint64(total % np.uint64(_MODULUS))
    return rest if rest > 0 else np.uint64(_MODULUS)

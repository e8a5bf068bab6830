"""Plain fill of memory: the least that a sweep could take."""

import numpy as np

from lutgen.jit import njit, prange
from lutgen.vector import Singles

PARTS = 16


@njit(parallel=True)
def fill(out: Singles, value: np.float32) -> None:
    """Store a float32 `value` everywhere in `out` (k,), one contiguous part after the other.

    The value comes in as an argument, or the compiler would turn the loop into memset, whose
    stores bypass the cache.  The loop itself becomes plain vector stores, as fast as C's.
    """
    for part in prange(PARTS):
        piece = out[part * out.shape[0] // PARTS : (part + 1) * out.shape[0] // PARTS]
        for i in range(piece.shape[0]):
            piece[i] = value

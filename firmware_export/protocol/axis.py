"""The numbers of a parameter's axis as the descriptor holds them, as C takes them."""

import numpy as np
from numpy.typing import NDArray

from firmware_export.truth import Model


def axis_numbers(model: Model) -> NDArray[np.float32]:
    """Return min, max and 1 / (max - min) of every parameter, (k, 3), as smap_axis_t holds them.

    The last is rounded so that the upper end comes to 1 at most, and with it every place below.
    """
    lower, upper = model.lower.astype(np.float32), model.upper.astype(np.float32)
    inverse = (1.0 / (upper.astype(np.float64) - lower.astype(np.float64))).astype(np.float32)
    beyond = (upper - lower) * inverse > 1.0
    inverse = np.where(beyond, np.nextafter(inverse, np.float32(0.0)), inverse)
    return np.stack([lower, upper, inverse], axis=1).reshape(-1, 3)

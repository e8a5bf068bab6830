"""The numbers of a parameter's axis as the descriptor holds them, for C and for its twin."""

import numpy as np
from numpy.typing import NDArray

from firmware_export.model import Model


def axis_numbers(model: Model) -> NDArray[np.float32]:
    """Return min, max and 1 / (max - min) of every parameter, (k, 3), as smap_axis_t holds them."""
    lower, upper = model.lower.astype(np.float32), model.upper.astype(np.float32)
    span = upper.astype(np.float64) - lower.astype(np.float64)
    return np.stack([lower, upper, (1.0 / span).astype(np.float32)], axis=1).reshape(-1, 3)

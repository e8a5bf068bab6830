"""The codes of a verdict's table, and what turns them into tip margins."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Codes(NamedTuple):
    """A quantised table: value = offset + step * code."""

    codes: NDArray[np.int64]
    offset: float
    step: float

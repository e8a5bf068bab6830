"""Types of vectors, and of the arrays that kernels hand to each other."""

import numpy as np
from numpy.typing import NDArray

from lutgen.parts import Vector as Vector

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

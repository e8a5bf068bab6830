"""The sweep as a straightforward loop in C, compiled with -O3 -march=native when it is needed."""

import ctypes
import shutil
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.planes import Planes

COMMAND = ("cc", "-O3", "-march=native", "-shared", "-fPIC")


def compiler_version() -> str:
    """Return the first line of `cc --version`, or a word that there is none."""
    if shutil.which("cc") is None:
        return "no cc"
    text = subprocess.run(["cc", "--version"], capture_output=True, text=True, check=True).stdout
    return text.splitlines()[0]


class CReference:
    """The compiled loop; the library lives in `folder`."""

    def __init__(self, folder: Path) -> None:
        source = Path(__file__).with_name("reference.c")
        library = folder / "reference.so"
        subprocess.run([*COMMAND, str(source), "-o", str(library), "-lm"], check=True)
        functions = ctypes.CDLL(str(library))
        self._function, self._metrics = functions.stability_factor, functions.three_metrics
        self._function.restype = self._metrics.restype = None
        self._pool = ThreadPoolExecutor(2)

    def run(
        self,
        held: Planes,
        directions: NDArray[np.float64],
        out: NDArray[np.float32],
        threads: int,
    ) -> None:
        """Fill `out` (m * directions,) with |SD_g|; directions (g, 3).

        The postures are split over Python threads: ctypes lets go of the interpreter's lock.
        """
        postures = len(held.facets)
        pointers = [
            ctypes.c_void_p(array.ctypes.data) for array in (held.facets, held.walls, held.first)
        ]
        counts, places, target = (
            ctypes.c_void_p(array.ctypes.data) for array in (held.counts, directions, out)
        )

        def part(begin: int, end: int) -> None:
            self._function(
                pointers[0],
                ctypes.c_size_t(held.facets.shape[1]),
                pointers[1],
                ctypes.c_size_t(held.walls.shape[1]),
                *(pointers[2], counts, ctypes.c_size_t(begin), ctypes.c_size_t(end)),
                *(places, ctypes.c_size_t(len(directions)), target),
            )

        if threads == 1:
            part(0, postures)
            return
        cuts = [i * postures // threads for i in range(threads + 1)]
        list(self._pool.map(part, cuts[:-1], cuts[1:]))

    def three_metrics(
        self, axes: NDArray[np.float64], directions: NDArray[np.float64], out: NDArray[np.float64]
    ) -> None:
        """Fill `out` (3, g) as `numpy_reference.three_metrics`, for directions (g, 3)."""
        self._metrics(
            *(ctypes.c_void_p(axes.ctypes.data), ctypes.c_size_t(len(axes))),
            *(ctypes.c_void_p(directions.ctypes.data), ctypes.c_size_t(len(directions))),
            ctypes.c_void_p(out.ctypes.data),
        )

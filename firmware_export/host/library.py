"""The runtime's C code, built for this machine when lutgen was installed.

The library lies beside the C files and must have been built from them; see runtime/smap_host.c.
"""

import ctypes
import hashlib
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from lutgen.errors import ExportError

RUNTIME = Path(__file__).resolve().parent.parent / "runtime"
NAME = "_host.abi3.so"
WAY_OUT = (
    "install a C compiler, then lutgen again (in a checkout `python setup.py build_ext --inplace`)."
)


@cache
def load_library() -> ctypes.CDLL:
    """Return the library; ExportError is raised if it was not built, or from other files."""
    path = RUNTIME / NAME
    if not path.is_file():
        raise ExportError(
            f"{RUNTIME}: the C runtime was not built for this machine (got no file {NAME}"
            f"), so no export can be certified or read; {WAY_OUT}"
        )
    try:
        loaded = ctypes.CDLL(str(path))
    except OSError as error:
        raise ExportError(f"{path}: cannot be loaded (got {error}); {WAY_OUT}") from error
    loaded.smap_points_host_sources.restype = ctypes.c_char_p
    built = loaded.smap_points_host_sources().decode("ascii")
    # As setup.py computes it.
    files = sorted(RUNTIME.glob("*.[ch]"))
    if built != hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).hexdigest():
        raise ExportError(
            f"{path}: was built from other files than those beside it (got the digest "
            f"{built[:12]}); {WAY_OUT}"
        )
    return loaded


def call(name: str, *given: Any) -> int:
    """Call a function that returns a status, if anything; arrays are given by address."""
    passed = [
        ctypes.c_void_p(None if one is None else one.ctypes.data)
        if one is None or isinstance(one, np.ndarray)
        else one
        for one in given
    ]
    return ctypes.c_int8(getattr(load_library(), name)(*passed)).value

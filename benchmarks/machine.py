"""The machine and the versions that a run was made with."""

import os
import platform
from datetime import date
from pathlib import Path

import h5py
import numba
import numpy as np

from benchmarks.c_reference import COMMAND, compiler_version


def processor() -> str:
    """Return the processor's name as the system gives it."""
    try:
        for line in Path("/proc/cpuinfo").read_text("utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def machine() -> dict[str, str]:
    """Return what identifies a run: processor, cores, load, versions, flags of the C compiler."""
    return {
        "date": date.today().isoformat(),
        "processor": processor(),
        "cores": str(os.cpu_count()),
        "load average at the start": f"{os.getloadavg()[0]:.1f}",
        "system": f"{platform.system()} {platform.release()}",
        "Python": platform.python_version(),
        "NumPy": np.__version__,
        "numba": numba.__version__,
        "h5py": f"{h5py.__version__} (HDF5 {h5py.version.hdf5_version})",
        "C": f"{compiler_version()}, {' '.join(COMMAND[1:3])}",
    }

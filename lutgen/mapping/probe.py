"""A trial reading of a map by HDF5 in a process of its own: bad metadata can make it crash or loop.

Owns what that process does, and which heads need none: those that sweeps of this user laid out.
"""

import contextlib
import functools
import os
import subprocess
import sys
from pathlib import Path

import h5py

from lutgen.cache import cache_root, usable
from lutgen.errors import MapFileError
from lutgen.mapping.seal import Seal, seal_of

__all__ = ["remember", "require_readable"]

SECONDS, MEMORY = 10, 4 << 30
# It walks through all that `load_map` and reading a channel walk through.  What h5py raises is left
# to them: they raise it again, and say it in a sentence.
CODE = f"""
import sys
try:
    import h5py
except ImportError:
    sys.exit(0)
try:
    import resource
    resource.setrlimit(resource.RLIMIT_CPU, ({SECONDS}, {SECONDS}))
    resource.setrlimit(resource.RLIMIT_AS, ({MEMORY}, {MEMORY}))
except (ImportError, ValueError, OSError):
    pass


def walk(group, depth):
    for holder, names in ((group.attrs, list(group.attrs)), (group, list(group))):
        for name in names:
            try:
                if holder is group and not isinstance(group.get(name, getlink=True), h5py.HardLink):
                    continue
                found = holder[name]
                if isinstance(found, h5py.Group) and depth < 2:
                    walk(found, depth + 1)
                elif isinstance(found, h5py.Dataset):
                    dict(found.attrs)
                    if found.chunks:
                        found.id.chunk_iter(lambda info: None)
            except MemoryError:
                sys.exit(4)
            except Exception:
                pass


try:
    with h5py.File(sys.argv[1], "r") as file:
        walk(file, 0)
except MemoryError:
    sys.exit(4)
except Exception:
    pass
"""


def remember(head: bytes) -> None:
    """Note that a sealed head was laid out here."""
    folder, seal = _known(), seal_of(head)
    if folder is not None and seal is not None:
        # Where that fails it is tried at every reading, which takes a moment longer.
        with contextlib.suppress(OSError):
            (folder / seal.head).touch()


def require_readable(path: Path, seal: Seal | None) -> None:
    """Refuse a file that HDF5 cannot go through within `SECONDS`, or that would crash it.

    Raises
    ------
    MapFileError
        If it cannot.  Files of which HDF5 says itself what is wrong pass.
    """
    folder = _known()
    if seal is not None and folder is not None and (folder / seal.head).is_file():
        return
    if not sys.executable:
        return
    command = [sys.executable, "-P", "-c", CODE, str(path.absolute())]
    try:
        done = subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            timeout=SECONDS,
            check=False,
            # Of threads that multiply matrices each would take memory of its own.
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
        )
        found = {0: "", 4: f"more than {MEMORY >> 30} GiB of memory"}.get(
            done.returncode, f"HDF5 stopped by status {done.returncode}"
        )
    except subprocess.TimeoutExpired:
        found = f"no end within {SECONDS} s"
    except OSError:
        # No process can be started here.
        return
    if found:
        raise MapFileError(
            f"{path}: cannot be read as HDF5 (got {found} in a trial); the file is damaged or was "
            "made to do harm: sweep it again"
        )


@functools.cache
def _folder(root: Path) -> Path | None:
    """Return the folder of the heads that are known, which nobody else can write to."""
    folder = root / "heads" / h5py.version.hdf5_version
    return folder if usable(folder.parent) and usable(folder) else None


def _known() -> Path | None:
    return _folder(cache_root())

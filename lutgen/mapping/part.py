"""Write the unfinished file of a sweep: locked, filled in any order, finished under its name.

The digest of a block is the only record that it is done.  It is written after the values and counts
if they match it, in any order on the disk; so any kill or power cut can be resumed.
"""

import contextlib
import errno
import os
import shutil
import threading
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lutgen.errors import MapFileError, SweepError, reject
from lutgen.mapping.head import BLANK, DIGEST, SIGNATURE, Layout, lay_out, sealed

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

# Errors of a file system that has no locks at all (some clusters are mounted so).
NO_LOCKS = (errno.ENOSYS, errno.ENOLCK, errno.EOPNOTSUPP, errno.EINVAL)
_PLACING = threading.Lock()


def write_at(handle: int, data: memoryview, place: int) -> None:
    """Write bytes at a place in a file, however many calls the system takes for it."""
    while data:
        if hasattr(os, "pwrite"):
            count = os.pwrite(handle, data, place)
        else:
            with _PLACING:
                os.lseek(handle, place, os.SEEK_SET)
                count = os.write(handle, data)
        if count == 0:
            raise OSError(errno.EIO, "the system writes nothing")
        data, place = data[count:], place + count


def read_at(handle: int, size: int, place: int) -> bytes:
    """Read bytes at a place in a file; fewer at its end."""
    with _PLACING:
        os.lseek(handle, place, os.SEEK_SET)
        return os.read(handle, size)


def sync_folder(folder: Path) -> None:
    """Wait until a folder's entries are on the disk, where the system can do that."""
    with contextlib.suppress(PermissionError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


class PartFile:
    """The file ``NAME.part`` of one sweep; a context manager that holds its lock.

    `done` (blocks,) bool says which blocks are written.
    """

    def __init__(self, path: Path, layout: Layout) -> None:
        self.path, self.done, self._handle = path, np.zeros(layout.count, np.bool_), -1
        self.head = lay_out(layout, complete=False)
        self._whole = lay_out(layout, complete=True).data

    def __enter__(self) -> "PartFile":
        flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
        # The lock of a file that was renamed or removed meanwhile is worth nothing.
        while self._handle < 0:
            handle = os.open(self.path, flags, 0o666)
            try:
                self._lock(handle)
                with contextlib.suppress(FileNotFoundError):
                    if os.path.samestat(os.fstat(handle), self.path.stat()):
                        self._handle = handle
            finally:
                if self._handle != handle:
                    os.close(handle)
        return self

    def __exit__(self, *_: object) -> None:
        if self._handle >= 0:
            os.close(self._handle)

    def _lock(self, handle: int) -> None:
        """Lock the file; the lock goes with the process, however that ends."""
        if fcntl is None:
            return
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            what, got = "another sweep is writing this file", "a lock that is held"
            reject(self.path, what, got, "wait for it, or choose another output", SweepError)
        except OSError as error:
            if error.errno not in NO_LOCKS:
                raise

    def begun(self) -> bool:
        """Return True if the file holds anything: a layout that was cut short counts as nothing."""
        found = read_at(self._handle, len(SIGNATURE), 0)
        return found == SIGNATURE or not SIGNATURE.startswith(found.rstrip(b"\0"))

    def open(self, anew: bool) -> None:
        """Lay the file out, without values, or go on with it if it is this map's."""
        if not anew:
            self._require_same()
        self._require_space()
        if not anew:
            os.ftruncate(self._handle, self.head.layout.size)
            return
        if os.fstat(self._handle).st_size:
            # Some file systems write a file that was emptied when it is closed.
            os.ftruncate(self._handle, 0)
        os.ftruncate(self._handle, self.head.layout.size)
        data = memoryview(self.head.data)
        write_at(self._handle, data[len(SIGNATURE) :], len(SIGNATURE))
        os.fsync(self._handle)
        write_at(self._handle, data[: len(SIGNATURE)], 0)
        os.fsync(self._handle)
        sync_folder(self.path.parent)

    def _require_space(self) -> None:
        free = shutil.disk_usage(self.path.parent).free
        need = self.head.layout.size - getattr(os.fstat(self._handle), "st_blocks", 0) * 512
        if need > free:
            raise SweepError(
                f"{self.path}: the disk is too full for this map (got {free / 1e9:.2f} GB free, "
                f"the map needs {need / 1e9:.2f} GB more); free some space, choose another folder "
                "or fewer samples"
            )

    def _require_same(self) -> None:
        found, recipe = self._read_head(), self.head.layout.recipe
        start = self.head.data.index(BLANK.encode())
        # How far the sweep is may differ: the digests, the seal, and if it is complete.
        for ours in map(bytearray, (self.head.data, self._whole)):
            for state in (self.head.digests, slice(start, start + len(BLANK))):
                ours[state] = found[state]
            if ours == found:
                return
        if not found.startswith(SIGNATURE):
            what = "a file that is not HDF5"
        elif b"recipe_sha256" in found and recipe.digest.encode() not in found:
            what = f"one that belongs to another recipe than {recipe.source}"
        else:
            what = "other blocks, another version of lutgen or of HDF5, or a damaged head"
        raise MapFileError(
            f"{self.path}: cannot be resumed (got {what}); resume with what it was begun with, or "
            "remove it and sweep without --resume"
        )

    def _read_head(self) -> bytes:
        return read_at(self._handle, len(self.head.data), 0).ljust(len(self.head.data), b"\0")

    def find_done(self) -> Iterator[int]:
        """Read what is there and yield the number of every block that has its digests."""
        stored = self._read_head()[self.head.digests]
        size = DIGEST * len(self.head.layout.places)
        for number in range(self.done.size):
            wanted = stored[number * size : (number + 1) * size]
            if any(wanted) and self._digests_there(number) == wanted:
                self.done[number] = True
                yield number

    def _digests_there(self, number: int) -> bytes:
        """Return the digests of a block as it is in the file; none where it cannot be read."""
        layout, digests = self.head.layout, b""
        # A place that cannot be read can often be written again.
        with contextlib.suppress(OSError):
            for index in range(len(layout.places)):
                place, size = layout.span(index, number)
                digests += layout.digest(read_at(self._handle, size, place), index, number)
        return digests

    def write(self, number: int, values: Sequence[NDArray[Any]]) -> None:
        """Write the values of a block, one array for each channel, and then their digests."""
        layout, digests = self.head.layout, b""
        for index, array in enumerate(values):
            data = array.data.cast("B")
            write_at(self._handle, data, layout.span(index, number)[0])
            digests += layout.digest(data, index, number)
        place = self.head.digests.start + number * len(digests)
        write_at(self._handle, memoryview(digests), place)
        self.done[number] = True

    def finish(self, target: Path) -> None:
        """Seal the file and give it its name; every step is on the disk before the next."""
        os.fsync(self._handle)
        head = bytearray(self._whole)
        head[self.head.digests] = self._read_head()[self.head.digests]
        write_at(self._handle, memoryview(sealed(bytes(head), self.head.layout.size)), 0)
        os.fsync(self._handle)
        if fcntl is None:
            # Windows renames no file that is open.
            os.close(self._handle)
            self._handle = -1
        self.path.replace(target)
        sync_folder(target.parent)

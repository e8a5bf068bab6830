"""The unfinished file of a sweep: locked, filled in any order, and finished.

Owns what survives a kill or a power cut.  The checksum in each chunk is the only record of what is
done: one that was never written is 0, which is the checksum of nothing but zeros.  HDF5 never opens
the file while it is filled.
"""

import contextlib
import errno
import fcntl
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lutgen.errors import MapFileError, SweepError
from lutgen.mapping.checksum import own_sum, sum_of
from lutgen.mapping.layout import Skeleton
from lutgen.mapping.seal import sealed
from lutgen.recipe import Recipe

# The first bytes of an HDF5 file; in a part file they are written last.
SIGNATURE = b"\x89HDF\r\n\x1a\n"
# What a file system says that has no locks at all (some clusters are mounted so).
NO_LOCKS = (errno.ENOSYS, errno.ENOLCK, errno.EOPNOTSUPP, errno.EINVAL)


def write_all(handle: int, data: memoryview, place: int) -> None:
    """Write bytes at a place in a file, however many calls the system takes for it."""
    while data:
        count = os.pwrite(handle, data, place)
        if count == 0:
            raise OSError(errno.EIO, "the system writes nothing")
        data, place = data[count:], place + count


def write_chunks(handle: int, chunks: Iterable[NDArray[Any]], places: Iterable[int]) -> list[int]:
    """Write chunks, with checksums at their ends, at their places; return the checksums."""
    sums = []
    for chunk, place in zip(chunks, places, strict=True):
        write_all(handle, memoryview(chunk.data).cast("B"), int(place))
        sums.append(own_sum(chunk))
    return sums


def sync_folder(folder: Path) -> None:
    """Wait until a folder's entries are on the disk."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


class PartFile:
    """The file ``NAME.part`` of one sweep; a context manager that holds its lock.

    `handle` is its file descriptor, `sums` (channels, blocks) uint32 the checksums of the chunks
    that are written and `done` (blocks,) bool the blocks of which all channels are.
    """

    def __init__(self, path: Path, skeleton: Skeleton) -> None:
        self.path, self.skeleton = path, skeleton
        self.sums = np.zeros(skeleton.places.shape, np.uint32)
        self.done = np.zeros(skeleton.places.shape[1], np.bool_)
        self.handle = -1

    def __enter__(self) -> "PartFile":
        # Whoever has the lock of a file that was renamed or removed meanwhile has nothing.
        while self.handle < 0:
            handle = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666)
            try:
                self._lock(handle)
                with contextlib.suppress(FileNotFoundError):
                    if os.path.samestat(os.fstat(handle), self.path.stat()):
                        self.handle = handle
            finally:
                if self.handle != handle:
                    os.close(handle)
        return self

    def __exit__(self, *_: object) -> None:
        os.close(self.handle)

    def _lock(self, handle: int) -> None:
        """Lock the file; the lock goes with the process, however that ends."""
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise SweepError(
                f"{self.path}: another sweep is writing this file (got a lock that is held); "
                "wait for it, or choose another output"
            ) from None
        except OSError as error:
            if error.errno not in NO_LOCKS:
                raise

    def require_space(self) -> None:
        """Refuse to begin where the disk has not the room for the whole file."""
        disk = os.statvfs(self.path.parent)
        free = disk.f_bavail * disk.f_frsize
        need = self.skeleton.size - os.fstat(self.handle).st_blocks * 512
        if need > free:
            raise SweepError(
                f"{self.path}: the disk is too full for this map (got {free / 1e9:.2f} GB free, "
                f"the map needs {need / 1e9:.2f} GB more); free some space, choose another folder "
                "or fewer samples"
            )

    def begun(self) -> bool:
        """Return whether the file holds anything: a layout that was cut short counts as nothing."""
        found = os.pread(self.handle, len(SIGNATURE), 0)
        return found == SIGNATURE or not SIGNATURE.startswith(found.rstrip(b"\0"))

    def begin(self) -> None:
        """Lay the file out anew, without values."""
        head = memoryview(self.skeleton.head)
        os.ftruncate(self.handle, 0)
        os.ftruncate(self.handle, self.skeleton.size)
        write_all(self.handle, head[len(SIGNATURE) :], len(SIGNATURE))
        os.fsync(self.handle)
        write_all(self.handle, head[: len(SIGNATURE)], 0)
        os.fsync(self.handle)
        sync_folder(self.path.parent)

    def require_same(self, recipe: Recipe) -> None:
        """Refuse to go on with a file that was laid out for something else."""
        head = self._read_head()
        free = self.skeleton.state() | self.skeleton.values()
        differs = head != np.frombuffer(self.skeleton.head, np.uint8)
        if not differs[~free].any():
            return
        found = head.tobytes()
        if not found.startswith(SIGNATURE):
            what = "a file that is not HDF5"
        elif b"recipe_sha256" in found and recipe.digest.encode() not in found:
            raise MapFileError(
                f"{self.path}: belongs to another recipe than {recipe.source}; sweep without "
                "--resume to begin anew, or resume with the recipe it was begun with"
            )
        else:
            what = "other blocks, another version of lutgen or of HDF5, or a damaged head"
        raise MapFileError(
            f"{self.path}: cannot be resumed (got {what}); remove it and sweep without --resume"
        )

    def find_done(self) -> Iterator[int]:
        """Read what is there and yield the number of every block whose checksums hold."""
        # Whatever was cut off the file was not written.
        os.ftruncate(self.handle, self.skeleton.size)
        chunks = [np.empty(size, np.uint8) for size in self.skeleton.chunk_bytes]
        for number in range(self.done.size):
            for channel, place in enumerate(self.skeleton.places[:, number]):
                held = self._checksum(chunks[channel], int(place))
                self.sums[channel, number] = held
                if held == 0:
                    break
            else:
                self.done[number] = True
                yield number

    def _checksum(self, chunk: NDArray[np.uint8], place: int) -> int:
        """Read one chunk into a buffer; return its checksum, 0 where it does not hold."""
        raw = memoryview(chunk.data).cast("B")
        try:
            # Most chunks that were never written are told by these four bytes.
            last = os.pread(self.handle, 4, place + len(raw) - 4)
            if not any(last) or os.preadv(self.handle, [raw], place) != len(raw):
                return 0
        except OSError:
            # A place that cannot be read can often be written again.
            return 0
        own = own_sum(chunk)
        return own if own == sum_of(chunk) else 0

    def write(self, number: int, chunks: Iterable[NDArray[Any]]) -> None:
        """Write the chunks of one block, of all channels, and count it as done."""
        self.note(number, write_chunks(self.handle, chunks, self.skeleton.places[:, number]))

    def note(self, number: int, sums: Iterable[int]) -> None:
        """Count a block as done that was written, here or elsewhere, with these checksums."""
        self.sums[:, number] = list(sums)
        self.done[number] = True

    def leave(self) -> None:
        """Say in the head which blocks are done, for whoever looks into the unfinished file.

        Nothing relies on it; a disk that fails now has failed the sweep already.
        """
        with contextlib.suppress(OSError):
            os.fsync(self.handle)
            bits = np.packbits(self.done)
            write_all(self.handle, memoryview(bits.tobytes()), self.skeleton.bitmap.start)
            os.fsync(self.handle)

    def finish(self, target: Path) -> None:
        """Seal the file and give it its name; every step is on the disk before the next."""
        os.fsync(self.handle)
        head = np.frombuffer(self.skeleton.finished, np.uint8).copy()
        values = self.skeleton.values()
        head[values] = self._read_head()[values]
        whole = sealed(head.tobytes(), self.sums)
        changed = np.flatnonzero(self.skeleton.state())
        span = slice(int(changed[0]), int(changed[-1]) + 1)
        write_all(self.handle, memoryview(whole)[span], span.start)
        os.fsync(self.handle)
        self.path.replace(target)
        sync_folder(target.parent)

    def _read_head(self) -> NDArray[np.uint8]:
        """Return the head as it is in the file; zeros where the file is too short."""
        head = os.pread(self.handle, len(self.skeleton.head), 0)
        return np.frombuffer(head.ljust(len(self.skeleton.head), b"\0"), np.uint8)

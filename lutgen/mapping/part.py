"""The unfinished file of a sweep: locked, filled in any order, and finished.

Owns what survives a kill or a power cut.  The digest of each block is the only record of what is
done: written after the chunks, it counts if they have it, in whatever order the disk took the two.
HDF5 never opens the file while it is filled.
"""

import contextlib
import errno
import fcntl
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lutgen.errors import MapFileError, SweepError
from lutgen.mapping.identity import DIGEST, Identity
from lutgen.mapping.layout import Skeleton
from lutgen.mapping.probe import remember
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


def begin_writing(handle: int, place: int, size: int) -> None:
    """Have the system write a part of a file to the disk while the sweep goes on.

    At the end of a sweep all of it would be waited for.
    """
    if hasattr(os, "posix_fadvise"):
        with contextlib.suppress(OSError):
            os.posix_fadvise(handle, place, size, os.POSIX_FADV_DONTNEED)


def sync_folder(folder: Path) -> None:
    """Wait until a folder's entries are on the disk."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


class PartFile:
    """The file ``NAME.part`` of one sweep; a context manager that holds its lock.

    `handle` is its file descriptor, `identity` what its blocks belong to, and `done` (blocks,) bool
    says of which blocks all channels are written.
    """

    def __init__(self, path: Path, skeleton: Skeleton, identity: Identity) -> None:
        self.path, self.skeleton, self.identity = path, skeleton, identity
        self.done = np.zeros(skeleton.places.shape[1], np.bool_)
        self.handle = -1
        # It hands blocks to the disk, which takes as long as to compute them.
        self._disk = ThreadPoolExecutor(1)

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
        self._disk.shutdown(cancel_futures=True)
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
        if os.fstat(self.handle).st_size:
            # Not of a new file: some file systems write one that was emptied when it is closed.
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

    def clear_gaps(self) -> None:
        """Write zeros between head, chunks and end of the file: damage there has no checksum."""
        starts = np.sort(self.skeleton.places, axis=None)
        sizes = np.broadcast_to(self.skeleton.chunk_bytes[:, None], self.skeleton.places.shape)
        ends = np.sort(self.skeleton.places + sizes, axis=None)
        head = len(self.skeleton.head)
        begins = np.maximum(np.append(head, ends), head)
        counts = np.append(starts, self.skeleton.size) - begins
        for begin, count in zip(begins[counts > 0], counts[counts > 0], strict=True):
            if any(os.pread(self.handle, int(count), int(begin))):
                write_all(self.handle, memoryview(bytes(int(count))), int(begin))

    def find_done(self) -> Iterator[int]:
        """Read what is there and yield the number of every block that has its digest."""
        # Whatever was cut off the file was not written.
        os.ftruncate(self.handle, self.skeleton.size)
        chunks = [np.empty(size, np.uint8) for size in self.skeleton.chunk_bytes]
        size = DIGEST * len(chunks)
        held = self._read_head()[self.skeleton.digests].tobytes()
        for number in range(self.done.size):
            own = held[number * size : (number + 1) * size]
            digests = [own[i : i + DIGEST] for i in range(0, size, DIGEST)]
            if (
                all(map(any, digests))
                and self._read_chunks(chunks, number)
                and self.identity.holds(number, chunks, digests)
            ):
                self.done[number] = True
                yield number

    def _read_chunks(self, chunks: list[NDArray[np.uint8]], number: int) -> bool:
        """Read a block into buffers; return whether that can be done."""
        try:
            return all(
                os.preadv(self.handle, [memoryview(chunk.data)], int(place)) == chunk.size
                for chunk, place in zip(chunks, self.skeleton.places[:, number], strict=True)
            )
        except OSError:
            # A place that cannot be read can often be written again.
            return False

    def write(self, number: int, chunks: Sequence[NDArray[Any]]) -> None:
        """Seal and write the chunks of one block, of all channels, and count it as done."""
        digests = self.identity.seal(number, chunks)
        places = self.skeleton.places[:, number]
        for chunk, place in zip(chunks, places, strict=True):
            write_all(self.handle, memoryview(chunk.data).cast("B"), int(place))
            self._disk.submit(begin_writing, self.handle, int(place), chunk.nbytes)
        own = b"".join(digests)
        write_all(self.handle, memoryview(own), self.skeleton.digests.start + number * len(own))
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
        written = self.skeleton.values()
        written[self.skeleton.digests] = True
        head[written] = self._read_head()[written]
        whole = sealed(head.tobytes())
        changed = np.flatnonzero(self.skeleton.state())
        span = slice(int(changed[0]), int(changed[-1]) + 1)
        write_all(self.handle, memoryview(whole)[span], span.start)
        os.fsync(self.handle)
        remember(whole)
        self.path.replace(target)
        sync_folder(target.parent)

    def _read_head(self) -> NDArray[np.uint8]:
        """Return the head as it is in the file; zeros where the file is too short."""
        head = os.pread(self.handle, len(self.skeleton.head), 0)
        return np.frombuffer(head.ljust(len(self.skeleton.head), b"\0"), np.uint8)

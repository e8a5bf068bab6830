"""The sweep: every posture and direction of a recipe, computed block by block into a map file.

Owns the run: memory (one block per channel), progress, interruption and resumption.  Numbers come
from `scan`, the file from `store`.
"""

import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

import h5py
import numba
import numpy as np
from numpy.typing import NDArray

from lutgen.blocks import Block, Plan, plan
from lutgen.channels import CHANNELS
from lutgen.checksum import fletcher32
from lutgen.errors import InputError, MapFileError, SweepError
from lutgen.recipe import Recipe
from lutgen.scanner import Scanner
from lutgen.standing import require_standing
from lutgen.store import BITMAP, COMPLETE, chunk_places, create

# Parts per thread: a block's rows are not all equally dear, and small parts even that out.
PARTS_PER_THREAD = 8


class Computer:
    """Computes blocks of one recipe into buffers that it keeps."""

    def __init__(self, recipe: Recipe, layout: Plan) -> None:
        self.recipe = recipe
        self.nodes = recipe.chart.nodes
        self._scanner = Scanner(recipe, recipe.chart, recipe.channels)
        # One item more than the chunk, for its checksum.
        self._out = np.empty((len(CHANNELS), layout.chunk_nodes + 1), np.float32)

    def compute(self, block: Block) -> dict[str, NDArray[np.float32]]:
        """Return a chunk of each channel, (chunk nodes + 1,) with its checksum in the last item.

        The arrays are overwritten by the next call.  Past the end of the map a chunk is NaN.
        """
        first, last = block.first_row, block.last_row
        per_posture = self._scanner.rows
        begin, end = first // per_posture, -(-last // per_posture)
        held = (last - first) * self.nodes
        rows = first - begin * per_posture
        overflow = self._scanner.fill(
            self.recipe.grid.params(np.arange(begin, end)),
            rows,
            rows + last - first if end - begin == 1 else per_posture,
            numba.get_num_threads() * PARTS_PER_THREAD,
            self._out,
        )
        if overflow:
            raise SweepError(
                f"{self.recipe.source}: a posture of block {block.number} has more support facets "
                f"than {len(self.recipe.contact_names)} contacts can have (got {overflow} such "
                "postures); check the radii for overlapping spheres"
            )
        chunks = {}
        for name in self.recipe.channels:
            chunk = self._out[CHANNELS.index(name)]
            chunk[held:-1] = np.nan
            chunk[-1:].view(np.uint32)[0] = fletcher32(chunk[:-1].view(np.uint16))
            chunks[name] = chunk
        return chunks


def expected_seconds(recipe: Recipe) -> float:
    """Return how long the computing of a recipe's map takes here, from a piece of it."""
    piece = plan(recipe, 1 << 16)
    computer = Computer(recipe, piece)
    middle = next(b for b in piece.blocks() if b.number >= piece.count // 2)
    computer.compute(middle)
    start = time.perf_counter()
    computer.compute(middle)
    part = (middle.last_row - middle.first_row) * recipe.chart.nodes / piece.nodes
    return (time.perf_counter() - start) / part


def sweep(
    recipe: Recipe,
    path: str | os.PathLike[str],
    threads: int | None = None,
    resume: bool = False,
    engine: str = "local",
    progress: Callable[[int, int], None] | None = None,
) -> None:
    """Compute a recipe's map into an HDF5 file.

    Parameters
    ----------
    recipe : Recipe
        From `load_recipe`.
    path : path
        The file; it appears, whole, when the sweep is done.  Until then the work is in
        ``path.part``, which an interruption leaves behind for `resume`.
    threads : int, optional
        Threads to compute with; all of the machine's by default.  The values do not depend on it.
    resume : bool
        Go on with ``path.part`` of the same recipe, if there is one.
    engine : {"local"}
        Where the blocks are computed.
    progress : callable, optional
        Called with (nodes done, nodes of the map) after every block.

    Raises
    ------
    InputError
        For an unknown engine or an impossible number of threads.
    RecipeError
        If the robot stands nowhere.
    MapFileError
        If the unfinished file cannot be resumed.
    SweepError
        If the file cannot be written.
    """
    if engine != "local":
        raise InputError(f"unknown engine {engine!r}; this version has: local")
    most = numba.config.NUMBA_NUM_THREADS
    if threads is not None and not 1 <= threads <= most:
        raise InputError(f"threads must lie in 1..{most} on this machine (got {threads})")
    require_standing(recipe)
    target = Path(path)
    if not target.name or target.is_dir():
        raise SweepError(
            f"{target}: cannot be written (got the path of a folder); add a name such as map.h5"
        )
    if not target.parent.is_dir():
        raise SweepError(
            f"{target}: cannot be written (got the folder {target.parent}, which does not exist); "
            "make it first"
        )
    part = target.with_name(target.name + ".part")
    layout = plan(recipe)
    before = numba.get_num_threads()
    numba.set_num_threads(threads or most)
    try:
        places, done = _open_part(part, recipe, layout, resume)
        _fill(part, recipe, layout, places, done, progress)
        with h5py.File(part, "r+") as file:
            file.attrs[COMPLETE] = 1
            del file.attrs[BITMAP]
        _sync(part)
        part.replace(target)
        _sync(target.parent)
    except OSError as error:
        if isinstance(error, MapFileError):
            raise
        raise SweepError(
            f"{target}: cannot be written (got {error.strerror or error}); check the path, the "
            "permissions and the free space, then go on with `lutgen sweep --resume`"
        ) from error
    finally:
        numba.set_num_threads(before)


def _open_part(
    part: Path, recipe: Recipe, layout: Plan, resume: bool
) -> tuple[dict[str, NDArray[np.int64]], NDArray[np.bool_]]:
    """Make the unfinished file, or open one to go on with; return chunk places and blocks done."""
    if not (resume and part.exists()):
        part.unlink(missing_ok=True)
        try:
            return create(part, recipe, layout), np.zeros(layout.count, np.bool_)
        except BaseException:
            # A file that is not laid out yet cannot be resumed.
            part.unlink(missing_ok=True)
            raise
    try:
        with h5py.File(part, "r") as file:
            if file.attrs["recipe_sha256"] != recipe.digest:
                raise MapFileError(
                    f"{part}: belongs to another recipe than {recipe.source}; sweep without "
                    "--resume to begin anew, or resume with the recipe it was begun with"
                )
            bits = np.asarray(file.attrs[BITMAP], np.uint8)
            chunks = {file[name].chunks for name in recipe.channels}
            if chunks != {layout.chunk}:
                raise ValueError(f"chunks {chunks} instead of {layout.chunk}")
            places = {name: chunk_places(file[name], layout) for name in recipe.channels}
    except (OSError, KeyError, RuntimeError, ValueError) as error:
        if isinstance(error, MapFileError):
            raise
        raise MapFileError(
            f"{part}: cannot be resumed (got {error}); remove it and sweep without --resume"
        ) from error
    done = np.unpackbits(bits)[: layout.count].astype(np.bool_)
    return places, done


def _fill(
    part: Path,
    recipe: Recipe,
    layout: Plan,
    places: dict[str, NDArray[np.int64]],
    done: NDArray[np.bool_],
    progress: Callable[[int, int], None] | None,
) -> None:
    """Compute and write every block that is not done; note in the file what is, come what may."""
    computer = Computer(recipe, layout)
    width = recipe.chart.nodes
    finished = 0
    try:
        with part.open("r+b", buffering=0) as file:
            for block in layout.blocks():
                if not done[block.number]:
                    for name, chunk in computer.compute(block).items():
                        _write(file, chunk, int(places[name][block.number]))
                    done[block.number] = True
                finished += (block.last_row - block.first_row) * width
                if progress is not None:
                    progress(finished, layout.nodes)
    except BaseException:
        # The data must be on the disk before the file says that it is.
        _sync(part)
        with h5py.File(part, "r+") as file:
            file.attrs[BITMAP] = np.packbits(done)
        raise


def _write(file: BinaryIO, chunk: NDArray[np.float32], place: int) -> None:
    """Write a chunk at its place in the file, however many calls the system takes for it."""
    rest = memoryview(chunk.data).cast("B")
    while rest:
        count = os.pwrite(file.fileno(), rest, place)
        rest, place = rest[count:], place + count


def _sync(path: Path) -> None:
    """Wait until a file or a folder's entries are on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)

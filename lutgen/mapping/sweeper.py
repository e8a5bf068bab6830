"""Sweep a recipe: compute every posture and direction, block by block, into a map file."""

import os
import threading
from collections.abc import Callable, Generator
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import ExitStack, closing
from functools import partial
from itertools import chain
from pathlib import Path

import numba
import numpy as np

from lutgen import bounds
from lutgen.errors import InputError, MapFileError, SweepError, optional, reject
from lutgen.files import check_kind, check_target
from lutgen.mapping.compute import Computer, require_standing
from lutgen.mapping.head import plan
from lutgen.mapping.opening import load_map
from lutgen.mapping.part import PartFile
from lutgen.mapping.stability_map import StabilityMap
from lutgen.recipe import Recipe

ENGINES = ("local", "dask")
# So many blocks for each thread are enough for it to compute whole ones: the last may wait for one.
ENOUGH_BLOCKS = 4
# Blocks that are computed at a time, of 29 MB each where all channels are swept.
AT_A_TIME = 16
Engine = Callable[[PartFile], Generator[int, None, None]]


def sweep(
    recipe: Recipe,
    path: str | os.PathLike[str],
    threads: int | None = None,
    resume: bool = False,
    engine: str = "local",
    progress: Callable[[int, int], None] | None = None,
    scheduler: str | None = None,
    force: bool = False,
) -> StabilityMap:
    """Compute a recipe's map into an HDF5 file and open it.

    InputError is raised for options or a PATH that cannot be used, RecipeError if the robot stands
    nowhere, MapFileError if the unfinished file cannot be resumed, and SweepError if the file
    cannot be written, another sweep is writing it, or no worker is left.

    Parameters
    ----------
    recipe : Recipe
        From `load_recipe`.
    path : path
        The file; it appears, whole, when the sweep is done.  Until then the work is in
        PATH.part, which an interruption leaves behind for `resume`.
    threads : int, optional
        Threads to compute with; all of the machine's by default.  The values do not depend on it.
    resume : bool
        Go on with PATH.part of the same recipe, if there is one.  Blocks whose digests do not
        match are computed again, so it does not matter what stopped the sweep.
    engine : {"local", "dask"}
        Where the blocks are computed: threads of this process, or workers of dask.distributed.
        The file has the same bytes either way.
    progress : callable, optional
        Called with (nodes done, nodes of the map) after every block.
    scheduler : str, optional
        Address of a running scheduler (``tcp://host:8786``); without it one of this process, with
        one worker.
    force : bool
        Begin anew where PATH.part holds unfinished work, and replace files that lutgen did not
        make.  A link is refused even so.
    """
    most = numba.config.NUMBA_NUM_THREADS
    if engine not in ENGINES:
        raise InputError(f"unknown engine {engine!r}; this version has: {', '.join(ENGINES)}")
    if scheduler is not None and engine != "dask":
        raise InputError(f"scheduler needs the engine dask (got {scheduler} with {engine})")
    if recipe.function is not None and engine != "local":
        what = "a robot given by code is swept on this machine only"
        reject(recipe.source, what, f"the engine {engine}", "use the engine local", InputError)
    if threads is not None and not 1 <= threads <= most:
        raise InputError(f"threads must lie in 1..{most} on this machine (got {threads})")
    require_standing(recipe)
    target = Path(path)
    check_target(target, force)
    part = _part_of(target)
    before = numba.get_num_threads()
    numba.set_num_threads(threads or most)
    try:
        layout = plan(recipe)
        bounds.check(layout.count, bounds.BLOCKS, recipe.source, "use fewer samples")
        with ExitStack() as stack:
            compute: Engine = _compute_here
            if engine == "dask":
                name, way_out = "lutgen.mapping.dask", "use the engine local"
                there = optional("--engine dask", name, "lutgen[cluster]", way_out)
                # Before there is a file: without a scheduler none is left behind.
                client = stack.enter_context(there.connected(scheduler))
                compute = partial(there.compute_there, client=client, threads=threads)
            file = stack.enter_context(PartFile(part, layout))
            _open(file, resume, force)
            finished, blocks = 0, stack.enter_context(closing(compute(file)))
            for number in chain(file.find_done(), blocks):
                block = layout.block(number)
                finished += (block.last - block.first) * layout.shape[-1]
                if progress is not None:
                    progress(finished, recipe.nodes)
            # It may be hours since that was checked.
            check_target(target, force)
            file.finish(target)
    except OSError as error:
        if isinstance(error, MapFileError):
            raise
        # A sweep that did not begin leaves no file behind.
        on = ", then go on with `lutgen sweep --resume`" if part.exists() else ""
        what = "cannot be written"
        way_out = f"check the path, the permissions and the free space{on}"
        reject(target, what, error.strerror or error, way_out, SweepError)
    finally:
        numba.set_num_threads(before)
    return load_map(target)


def _part_of(target: Path) -> Path:
    """Return the path of the unfinished file; refuse what cannot or must not be written."""
    if not target.name or target.is_dir():
        what = "cannot be written"
        reject(target, what, "the path of a folder", "add a name such as map.h5", InputError)
    if not target.parent.is_dir():
        what, got = "cannot be written", f"the folder {target.parent}, which does not exist"
        reject(target, what, got, "make it first", InputError)
    part = target.with_name(target.name + ".part")
    check_kind(part)
    return part


def _open(file: PartFile, resume: bool, force: bool) -> None:
    """Lay out the unfinished file, or check one to go on with.

    Work without `resume` or `force`, and a file that lutgen did not make, are left alone.
    """
    begun = file.begun()
    if begun and not resume and not force:
        check_target(file.path)
        what, got = "holds the unfinished work of a sweep", "neither --resume nor --force"
        reject(file.path, what, got, "go on with --resume, or begin anew with --force", InputError)
    try:
        file.open(anew=not (resume and begun))
    except BaseException:
        # A file that is not laid out yet is of no use.
        if not file.begun():
            file.path.unlink(missing_ok=True)
        raise


def _compute_here(file: PartFile) -> Generator[int, None, None]:
    """Compute and write every block that is not done; yield its number.

    All threads compute the first block: what is not compiled yet is compiled in this one, which
    Ctrl-C reaches.  Then, if there are enough, each thread takes whole blocks.
    """
    layout, todo = file.head.layout, np.flatnonzero(~file.done).tolist()
    threads = numba.get_num_threads()
    # A robot given by code is called by one thread, as its author expects.
    enough = layout.recipe.function is None and len(todo) > ENOUGH_BLOCKS * threads
    workers = min(threads, AT_A_TIME) if enough else 1
    own = threading.local()

    def work(number: int) -> int:
        if not hasattr(own, "computer"):
            own.computer = Computer(layout)
        file.write(number, own.computer.compute(layout.block(number)))
        return number

    alone = 1 if workers > 1 else len(todo)
    yield from map(work, todo[:alone])
    pool = ThreadPoolExecutor(
        workers, initializer=numba.set_num_threads, initargs=(threads // workers,)
    )
    try:
        for future in as_completed([pool.submit(work, number) for number in todo[alone:]]):
            yield future.result()
    finally:
        # Blocks that are being computed are waited for and not lost.
        pool.shutdown(cancel_futures=True)

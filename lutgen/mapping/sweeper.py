"""The sweep: every posture and direction of a recipe, computed block by block into a map file.

Owns the run: which blocks are still to be computed, where, progress, interruption and resumption.
Numbers come from `compute`, the file from `part`.
"""

import contextlib
import os
from collections import deque
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, closing
from functools import partial
from itertools import chain
from pathlib import Path
from queue import SimpleQueue
from threading import Semaphore

import numba
import numpy as np

from lutgen import bounds
from lutgen.errors import InputError, MapFileError, SweepError
from lutgen.files import check_kind, check_target, is_ours
from lutgen.mapping.blocks import Plan, plan
from lutgen.mapping.compute import Computer, require_standing
from lutgen.mapping.layout import lay_out
from lutgen.mapping.part import PartFile
from lutgen.mapping.template import identity_of
from lutgen.recipe import Recipe

ENGINES = ("local", "dask")
# So many blocks for each thread are enough for it to compute whole ones: the last may wait for one.
ENOUGH_BLOCKS = 4
# Blocks that are computed at a time, of 29 MB each where all channels are swept.
AT_A_TIME = 16


def sweep(
    recipe: Recipe,
    path: str | os.PathLike[str],
    threads: int | None = None,
    resume: bool = False,
    engine: str = "local",
    progress: Callable[[int, int], None] | None = None,
    scheduler: str | None = None,
    force: bool = False,
) -> None:
    """Compute a recipe's map into an HDF5 file.

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
        Go on with PATH.part of the same recipe, if there is one.  Blocks whose checksums do not
        hold are computed again, so it does not matter what stopped the sweep.
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

    Raises
    ------
    InputError
        For an unknown engine, an impossible number of threads, or a robot given by
        code with an engine other than "local"; where PATH is a folder or in one that is not there,
        or where PATH or PATH.part is a file that lutgen did not make, or holds work that neither
        `resume` nor `force` is said of.
    RecipeError
        If the robot stands nowhere.
    MapFileError
        If the unfinished file cannot be resumed.
    SweepError
        If the file cannot be written, the disk is too full, another sweep is writing the same
        file, or no worker is left.
    """
    _require_options(recipe, engine, scheduler)
    most = numba.config.NUMBA_NUM_THREADS
    if threads is not None and not 1 <= threads <= most:
        raise InputError(f"threads must lie in 1..{most} on this machine (got {threads})")
    require_standing(recipe)
    target = Path(path)
    if not target.name or target.is_dir():
        raise InputError(
            f"{target}: cannot be written (got the path of a folder); add a name such as map.h5"
        )
    if not target.parent.is_dir():
        raise InputError(
            f"{target}: cannot be written (got the folder {target.parent}, which does not exist); "
            "make it first"
        )
    part = target.with_name(target.name + ".part")
    check_target(target, force)
    check_kind(part)
    if force:
        _clear_part(part)
    before = numba.get_num_threads()
    numba.set_num_threads(threads or most)
    try:
        layout = plan(recipe)
        bounds.check(layout.count, bounds.BLOCKS, recipe.source, "use fewer samples")
        with ExitStack() as stack:
            compute: Callable[[PartFile], Generator[int, None, None]]
            if engine == "local":
                compute = partial(_compute_here, recipe=recipe, layout=layout)
            else:
                try:
                    from lutgen.mapping.dask import compute_there, connected
                except ImportError as error:
                    raise InputError(
                        f"the engine dask needs more packages (got {error}); install "
                        "lutgen[cluster], or use the engine local"
                    ) from error
                # Before there is a file: without a scheduler none is left behind.
                client = stack.enter_context(connected(scheduler))
                compute = partial(
                    compute_there, recipe=recipe, layout=layout, client=client, threads=threads
                )
            identity = identity_of(recipe, layout)
            file = stack.enter_context(PartFile(part, lay_out(recipe, layout), identity))
            _open(file, recipe, resume, force)
            _fill(file, recipe, layout, compute(file), progress)
            # It may be hours since that was asked.
            check_target(target, force)
            file.finish(target)
    except OSError as error:
        if isinstance(error, MapFileError):
            raise
        # Where nothing was begun no file is left behind.
        on = ", then go on with `lutgen sweep --resume`" if part.exists() else ""
        raise SweepError(
            f"{target}: cannot be written (got {error.strerror or error}); check the path, the "
            f"permissions and the free space{on}"
        ) from error
    finally:
        numba.set_num_threads(before)


def _require_options(recipe: Recipe, engine: str, scheduler: str | None) -> None:
    """Refuse engines that do not exist and options that they do not have."""
    if engine not in ENGINES:
        raise InputError(f"unknown engine {engine!r}; this version has: {', '.join(ENGINES)}")
    if scheduler is not None and engine != "dask":
        raise InputError(f"scheduler needs the engine dask (got {scheduler} with {engine})")
    if recipe.function is not None and engine != "local":
        raise InputError(
            f"{recipe.source}: a robot given by code is swept on this machine only (got the "
            f"engine {engine}); use the engine local"
        )


def _clear_part(part: Path) -> None:
    """Remove an unfinished file that is none of ours: to empty it might empty its other names.

    One that another sweep is just laying out begins with zeros.
    """
    with contextlib.suppress(FileNotFoundError):
        with part.open("rb") as file:
            begun = any(file.read(1))
        if begun and not is_ours(part):
            part.unlink()


def _open(file: PartFile, recipe: Recipe, resume: bool, force: bool) -> None:
    """Lay out the unfinished file, or check one to go on with.

    Work that neither `resume` nor `force` is said of, and a file of somebody else, is left alone.
    """
    if file.begun() and not resume and not force:
        check_target(file.path)
        raise InputError(
            f"{file.path}: holds the unfinished work of a sweep (got neither --resume nor "
            "--force); go on with --resume, or begin anew with --force."
        )
    go_on = resume and file.begun()
    try:
        if go_on:
            file.require_same(recipe)
        file.require_space()
        if go_on:
            file.clear_gaps()
        else:
            file.begin()
    except BaseException:
        # A file that is not laid out yet is of no use.
        if not file.begun():
            file.path.unlink(missing_ok=True)
        raise


def _compute_here(file: PartFile, recipe: Recipe, layout: Plan) -> Generator[int, None, None]:
    """Compute and write every block that is not done; yield its number.

    All threads compute the first block: what is not compiled yet is compiled in this one, which
    Ctrl-C reaches.  Then, where there are enough, each takes whole blocks (of many threads a few
    together).
    """
    todo = np.flatnonzero(~file.done).tolist()
    threads = numba.get_num_threads()
    # A robot given by code is asked by one thread, as its author expects.
    enough = recipe.function is None and len(todo) > ENOUGH_BLOCKS * threads
    workers = min(threads, AT_A_TIME) if enough else 1
    alone = len(todo) if workers == 1 else 1
    computer = Computer(recipe, layout)
    for number in todo[:alone]:
        file.write(number, list(computer.compute(layout.block(number)).values()))
        yield number
    if workers > 1:
        computers = [computer, *(Computer(recipe, layout) for _ in range(workers - 1))]
        yield from _compute_side_by_side(file, layout, computers, todo[alone:])


def _compute_side_by_side(
    file: PartFile, layout: Plan, computers: list[Computer], todo: list[int]
) -> Generator[int, None, None]:
    """Compute and write blocks, a thread for each computer; yield their numbers in order."""
    threads = numba.get_num_threads() // len(computers)
    idle: SimpleQueue[Computer] = SimpleQueue()
    for computer in computers:
        idle.put(computer)
    stopped = False
    may_write = Semaphore(len(computers))

    def work(number: int) -> None:
        numba.set_num_threads(threads)
        computer = idle.get()
        try:
            chunks = list(computer.compute(layout.block(number)).values())
            with may_write:
                if not stopped:
                    file.write(number, chunks)
        finally:
            idle.put(computer)

    pool = ThreadPoolExecutor(len(computers))
    begun: deque[tuple[int, Future[None]]] = deque()
    try:
        for number in todo:
            begun.append((number, pool.submit(work, number)))
            # Each thread has a block that waits for it.
            yield from _ended(begun, 2 * len(computers))
        yield from _ended(begun, 0)
    finally:
        # Ctrl-C waits for what is being written, not for what is being computed.
        stopped = True
        for _ in computers:
            may_write.acquire()
        may_write.release(len(computers))
        pool.shutdown(wait=False, cancel_futures=True)


def _ended(begun: deque[tuple[int, "Future[None]"]], most: int) -> Iterator[int]:
    """Wait for the oldest blocks until at most so many are left; yield their numbers."""
    while len(begun) > most:
        number, future = begun.popleft()
        future.result()
        yield number


def _fill(
    file: PartFile,
    recipe: Recipe,
    layout: Plan,
    blocks: Generator[int, None, None],
    progress: Callable[[int, int], None] | None,
) -> None:
    """Fill the file; say in it what is done, should anything stop that."""
    finished = 0
    try:
        with closing(blocks):
            for number in chain(file.find_done(), blocks):
                block = layout.block(number)
                finished += (block.last_row - block.first_row) * recipe.chart.nodes
                if progress is not None:
                    progress(finished, layout.nodes)
    except BaseException:
        file.leave()
        raise

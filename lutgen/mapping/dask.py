"""Compute blocks by workers of dask.distributed; this process writes them.

The recipe travels there with the numbers of blocks, the values come back.
"""

import logging
import threading
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from functools import lru_cache
from itertools import islice
from typing import Any

import dask
import distributed
import numba
import numpy as np
from numpy.typing import NDArray

from lutgen._version import __version__
from lutgen.errors import InputError, LutgenError, SweepError
from lutgen.mapping.compute import Computer
from lutgen.mapping.head import Layout
from lutgen.mapping.part import PartFile

# Blocks that are out at a time for each worker: one to compute, one to go on with.
AHEAD = 2
# Seconds within which a scheduler must answer, and a worker be there.
REACH, PATIENCE = 10.0, 60.0
# One block at a time in a worker: numba's threads are started by one thread.
_LOCK = threading.Lock()
# Without a scheduler: one worker inside this process, which no port leads to.  The web servers that
# dask starts even so are on loopback, without pages.
LOOPBACK = "127.0.0.1:0"
INSIDE: dict[str, Any] = {"processes": False, "n_workers": 1, "memory_limit": 0}
INSIDE |= {"dashboard_address": LOOPBACK, "worker_dashboard_address": LOOPBACK}
NO_PAGES: dict[str, Any] = {f"distributed.{who}.http.routes": [] for who in ("scheduler", "worker")}


# What computes the blocks of a sweep is made once in each worker.
computer_of = lru_cache(maxsize=1)(Computer)


def compute_block(
    number: int, layout: Layout, threads: int | None
) -> tuple[int, list[NDArray[Any]]]:
    """Compute a block on a worker; return its number and the values of each channel."""
    with _LOCK:
        own = threads or distributed.get_worker().state.nthreads
        numba.set_num_threads(max(1, min(own, numba.config.NUMBA_NUM_THREADS)))
        values = computer_of(layout).compute(layout.block(number))
        return number, [array.copy() for array in values]


def compute_there(file: PartFile, client: Any, threads: int | None) -> Generator[int, None, None]:
    """Compute every block that is not done on workers; yield its number when it is written.

    `threads` are those of each worker, all that it has by default.
    """
    todo = iter(np.flatnonzero(~file.done).tolist())
    facts = {"layout": file.head.layout, "threads": threads}

    def send(count: int) -> set[Any]:
        return set(client.map(compute_block, list(islice(todo, count)), pure=False, **facts))

    with _as_sweep_error():
        waiting = send(AHEAD * _require_workers(client))
    while waiting:
        with _as_sweep_error():
            try:
                done = distributed.wait(waiting, PATIENCE, "FIRST_COMPLETED").done
            except TimeoutError:
                _require_workers(client)
                continue
            results = [future.result() for future in done]
        for number, values in results:
            file.write(number, values)
            yield number
        with _as_sweep_error():
            waiting = (waiting - done) | send(len(done))


@contextmanager
def _as_sweep_error() -> Iterator[None]:
    """Turn any fault between this process, the scheduler and workers into a sentence."""
    try:
        yield
    except LutgenError:
        raise
    except Exception as error:
        said = " ".join(f"{type(error).__name__}: {error}".split())
        raise SweepError(
            f"the scheduler or a worker failed (got {said}); see its log, start it again, then go "
            "on with `lutgen sweep --resume`"
        ) from error


def _require_workers(client: Any) -> int:
    client.wait_for_workers(1, timeout=PATIENCE)
    versions = client.run(_version)
    if others := set(versions.values()) - {_version()}:
        raise SweepError(
            f"workers run other versions of lutgen and numba (got {sorted(others)}, here "
            f"{_version()}); install the same ones everywhere"
        )
    return len(versions)


def _version() -> tuple[str, str]:
    return __version__, numba.__version__


@contextmanager
def connected(scheduler: str | None) -> Iterator[Any]:
    """Connect to a scheduler; without an address to one inside this process, with one worker."""
    # They log tracebacks of what is said here in a sentence.
    for name in ("distributed.client", "distributed.comm.core"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        with dask.config.set(NO_PAGES):
            client = distributed.Client(scheduler, timeout=REACH, **({} if scheduler else INSIDE))
    except (OSError, ValueError, TypeError, RuntimeError) as error:
        raise InputError(
            f"the scheduler {scheduler} cannot be reached (got {error!r}); start one with `dask "
            "scheduler` and give its address as tcp://HOST:8786"
        ) from error
    with client:
        yield client

"""Blocks computed by workers of dask.distributed.

Owns what travels: the recipe (and its URDF) as text and numbers of blocks there, digests back.  A
worker that finds the token that this sweep wrote beside the map writes its blocks itself; any other
sends them back, and they are written here.
"""

import importlib.util
import logging
import os
import secrets
import socket
import threading
from collections.abc import Generator, Iterator
from contextlib import ExitStack, contextmanager
from functools import lru_cache
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from lutgen._version import __version__
from lutgen.errors import InputError, LutgenError, SweepError
from lutgen.mapping.blocks import Plan
from lutgen.mapping.compute import Computer
from lutgen.mapping.identity import Identity
from lutgen.mapping.part import PartFile, write_chunks
from lutgen.recipe import Recipe, parse_recipe

if TYPE_CHECKING:
    import distributed

# A task computes up to so many blocks, of 1 M nodes each: half a second of work or more, against
# ten milliseconds that a task costs.  What is sent back is one block, for the memory's sake.
BATCH = 64
# So many tasks per worker at least, so that all end at about the same time.
TASKS_PER_WORKER = 8
# Tasks that are sent out at a time per worker: one to compute, one to go on with.
AHEAD = 2
# Seconds within which a scheduler must answer.
REACH = 10.0
# Seconds without any worker after which a sweep gives up.
PATIENCE = 60.0
# numba's threads are started by one thread of a worker at a time.
_LOCK = threading.Lock()


class Job(NamedTuple):
    """What a worker has to know of a sweep, apart from the blocks."""

    text: str
    urdf: str | None
    source: str
    layout: Plan
    identity: Identity
    part: str
    token: str
    host: str
    threads: int | None


class Result(NamedTuple):
    """One block: its digests, and its chunks, one for each channel, if they came back."""

    number: int
    digests: list[bytes]
    chunks: list[NDArray[Any]] | None


def token_path(part: Path) -> Path:
    """Return where a sweep leaves its token."""
    return part.with_name(f".{part.name}.token")


def sees(part: Path, token: str) -> bool:
    """Return whether this process sees the file that the sweep with that token is writing."""
    try:
        return token_path(part).read_text("ascii") == token
    except (OSError, ValueError):
        return False


@lru_cache(maxsize=1)
def _computer(text: str, urdf: str | None, source: str, layout: Plan) -> Computer:
    return Computer(parse_recipe(text, source, urdf=urdf), layout)


def compute_batch(job: Job, numbers: list[int], places: NDArray[np.int64]) -> list[Result]:
    """Compute blocks on a worker, and write them if it sees the file.

    `places` (channels, len(numbers)) are where their chunks go, in bytes.
    """
    results = []
    part = Path(job.part)
    with _LOCK, ExitStack() as stack:
        numba.set_num_threads(_threads(job.threads))
        computer = _computer(job.text, job.urdf, job.source, job.layout)
        handle = -1
        for column, number in enumerate(numbers):
            chunks = list(computer.compute(job.layout.block(number)).values())
            digests = job.identity.seal(number, chunks)
            # Asked before every block: a sweep that was killed and begun anew has another token.
            if not sees(part, job.token):
                results.append(Result(number, digests, [chunk.copy() for chunk in chunks]))
                # Memory for one block only; the caller asks for the others again.
                break
            if handle < 0:
                # Never read through this handle: network file systems would then write whole
                # pages, with a neighbour's bytes in them.
                handle = os.open(part, os.O_WRONLY)
                stack.callback(os.close, handle)
            write_chunks(handle, chunks, places[:, column])
            results.append(Result(number, digests, None))
        if handle >= 0 and socket.gethostname() != job.host:
            os.fsync(handle)
    return results


def _threads(wanted: int | None) -> int:
    """Return how many threads a task may use: those that dask gave to the worker."""
    from distributed import get_worker

    own = wanted or get_worker().state.nthreads
    most: int = numba.config.NUMBA_NUM_THREADS
    return max(1, min(int(own), most))


def compute_there(
    file: PartFile,
    recipe: Recipe,
    layout: Plan,
    client: "distributed.Client",
    threads: int | None,
) -> Generator[int, None, None]:
    """Compute every block that is not done on workers; yield its number when it is written.

    The recipe is not one that is given by code.  `threads` are those of each worker, all that it
    has by default.  SweepError is raised where no worker is left, or a task cannot be done
    anywhere.
    """
    job = Job(
        recipe.text,
        recipe.urdf,
        recipe.source,
        layout,
        file.identity,
        str(file.path.resolve()),
        secrets.token_hex(16),
        socket.gethostname(),
        threads,
    )
    with _token(job):
        with _as_sweep_error():
            count = _wait_for_workers(client)
            shared = _probe(client, job)
        todo = [number for number in range(layout.count) if not file.done[number]]
        batch = max(1, min(BATCH, len(todo) // (TASKS_PER_WORKER * count))) if shared else 1
        batches = iter([todo[i : i + batch] for i in range(0, len(todo), batch)])

        def submit(numbers: list[int]) -> Any:
            places = file.skeleton.places[:, numbers]
            return client.submit(compute_batch, job, numbers, places, pure=False)

        with _as_sweep_error():
            asked = {submit(numbers): numbers for numbers in islice(batches, AHEAD * count)}
        while asked:
            with _as_sweep_error():
                ready = _some_that_are_done(client, list(asked))
            for future in ready:
                remaining = set(asked.pop(future))
                for result in _result(future):
                    if result.chunks is None:
                        file.note(result.number, result.digests)
                    else:
                        file.write(result.number, result.chunks)
                    remaining.discard(result.number)
                    yield result.number
                following = sorted(remaining) or next(batches, [])
                with _as_sweep_error():
                    future.release()
                    if following:
                        asked[submit(following)] = following


def _some_that_are_done(client: Any, futures: list[Any]) -> set[Any]:
    """Wait until tasks are done, as long as there are workers to do them."""
    import distributed

    while True:
        try:
            done: set[Any] = distributed.wait(futures, PATIENCE, "FIRST_COMPLETED").done
        except TimeoutError:
            _wait_for_workers(client)
        else:
            return done


@contextmanager
def _as_sweep_error() -> Iterator[None]:
    """Turn whatever goes wrong between this process and the scheduler into a sentence."""
    try:
        yield
    except LutgenError:
        raise
    except Exception as error:
        raise SweepError(
            f"the scheduler does not answer any more (got {_first_line(error)}); start it again, "
            "then go on with `lutgen sweep --resume`"
        ) from error


def _first_line(error: Exception) -> str:
    """Return an error's name and the first line of what it says."""
    return " ".join(f"{type(error).__name__}: {error}".splitlines()[:1])


def _result(future: Any) -> list[Result]:
    """Return what a task returned; what it raised becomes a sentence."""
    from distributed.comm import CommClosedError

    try:
        results: list[Result] = future.result()
    except CommClosedError:
        with _as_sweep_error():
            raise
    except (LutgenError, OSError):
        # Of the task itself: the caller has sentences for those.
        raise
    except Exception as error:
        raise SweepError(
            f"a worker could not compute its blocks (got {_first_line(error)}); see its log, then "
            "go on with `lutgen sweep --resume`"
        ) from error
    return results


@contextmanager
def connected(
    scheduler: str | None, workers: int | None, threads: int | None
) -> Iterator["distributed.Client"]:
    """Connect to a scheduler, or start workers for the time of the sweep.

    So many workers are started on this machine, one per core by default; `threads` are those of
    all of them together.  InputError is raised where distributed is not installed or the scheduler
    cannot be reached.
    """
    _require_packages(scheduler)
    import distributed

    with ExitStack() as stack:
        # They log tracebacks of what is said here in a sentence.
        for name in ("distributed.client", "distributed.comm.core"):
            log = logging.getLogger(name)
            stack.callback(log.setLevel, log.level)
            log.setLevel(logging.CRITICAL)
        try:
            if scheduler is None:
                address, security = stack.enter_context(_own_cluster(workers, threads))
            else:
                address, security = scheduler, None
            client = stack.enter_context(
                distributed.Client(address, timeout=REACH, security=security)
            )
        except (OSError, ValueError, TypeError, RuntimeError) as error:
            raise InputError(
                f"the scheduler {scheduler or 'of this machine'} cannot be reached (got "
                f"{_first_line(error)}); {_way_out(scheduler)}"
            ) from error
        yield client


def _require_packages(scheduler: str | None) -> None:
    """Refuse to begin without what the engine needs; a cluster of our own has credentials."""
    needed = ("distributed",) if scheduler else ("distributed", "cryptography")
    for name in needed:
        if importlib.util.find_spec(name) is None:
            raise InputError(
                f"the engine dask needs the package {name} (got none); install lutgen[cluster], "
                "or use the engine local"
            )


def _way_out(scheduler: str | None) -> str:
    """Return what to do about a scheduler that cannot be reached."""
    if scheduler is not None and scheduler.startswith("tls://"):
        return (
            "for tls:// name the certificates in dask's own settings (distributed.comm.tls: "
            "ca-file, client.cert, client.key; or DASK_DISTRIBUTED__COMM__TLS__CA_FILE and so on)"
        )
    return "start one with `dask scheduler` and give its address as tcp://HOST:8786"


@contextmanager
def _own_cluster(workers: int | None, threads: int | None) -> Iterator[tuple[Any, Any]]:
    """Start workers that nobody else on this machine can reach; yield them and their credentials.

    The certificate that all of them share is made for this one sweep and kept in memory.  Dask
    starts a web server in each process whatever it is told: on loopback, without any page.
    """
    import dask
    import distributed
    from distributed.security import Security

    cores = threads or numba.config.NUMBA_NUM_THREADS
    count = workers or cores
    security = Security.temporary()
    bare: dict[str, list[str]] = {
        f"distributed.{who}.http.routes": [] for who in ("scheduler", "worker")
    }
    with (
        dask.config.set(bare),
        distributed.LocalCluster(
            n_workers=count,
            threads_per_worker=max(1, cores // count),
            memory_limit=0,
            host="127.0.0.1",
            security=security,
            dashboard_address=None,
            scheduler_kwargs={"dashboard": False, "dashboard_address": "127.0.0.1:0"},
            silence_logs="CRITICAL",
        ) as cluster,
    ):
        yield cluster, security


@contextmanager
def _token(job: Job) -> Iterator[None]:
    """Leave the token beside the map while the sweep runs."""
    path = token_path(Path(job.part))
    path.write_text(job.token, "ascii")
    try:
        yield
    finally:
        path.unlink(missing_ok=True)


def _wait_for_workers(client: Any) -> int:
    """Return the number of workers; give up after a minute without any."""
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError:
        raise SweepError(
            f"no worker is there (got none within {PATIENCE:g} s); start some with `dask worker "
            "ADDRESS`, then go on with `lutgen sweep --resume`"
        ) from None
    return len(client.scheduler_info(n_workers=-1)["workers"])


def _version() -> tuple[str, str]:
    """Return what has to be the same everywhere for the same bits."""
    return __version__, numba.__version__


def _probe(client: Any, job: Job) -> bool:
    """Return whether all workers see the file; refuse those of another version."""
    try:
        seen = client.run(sees, Path(job.part), job.token)
        versions = set(client.run(_version).values())
    except Exception as error:
        raise SweepError(
            f"a worker cannot run lutgen (got {_first_line(error)}); install lutgen {__version__} "
            "for all workers"
        ) from error
    if versions - {_version()}:
        raise SweepError(
            f"workers run other versions of lutgen and numba (got {sorted(versions)}, here "
            f"{_version()}); install the same ones everywhere"
        )
    return all(seen.values())

"""The engines: whoever computes the blocks, the file has the same bytes."""

import os
import resource
import shutil
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from distributed import Client, LocalCluster

import lutgen
from lutgen.errors import InputError, RecipeError, SweepError
from lutgen.mapping import dask as engine_dask
from lutgen.mapping import sweeper
from lutgen.mapping.blocks import plan
from lutgen.mapping.compute import Computer
from lutgen.mapping.layout import lay_out
from lutgen.mapping.part import PartFile
from lutgen.mapping.verification import verify
from tests.fixtures.documents import blocks
from tests.fixtures.places import ROOT
from tests.fixtures.recipes import rigid, sweep_part, tripod

# 54 postures of 11 x 11 nodes in 27 blocks, two channels.
RECIPE = lutgen.parse_recipe(tripod("reach = 9, swing = 6", nodes=11))
SIZE, BLOCKS = 242, 27


@pytest.fixture(autouse=True)
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut every sweep into blocks of 242 nodes, several of which make a task."""
    monkeypatch.setattr(sweeper, "plan", lambda recipe: plan(recipe, SIZE))
    assert plan(RECIPE, SIZE).count == BLOCKS


@pytest.fixture(scope="module")
def cluster() -> Iterator[LocalCluster]:
    """Return a cluster of one worker to begin with."""
    with LocalCluster(
        n_workers=1,
        threads_per_worker=1,
        memory_limit=0,
        dashboard_address=":0",
        silence_logs="CRITICAL",
    ) as cluster:
        yield cluster


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Return the file that this process computes with one thread."""
    path = tmp_path_factory.mktemp("whole") / "a.h5"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sweeper, "plan", lambda recipe: plan(recipe, SIZE))
        lutgen.sweep(RECIPE, path, threads=1)
    verify(lutgen.load_map(path))
    return path.read_bytes()


def swept(path: Path, cluster: LocalCluster, **options: Any) -> bytes:
    """Return the file that workers compute; nothing may be left beside it."""
    before = set(path.parent.iterdir())
    lutgen.sweep(RECIPE, path, engine="dask", scheduler=cluster.scheduler_address, **options)
    assert set(path.parent.iterdir()) - before <= {path}
    return path.read_bytes()


def test_two_threads_write_the_bytes_of_one(tmp_path: Path, whole: bytes) -> None:
    lutgen.sweep(RECIPE, tmp_path / "a.h5", threads=2)
    assert (tmp_path / "a.h5").read_bytes() == whole


def test_one_worker_writes_the_bytes_of_this_process(
    tmp_path: Path, whole: bytes, cluster: LocalCluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(PartFile, "write", None)  # the worker does that itself
    seen: list[tuple[int, int]] = []
    got = swept(tmp_path / "a.h5", cluster, progress=lambda *now: seen.append(now))
    assert got == whole
    assert len(seen) == BLOCKS
    assert seen[-1] == (54 * 121, 54 * 121)


def test_without_a_shared_folder_blocks_come_back_and_the_bytes_are_the_same(
    tmp_path: Path, whole: bytes, cluster: LocalCluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Workers look for the token somewhere else than where it is: as on another machine.
    monkeypatch.setattr(engine_dask, "token_path", lambda part: part.with_name("elsewhere"))
    written: list[int] = []
    write = PartFile.write

    def noted(self: PartFile, number: int, chunks: Any) -> None:
        written.append(number)
        write(self, number, chunks)

    monkeypatch.setattr(PartFile, "write", noted)
    assert swept(tmp_path / "a.h5", cluster) == whole
    assert sorted(written) == list(range(BLOCKS))


def test_a_worker_that_loses_the_folder_in_mid_run_sends_its_blocks_back(
    tmp_path: Path, whole: bytes, cluster: LocalCluster
) -> None:
    # As one does whose sweep was killed and begun anew: the token is another then.
    def lose(done: int, total: int) -> None:
        (tmp_path / ".a.h5.part.token").write_text("another sweep's")

    assert swept(tmp_path / "a.h5", cluster, progress=lose) == whole


def test_two_workers_resume_what_this_process_began(
    tmp_path: Path, whole: bytes, cluster: LocalCluster
) -> None:
    cluster.scale(2)
    cluster.wait_for_workers(2)

    def stop(done: int, total: int) -> None:
        if done > total / 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        lutgen.sweep(RECIPE, tmp_path / "a.h5", threads=1, progress=stop)
    assert swept(tmp_path / "a.h5", cluster, resume=True) == whole
    # And the other way round.
    with pytest.raises(KeyboardInterrupt):
        swept(tmp_path / "b.h5", cluster, progress=stop)
    assert {path.name for path in tmp_path.iterdir()} == {"a.h5", "b.h5.part"}
    lutgen.sweep(RECIPE, tmp_path / "b.h5", threads=1, resume=True)
    assert (tmp_path / "b.h5").read_bytes() == whole


def test_three_workers_of_which_one_is_killed_write_the_same_bytes(
    tmp_path: Path, whole: bytes, cluster: LocalCluster
) -> None:
    cluster.scale(3)
    cluster.wait_for_workers(3)
    with Client(cluster.scheduler_address) as client:
        processes = client.run(os.getpid)
    assert len(processes) == 3
    killed: list[int] = []

    def kill(done: int, total: int) -> None:
        if not killed:
            killed.append(next(iter(processes.values())))
            os.kill(killed[0], signal.SIGKILL)

    assert swept(tmp_path / "a.h5", cluster, progress=kill) == whole
    assert killed


def test_an_error_of_a_worker_arrives_as_its_sentence(
    tmp_path: Path, cluster: LocalCluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = engine_dask.Job

    def broken(text: str, *rest: Any) -> engine_dask.Job:
        return job(text.replace("[robot]", "[robto]"), *rest)

    monkeypatch.setattr(engine_dask, "Job", broken)
    with pytest.raises(RecipeError, match="robto"):
        lutgen.sweep(RECIPE, tmp_path / "a.h5", engine="dask", scheduler=cluster.scheduler_address)
    assert [path.name for path in tmp_path.iterdir()] == ["a.h5.part"]


def test_a_worker_that_cannot_write_stops_the_sweep_in_a_sentence_and_it_resumes(
    tmp_path: Path, whole: bytes, cluster: LocalCluster
) -> None:
    with Client(cluster.scheduler_address) as client:
        ahead = lay_out(RECIPE, plan(RECIPE, SIZE)).places[0, 10]
        client.run(resource.setrlimit, resource.RLIMIT_FSIZE, (int(ahead), resource.RLIM_INFINITY))
        with pytest.raises(SweepError, match=r"cannot be written \(got File too large\)"):
            lutgen.sweep(
                RECIPE, tmp_path / "a.h5", engine="dask", scheduler=cluster.scheduler_address
            )
        client.run(resource.setrlimit, resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY,) * 2)
    assert swept(tmp_path / "a.h5", cluster, resume=True) == whole


def test_a_scheduler_that_dies_is_a_sentence_and_the_sweep_resumes(
    tmp_path: Path,
    whole: bytes,
    capfd: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # It is started in this moment, on a machine that may be busy.
    monkeypatch.setattr(engine_dask, "REACH", 60.0)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    dask = [sys.executable, "-m", "dask"]
    common = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    scheduler = subprocess.Popen(
        [*dask, "scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard"], **common
    )
    address = f"tcp://127.0.0.1:{port}"
    worker = subprocess.Popen(
        [*dask, "worker", address, "--no-nanny", "--nthreads", "1", "--no-dashboard"], **common
    )
    options = {"scheduler": address, "progress": lambda done, total: scheduler.kill()}
    with scheduler, worker:
        try:
            with pytest.raises(SweepError, match=r"not answer any more .*--resume") as caught:
                lutgen.sweep(RECIPE, tmp_path / "a.h5", engine="dask", **options)
        finally:
            scheduler.kill()
            worker.kill()
    assert "\n" not in str(caught.value)
    assert "Traceback" not in capfd.readouterr().err
    lutgen.sweep(RECIPE, tmp_path / "a.h5", threads=1, resume=True)
    assert (tmp_path / "a.h5").read_bytes() == whole


def test_a_sweep_without_any_worker_gives_up_in_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(engine_dask, "PATIENCE", 0.2)
    with (
        LocalCluster(n_workers=0, dashboard_address=":0", silence_logs="CRITICAL") as empty,
        pytest.raises(SweepError, match="no worker is there"),
    ):
        swept(tmp_path / "a.h5", empty)


def test_workers_of_another_version_are_refused(
    tmp_path: Path, cluster: LocalCluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(engine_dask, "__version__", "99.0.0")
    with pytest.raises(SweepError, match=r"other versions of lutgen .*99\.0\.0"):
        swept(tmp_path / "a.h5", cluster)


def test_a_scheduler_that_is_not_there_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(engine_dask, "REACH", 0.5)
    for address in ("tcp://127.0.0.1:9", "nonsense://x"):
        with pytest.raises(InputError, match=f"scheduler {address} cannot be reached") as caught:
            lutgen.sweep(RECIPE, tmp_path / "a.h5", engine="dask", scheduler=address)
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"workers": 2}, "workers needs the engine dask"),
        ({"scheduler": "tcp://x:1"}, "scheduler needs the engine dask"),
        ({"engine": "dask", "workers": 0}, r"at least 1 \(got 0\)"),
        ({"engine": "dask", "workers": 2, "scheduler": "tcp://x:1"}, "leave one of the two out"),
    ],
)
def test_options_that_do_not_go_together_are_refused(
    options: dict[str, Any], said: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=said):
        lutgen.sweep(RECIPE, tmp_path / "a.h5", **options)
    assert list(tmp_path.iterdir()) == []


def test_a_robot_given_by_code_is_not_sent_to_workers(tmp_path: Path) -> None:
    (tmp_path / "feet_by_code.py").write_text(
        "import numpy as np\n"
        "def postures(q):\n"
        "    feet = np.tile([[1.0, 0, 0], [-1, 1, 0], [-1, -1, 0]], (len(q), 1, 1))\n"
        "    return feet, np.tile([0.0, 0.0, 0.8], (len(q), 1))\n"
    )
    path = tmp_path / "code.toml"
    path.write_text(rigid("", head='python = "feet_by_code:postures"'))
    recipe = lutgen.load_recipe(path, allow_python=True)
    with pytest.raises(InputError, match=r"given by code .*use the engine local"):
        lutgen.sweep(recipe, tmp_path / "a.h5", engine="dask")


def test_the_commands_of_the_page_on_scaling_run(tmp_path: Path) -> None:
    (shell,) = blocks("docs/measured/scaling.md", "sh")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    assert shell.count(":8786") == 2
    shell = shell.replace("8786", str(port))
    shutil.copytree(ROOT / "maps", tmp_path / "maps")
    # In small: fewer postures.
    small = tmp_path / "maps" / "absolem.toml"
    small.write_text(small.read_text().replace("= 37", "= 5"))
    done = subprocess.run(
        # `%1` is for shells with job control.
        ["bash", "-m", "-e", "-c", shell],
        cwd=tmp_path,
        env={
            **os.environ,
            "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]),
            "NUMBA_NUM_THREADS": "1",
        },
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    assert "checksums: all good" in done.stdout
    lutgen.sweep(lutgen.load_recipe(small), tmp_path / "here.h5", threads=1)
    here = lutgen.load_map(tmp_path / "here.h5")
    there = lutgen.load_map(tmp_path / "absolem.h5")
    for name in here.channels:
        assert here.channel(name).tobytes() == there.channel(name).tobytes()


def test_a_worker_gets_the_description_that_a_recipe_names(tmp_path: Path) -> None:
    shutil.copy(ROOT / "tests" / "vectors" / "rover.urdf", tmp_path)
    (tmp_path / "rover.toml").write_text(
        '[robot]\nname = "rover"\nlength_unit = "m"\nurdf = "rover.urdf"\n'
        '[[robot.parameter]]\nname = "arms"\nmin = -45.0\nmax = 45.0\nunit = "deg"\n'
        + "".join(
            f'[[robot.contact]]\nlink = "{link}"\n'
            for link in ("left_arm", "right_arm", "left_wheel", "right_wheel")
        )
        + sweep_part("arms = 3")
    )
    recipe = lutgen.load_recipe(tmp_path / "rover.toml")
    (tmp_path / "rover.urdf").unlink()
    layout = plan(recipe)
    computer = engine_dask._computer(recipe.text, recipe.urdf, recipe.source, layout)
    assert computer.recipe == recipe
    block = layout.block(0)
    here = Computer(recipe, layout).compute(block)
    for name, chunk in computer.compute(block).items():
        assert chunk.tobytes() == here[name].tobytes()

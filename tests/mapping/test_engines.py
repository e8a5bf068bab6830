"""The engines: whoever computes the blocks, the file has the same bytes."""

import os
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
from lutgen.errors import InputError, SweepError
from lutgen.mapping import dask as engine_dask
from lutgen.mapping import sweeper
from lutgen.mapping.blocks import plan
from lutgen.mapping.verification import verify
from tests.fixtures.documents import blocks
from tests.fixtures.places import ROOT
from tests.fixtures.recipes import rigid, sweep_part, tripod

# 54 postures of 11 x 11 nodes in 27 blocks, two channels.
RECIPE = lutgen.parse_recipe(tripod("reach = 9, swing = 6", nodes=11))
SIZE, BLOCKS = 242, 27


@pytest.fixture(autouse=True)
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut every sweep into blocks of 242 nodes."""
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


def test_a_worker_inside_this_process_writes_the_bytes_of_a_local_sweep(
    tmp_path: Path, whole: bytes
) -> None:
    seen: list[tuple[int, int]] = []
    lutgen.sweep(RECIPE, tmp_path / "a.h5", engine="dask", progress=lambda *now: seen.append(now))
    assert (tmp_path / "a.h5").read_bytes() == whole
    assert len(seen) == BLOCKS
    assert seen[-1] == (54 * 121, 54 * 121)


def test_a_scheduler_inside_this_process_has_no_port_but_that_of_bare_web_servers() -> None:
    with engine_dask.connected(None) as client:
        assert client.scheduler.address.startswith("inproc://")
        (server,) = client.cluster.scheduler.http_server._sockets.values()
        assert server.getsockname()[0] == "127.0.0.1"
        assert client.cluster.scheduler.http_application.applications == []


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


def test_a_scheduler_that_dies_is_a_sentence_and_the_sweep_resumes(
    tmp_path: Path,
    whole: bytes,
    capfd: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
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
            # They are started in this moment, on a machine that may be busy.
            with Client(address, timeout=60) as client:
                client.wait_for_workers(1, timeout=60)
            monkeypatch.setattr(engine_dask, "PATIENCE", 5.0)
            with pytest.raises(
                SweepError, match=r"scheduler or a worker failed .*--resume"
            ) as caught:
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
        pytest.raises(SweepError, match="Only 0/1 workers arrived"),
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


def test_without_distributed_the_engine_is_refused_in_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delitem(sys.modules, "lutgen.mapping.dask")
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(
        InputError, match=r"distributed .*lutgen\[cluster\], or use the engine local"
    ):
        lutgen.sweep(RECIPE, tmp_path / "a.h5", engine="dask")
    assert list(tmp_path.iterdir()) == []


def test_a_scheduler_for_the_engine_local_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="scheduler needs the engine dask"):
        lutgen.sweep(RECIPE, tmp_path / "a.h5", scheduler="tcp://x:1")


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
        shell = shell.replace("8786", str(free.getsockname()[1]))
    (tmp_path / "maps").mkdir()
    text = (ROOT / "maps" / "absolem.toml").read_text()
    (tmp_path / "maps" / "absolem.toml").write_text(text.replace("= 37", "= 5"))
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    done = subprocess.run(
        # `%1` is for shells with job control.
        ["bash", "-m", "-e", "-c", shell],
        cwd=tmp_path,
        env={**os.environ, "PATH": path, "NUMBA_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    assert "checksums: all good" in done.stdout


def test_a_worker_gets_the_urdf_that_a_recipe_names(tmp_path: Path, cluster: LocalCluster) -> None:
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
    lutgen.sweep(recipe, tmp_path / "here.h5", threads=1)
    address = cluster.scheduler_address
    lutgen.sweep(recipe, tmp_path / "there.h5", engine="dask", scheduler=address)
    assert (tmp_path / "there.h5").read_bytes() == (tmp_path / "here.h5").read_bytes()

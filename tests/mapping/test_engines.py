"""The engines: whoever computes the blocks, the file has the same bytes."""

import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from distributed import Client, LocalCluster

import lutgen
from lutgen.errors import InputError, SweepError
from lutgen.mapping import dask as engine_dask
from tests.fixtures.commands import broken_off
from tests.fixtures.places import ROOT, VECTORS, blocks
from tests.fixtures.recipes import parameter, sweep_part

# 54 postures of 11 x 11 nodes in 27 blocks, two channels.  The description is in no file that a
# worker could open.
TEXT = '[robot]\nname = "rover"\nlength_unit = "m"\nurdf = "rover.urdf"\n'
TEXT += parameter("arms", -45.0, 45.0)
LINKS = ("left_arm", "right_arm", "left_wheel", "right_wheel")
TEXT += "".join(f'[[robot.contact]]\nlink = "{link}"\n' for link in LINKS)
ROVER = (VECTORS / "rover.urdf").read_text(encoding="utf-8")
RECIPE = lutgen.parse_recipe(TEXT + sweep_part("arms = 54", nodes=11), urdf=ROVER)
SIZE, BLOCKS = 242, 27


@pytest.fixture(scope="module")
def cluster():
    with LocalCluster(
        n_workers=1,
        threads_per_worker=1,
        memory_limit=0,
        dashboard_address=":0",
        silence_logs="CRITICAL",
    ) as cluster:
        yield cluster


@pytest.fixture
def whole(tmp_path_factory, cut):
    """Return the file that this process computes with one thread, in blocks of 242 nodes."""
    cut(SIZE)
    path = tmp_path_factory.mktemp("whole") / "a.h5"
    lutgen.sweep(RECIPE, path, threads=1)
    return path.read_bytes()


def swept_there(path, cluster, **options):
    """Return the file that workers compute; nothing may be left beside it."""
    before = set(path.parent.iterdir())
    lutgen.sweep(RECIPE, path, engine="dask", scheduler=cluster.scheduler_address, **options)
    assert set(path.parent.iterdir()) - before <= {path}
    return path.read_bytes()


def test_a_worker_inside_this_process_writes_the_bytes_of_a_local_sweep(tmp_path, whole):
    seen = []
    lutgen.sweep(RECIPE, tmp_path / "a.h5", engine="dask", progress=lambda *now: seen.append(now))
    assert (tmp_path / "a.h5").read_bytes() == whole
    assert len(seen) == BLOCKS
    assert seen[-1] == (54 * 121, 54 * 121)


def test_a_scheduler_inside_this_process_has_no_port_but_that_of_bare_web_servers():
    with engine_dask.connected(None) as client:
        assert client.scheduler.address.startswith("inproc://")
        (server,) = client.cluster.scheduler.http_server._sockets.values()
        assert server.getsockname()[0] == "127.0.0.1"
        assert client.cluster.scheduler.http_application.applications == []


def test_two_workers_resume_what_this_process_began_and_lose_nothing_if_one_is_killed(
    tmp_path, whole, cluster
):
    cluster.scale(2)
    cluster.wait_for_workers(2)
    with Client(cluster.scheduler_address) as client:
        processes = list(client.run(os.getpid).values())

    def kill(done, total):
        if len(processes) == 2:
            os.kill(processes.pop(), signal.SIGKILL)

    broken_off(RECIPE, tmp_path / "a.h5", BLOCKS // 2, threads=1)
    assert swept_there(tmp_path / "a.h5", cluster, resume=True) == whole
    # And the other way round.
    there = {"engine": "dask", "scheduler": cluster.scheduler_address}
    broken_off(RECIPE, tmp_path / "b.h5", BLOCKS // 2, **there)
    assert {path.name for path in tmp_path.iterdir()} == {"a.h5", "b.h5.part"}
    lutgen.sweep(RECIPE, tmp_path / "b.h5", threads=1, resume=True)
    assert (tmp_path / "b.h5").read_bytes() == whole
    assert swept_there(tmp_path / "c.h5", cluster, progress=kill) == whole
    assert len(processes) == 1


def test_a_scheduler_that_dies_is_a_sentence_and_the_sweep_resumes(
    tmp_path, whole, capfd, monkeypatch
):
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
            with pytest.raises(SweepError, match=r"scheduler or a worker failed .*--resume"):
                lutgen.sweep(RECIPE, tmp_path / "a.h5", engine="dask", **options)
        finally:
            scheduler.kill()
            worker.kill()
    assert "Traceback" not in capfd.readouterr().err
    lutgen.sweep(RECIPE, tmp_path / "a.h5", threads=1, resume=True)
    assert (tmp_path / "a.h5").read_bytes() == whole


def test_a_sweep_without_any_worker_gives_up_in_a_sentence(tmp_path, monkeypatch):
    monkeypatch.setattr(engine_dask, "PATIENCE", 0.2)
    with (
        LocalCluster(n_workers=0, dashboard_address=":0", silence_logs="CRITICAL") as empty,
        pytest.raises(SweepError, match="Only 0/1 workers arrived"),
    ):
        swept_there(tmp_path / "a.h5", empty)


def test_workers_of_another_version_are_refused(tmp_path, cluster, monkeypatch):
    monkeypatch.setattr(engine_dask, "__version__", "99.0.0")
    with pytest.raises(SweepError, match=r"other versions of lutgen .*99\.0\.0"):
        swept_there(tmp_path / "a.h5", cluster)


def test_a_scheduler_that_is_not_there_and_a_missing_package_are_refused_in_a_sentence(
    tmp_path, monkeypatch
):
    monkeypatch.setattr(engine_dask, "REACH", 0.5)
    for address in ("tcp://127.0.0.1:9", "nonsense://x"):
        with pytest.raises(InputError, match=f"scheduler {address} cannot be reached"):
            lutgen.sweep(RECIPE, tmp_path / "a.h5", engine="dask", scheduler=address)
    monkeypatch.delitem(sys.modules, "lutgen.mapping.dask")
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match=r"distributed .*lutgen\[cluster\]`, or use the engine lo"):
        lutgen.sweep(RECIPE, tmp_path / "a.h5", engine="dask")
    assert list(tmp_path.iterdir()) == []


def test_the_commands_of_the_page_on_scaling_run(tmp_path):
    (shell,) = blocks("docs/guide/large.md", "sh")
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

"""The workers that a sweep starts itself: nobody else reaches them, and nothing is left behind."""

import os
import ssl
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import lutgen
from lutgen.errors import InputError
from lutgen.mapping import dask as engine_dask
from tests.fixtures.recipes import tripod

RECIPE = lutgen.parse_recipe(tripod("reach = 2, swing = 2", nodes=5))
# What another user of the machine can do: ask the scheduler to run code, encrypted or not.
ATTACK = """
import os, sys
from distributed import Client
from distributed.security import Security
address, how = sys.argv[1:]
security = {"none": None, "own": Security.temporary()}[how]
if os.geteuid() == 0:
    # Here, since another user may not be able to start this interpreter.
    os.setgroups([]), os.setgid(65534), os.setuid(65534)
try:
    client = Client(address, security=security, timeout=2)
    print("ran", client.run_on_scheduler(lambda: 42), client.submit(lambda: 42).result())
except Exception as error:
    print("refused", type(error).__name__)
"""


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    """Return what a sweep talks to that starts one worker."""
    with engine_dask.connected(None, 1, 1) as client:
        client.wait_for_workers(1)
        yield client


def listening(process: int) -> set[str]:
    """Return the addresses (hex, as the kernel prints them) on which a process listens."""
    sockets = set()
    for handle in Path(f"/proc/{process}/fd").iterdir():
        try:
            sockets.add(os.readlink(handle).removeprefix("socket:[").removesuffix("]"))  # noqa: PTH115
        except OSError:
            continue
    found = set()
    for name in ("tcp", "tcp6"):
        for line in Path(f"/proc/{process}/net/{name}").read_text().splitlines()[1:]:
            fields = line.split()
            if fields[3] == "0A" and fields[9] in sockets:
                found.add(fields[1].split(":")[0])
    return found


def test_they_speak_tls_on_loopback_alone_and_show_no_dashboard(client: Any) -> None:
    address = client.scheduler.address
    assert address.startswith("tls://127.0.0.1:")
    processes = [os.getpid(), *client.run(os.getpid).values()]
    for process in processes:
        # 127.0.0.1, in the order of the machine's bytes.
        assert listening(process) <= {"0100007F"}
    assert not client.run_on_scheduler(
        lambda dask_scheduler: [
            rule for rule in dask_scheduler.http_application.applications if "status" in str(rule)
        ]
    )


@pytest.mark.parametrize(("protocol", "how"), [("tcp", "none"), ("tls", "own")])
def test_whoever_has_not_the_credentials_of_this_sweep_is_refused(
    protocol: str, how: str, client: Any
) -> None:
    address = client.scheduler.address.replace("tls://", f"{protocol}://")
    done = subprocess.run(
        [sys.executable, "-c", ATTACK, address, how],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    said, _, error = done.stdout.strip().partition(" ")
    assert said == "refused", done.stdout + done.stderr
    # By the other side, and not for want of something here.
    assert error in ("OSError", "TimeoutError", "CommClosedError", "FatalCommClosedError")
    # And the sweep's own client is served as before.
    assert client.submit(int, "42").result() == 42


def test_a_sweep_with_workers_of_its_own_writes_the_bytes_of_this_process(tmp_path: Path) -> None:
    lutgen.sweep(RECIPE, tmp_path / "here.h5", threads=1)
    lutgen.sweep(RECIPE, tmp_path / "there.h5", engine="dask", workers=1, threads=1)
    assert (tmp_path / "there.h5").read_bytes() == (tmp_path / "here.h5").read_bytes()
    assert {path.name for path in tmp_path.iterdir()} == {"here.h5", "there.h5"}


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "tls://127.0.0.1:9", "nonsense://x"])
def test_a_scheduler_that_cannot_be_reached_is_a_sentence_and_leaves_no_part_file(
    address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(engine_dask, "REACH", 0.5)
    with pytest.raises(InputError, match="cannot be reached") as caught:
        lutgen.sweep(RECIPE, tmp_path / "a.h5", engine="dask", scheduler=address)
    assert "\n" not in str(caught.value)
    assert ("certificates" in str(caught.value)) == address.startswith("tls")
    assert list(tmp_path.iterdir()) == []


def test_certificates_that_cannot_be_read_are_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import dask

    monkeypatch.setattr(engine_dask, "REACH", 0.5)
    broken = tmp_path / "ca.pem"
    broken.write_text("none")
    settings = {"distributed.comm.tls.ca-file": str(broken)}
    settings |= {f"distributed.comm.tls.client.{k}": str(broken) for k in ("cert", "key")}
    with (
        dask.config.set(settings),
        pytest.raises(InputError, match="certificates") as caught,
    ):
        lutgen.sweep(RECIPE, tmp_path / "a.h5", engine="dask", scheduler="tls://127.0.0.1:9")
    assert isinstance(caught.value.__cause__, ssl.SSLError | OSError | ValueError)
    assert [path.name for path in tmp_path.iterdir()] == ["ca.pem"]

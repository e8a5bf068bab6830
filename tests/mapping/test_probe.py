"""Maps whose metadata make HDF5 loop, crash or take all memory are refused in a sentence."""

import signal
import time
from pathlib import Path

import pytest

import lutgen
from lutgen.errors import MapFileError
from lutgen.mapping import probe
from lutgen.mapping.seal import UNSEALED, check_head, seal_of, sealed
from tests.fixtures.recipes import tripod


@pytest.fixture(scope="module")
def content(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Return a map."""
    path = tmp_path_factory.mktemp("whole") / "a.h5"
    lutgen.sweep(lutgen.parse_recipe(tripod()), path, threads=1)
    return path.read_bytes()


def unsealed(content: bytes) -> bytes:
    """Return a map without a digest."""
    return content.replace(b"lutgen-digest-", b"Lutgen-digest-")


def endless(data: bytes) -> bytes:
    """Return a map whose second text has no number and no size: HDF5 goes to it for ever."""
    first = data.index(b"GCOL") + 16
    size = int.from_bytes(data[first + 8 : first + 16], "little")
    second = first + 16 + -(-size // 8) * 8
    return data[:second] + bytes(16) + data[second + 16 :]


def resealed(content: bytes) -> bytes:
    """Return a map with the digest of its own head, whatever that holds."""
    seal = seal_of(content)
    assert seal is not None
    own = UNSEALED.replace("0" * 12, f"{seal.length:012d}").replace("." * 64, seal.head)
    head = content[: seal.length].replace(own.encode(), UNSEALED.encode(), 1)
    return sealed(head) + content[seal.length :]


@pytest.fixture
def tried(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Count the trials."""
    files: list[str] = []
    run = probe.subprocess.run

    def noted(command: list[str], **options: object) -> object:
        files.append(command[-1])
        return run(command, **options)

    monkeypatch.setattr(probe.subprocess, "run", noted)
    return files


@pytest.mark.parametrize("again", [True, False], ids=["sealed", "not sealed"])
def test_a_heap_in_which_hdf5_would_go_on_for_ever_is_refused(
    content: bytes, again: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(probe, "SECONDS", 2)
    path, bad = tmp_path / "bad.h5", endless(content)
    path.write_bytes(resealed(bad) if again else unsealed(bad))
    assert (check_head(path) is not None) == again
    begin = time.perf_counter()
    with pytest.raises(MapFileError, match=r"^\S+: cannot be read as HDF5 \(got no end within 2 s"):
        lutgen.load_map(path, unsealed=True)
    # Twice as long is for a busy machine.
    assert time.perf_counter() - begin < 4.0


@pytest.mark.parametrize(
    ("code", "sentence"),
    [
        (f"import os; os.kill(os.getpid(), {signal.SIGSEGV.value})", "stopped by status -11"),
        ("raise SystemExit(4)", "4 GiB of memory"),
    ],
)
def test_a_trial_that_crashes_is_said_in_a_sentence(
    code: str, sentence: str, content: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "bad.h5"
    path.write_bytes(unsealed(content))
    monkeypatch.setattr(probe, "CODE", code)
    with pytest.raises(MapFileError, match=sentence):
        lutgen.load_map(path, unsealed=True)


def test_a_map_of_one_s_own_is_read_without_a_trial_and_any_other_with_one(
    content: bytes, tmp_path: Path, tried: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    own, other = tmp_path / "own.h5", tmp_path / "other.h5"
    own.write_bytes(content)
    assert lutgen.load_map(own).channels == ("sdg", "tip_angle")
    assert tried == []
    # As on another machine, or of another user.
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "cache"))
    assert lutgen.load_map(own).channels == ("sdg", "tip_angle")
    lutgen.sweep(lutgen.parse_recipe(tripod(max_tilt=45.0)), other, threads=1)
    assert lutgen.load_map(other).channels == ("sdg", "tip_angle")
    assert tried == [str(own)]


def test_where_no_process_can_be_started_maps_are_read_all_the_same(
    content: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def none(*_: object, **__: object) -> None:
        raise OSError("no processes here")

    monkeypatch.setattr(probe.subprocess, "run", none)
    path = tmp_path / "a.h5"
    path.write_bytes(unsealed(content))
    assert lutgen.load_map(path, unsealed=True).channels == ("sdg", "tip_angle")

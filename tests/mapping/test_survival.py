"""What a sweep survives: every call that fails, every place to die, power cuts, damaged files.

`make soak` runs more of each (LUTGEN_SOAK=1).
"""

import errno
import fcntl
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import lutgen
from lutgen.errors import MapFileError, SweepError
from lutgen.mapping import sweeper
from lutgen.mapping.blocks import Block, plan
from lutgen.mapping.compute import Computer
from lutgen.mapping.layout import lay_out
from lutgen.mapping.verification import verify
from lutgen.recipe.recipe import Recipe
from tests.fixtures.places import ROOT
from tests.fixtures.recipes import tripod

SOAK = "LUTGEN_SOAK" in os.environ
# 12 postures of 7 x 7 nodes in 8 blocks, two channels.
TRIPOD = lutgen.parse_recipe(tripod())
BLOCKS = 8
# Everything by which a sweep changes a file, and all of it goes through the module `os`.
CALLS = ("pwrite", "fsync", "ftruncate", "replace")


@pytest.fixture(autouse=True)
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut every sweep into blocks of 98 nodes, and do not wait for the disk."""
    monkeypatch.setattr(sweeper, "plan", lambda recipe: plan(recipe, 98))
    monkeypatch.setattr(os, "fsync", lambda handle: None)


def sweep(recipe: Recipe, path: Path, **options: Any) -> None:
    """Sweep with one thread, for which nobody has to wait on a busy machine."""
    lutgen.sweep(recipe, path, threads=1, **options)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Return the file that nothing disturbed."""
    path = tmp_path_factory.mktemp("whole") / "a.h5"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sweeper, "plan", lambda recipe: plan(recipe, 98))
        sweep(TRIPOD, path)
    return path.read_bytes()


class Calls:
    """Counts calls of `os` that change files; `strike` decides what one of them does instead."""

    def __init__(self, patch: pytest.MonkeyPatch, strike: Callable[..., Any]) -> None:
        self.count, self.log = 0, list[str]()
        for name in CALLS:
            real = getattr(os, name)

            def replaced(*args: Any, name: str = name, real: Any = real) -> Any:
                self.count += 1
                self.log.append(name)
                return strike(self.count, name, real, *args)

            patch.setattr(os, name, replaced)


def calls_of_a_sweep(tmp_path: Path) -> list[str]:
    """Return the calls of one undisturbed sweep."""
    with pytest.MonkeyPatch.context() as patch:
        calls = Calls(patch, lambda count, name, real, *args: real(*args))
        sweep(TRIPOD, tmp_path / "counted.h5")
    return calls.log


def test_a_sweep_writes_every_value_once_and_a_digest_thrice(tmp_path: Path) -> None:
    written: list[tuple[int, int]] = []

    def note(count: int, name: str, real: Any, *args: Any) -> Any:
        if name == "pwrite":
            written.append((args[2], args[2] + len(args[1])))
        return real(*args)

    with pytest.MonkeyPatch.context() as patch:
        Calls(patch, note)
        sweep(TRIPOD, tmp_path / "a.h5")
    size = (tmp_path / "a.h5").stat().st_size
    times = np.zeros(size, int)
    for start, end in written:
        times[start:end] += 1
    assert len(written) == 2 + 3 * BLOCKS + 1
    assert set(times[:6000]) <= {1, 2, 3}
    first = h5py_places(tmp_path / "a.h5")
    assert (times[first:] == 1).all()


def h5py_places(path: Path) -> int:
    """Return where the first chunk of a map is."""
    with h5py.File(path, "r") as file:
        return int(file["sdg"].id.get_chunk_info(0).byte_offset)


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EIO, errno.EDQUOT])
def test_a_call_that_fails_anywhere_is_a_sentence_and_loses_no_block(
    code: int, tmp_path: Path, whole: bytes
) -> None:
    log = calls_of_a_sweep(tmp_path)
    assert {name: log.count(name) for name in CALLS} == {
        "pwrite": 2 + 3 * BLOCKS + 1,
        "fsync": 3 + 2 + 1,
        "ftruncate": 1 + 1,
        "replace": 1,
    }
    path = tmp_path / "a.h5"
    for at in range(1, len(log) + 1):

        def fail(count: int, name: str, real: Any, *args: Any, at: int = at) -> Any:
            if count == at:
                raise OSError(code, os.strerror(code))
            return real(*args)

        with pytest.MonkeyPatch.context() as patch:
            Calls(patch, fail)
            with pytest.raises(SweepError, match=r"cannot be written \(got ") as caught:
                sweep(TRIPOD, path)
        assert "\n" not in str(caught.value)
        assert ("--resume" in str(caught.value)) == path.with_name("a.h5.part").exists()
        # Only the last sync, of the folder, comes after the name.
        assert path.exists() == (at == len(log))
        # Two writes lay the file out, then two make a block and one says so; once the file has its
        # name it is the map's.
        done = max(0, log[: at - 1].count("pwrite") - 2) // 3 if at < len(log) else 0
        with pytest.MonkeyPatch.context() as patch:
            computed = count_computed(patch)
            sweep(TRIPOD, path, resume=True)
        assert path.read_bytes() == whole, f"call {at} ({log[at - 1]})"
        assert len(computed) == BLOCKS - done, f"call {at} ({log[at - 1]})"
        path.unlink()


def count_computed(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Return the list of the blocks that are computed from now on."""
    blocks: list[int] = []
    compute = Computer.compute

    def noted(self: Computer, block: Block) -> Any:
        blocks.append(block.number)
        return compute(self, block)

    monkeypatch.setattr(Computer, "compute", noted)
    return blocks


def test_writes_that_take_only_a_part_each_time_lose_nothing(tmp_path: Path, whole: bytes) -> None:
    def short(count: int, name: str, real: Any, *args: Any) -> Any:
        if name == "pwrite":
            handle, data, place = args
            return real(handle, data[: max(1, len(data) // 3)], place)
        return real(*args)

    with pytest.MonkeyPatch.context() as patch:
        Calls(patch, short)
        sweep(TRIPOD, tmp_path / "a.h5")
    assert (tmp_path / "a.h5").read_bytes() == whole


def test_a_system_that_writes_nothing_and_says_no_error_is_not_waited_for(tmp_path: Path) -> None:
    with pytest.MonkeyPatch.context() as patch:
        Calls(patch, lambda count, name, real, *args: 0 if name == "pwrite" else real(*args))
        with pytest.raises(SweepError, match=r"Input/output|writes nothing"):
            sweep(TRIPOD, tmp_path / "a.h5")


class Killed(BaseException):
    """Stands for SIGKILL: from then on no call does anything."""


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_a_process_that_dies_at_any_call_leaves_a_file_to_go_on_with(
    share: float, tmp_path: Path, whole: bytes
) -> None:
    """Die before, within and after every call that changes the file; die again while resuming."""
    log = calls_of_a_sweep(tmp_path)
    path = tmp_path / "a.h5"
    for first in range(1, len(log) + 1):
        for at, resume in ((first, False), (max(1, first // 2), True)):

            def die(count: int, name: str, real: Any, *args: Any, at: int = at) -> Any:
                if count < at:
                    return real(*args)
                if count == at and name == "pwrite":
                    handle, data, place = args
                    real(handle, data[: int(share * len(data))], place)
                elif count == at and share == 1.0:
                    real(*args)
                raise Killed

            with pytest.MonkeyPatch.context() as patch, suppress(Killed):
                # Not even the removal of a file that is not laid out yet.
                patch.setattr(os, "unlink", lambda *args, **kwargs: None)
                Calls(patch, die)
                sweep(TRIPOD, path, resume=resume)
            if path.exists():
                assert path.read_bytes() == whole
        sweep(TRIPOD, path, resume=True)
        assert path.read_bytes() == whole, f"call {first} ({log[first - 1]})"
        path.unlink()


def after_power_cut(
    operations: list[tuple[Any, ...]], at: int, rng: np.random.Generator
) -> tuple[bytes | None, bytes | None]:
    """Return what may be on the disk if the power is cut after `at` operations: part and map.

    What was synced is there; of what came later any sectors of 512 bytes may be.
    """
    sure = max((i for i in range(at) if operations[i][0] == "fsync"), default=0)
    content = bytearray()
    listed = renamed = False
    for index, (name, *args) in enumerate(operations[:at]):
        certain = index < sure
        if name == "ftruncate" and (certain or rng.integers(2)):
            size = args[0]
            del content[size:]
            content.extend(bytes(size - len(content)))
        elif name == "pwrite":
            data, place = args
            for start in range(0, len(data), 512):
                piece = data[start : start + 512]
                end = place + start + len(piece)
                if certain or rng.integers(2):
                    content.extend(bytes(max(0, end - len(content))))
                    content[place + start : end] = piece
        elif name == "folder":
            listed = True
        elif name == "replace":
            renamed = certain or bool(rng.integers(2))
    if renamed:
        return None, bytes(content)
    return (bytes(content) if listed or rng.integers(2) else None), None


def test_a_power_cut_after_any_call_leaves_a_file_to_go_on_with(
    tmp_path: Path, whole: bytes
) -> None:
    operations: list[tuple[Any, ...]] = []

    def note(count: int, name: str, real: Any, *args: Any) -> Any:
        result = real(*args)
        if name == "pwrite":
            operations.append((name, bytes(args[1]), args[2]))
        elif name == "ftruncate":
            operations.append((name, args[1]))
        elif name == "fsync" and os.path.isdir(f"/proc/self/fd/{args[0]}"):  # noqa: PTH112
            operations.append(("folder",))
        else:
            operations.append((name,))
        return result

    path, part = tmp_path / "a.h5", tmp_path / "a.h5.part"
    with pytest.MonkeyPatch.context() as patch:
        Calls(patch, note)
        sweep(TRIPOD, path)
    assert path.read_bytes() == whole
    path.unlink()
    rng = np.random.default_rng(20)
    kept = 0
    for at in [i for i in range(len(operations) + 1) for _ in range(40 if SOAK else 2)]:
        left, named = after_power_cut(operations, at, rng)
        # A map that has its name is whole; there is no second chance.
        assert named is None or named == whole
        if left is not None:
            part.write_bytes(left)
        with pytest.MonkeyPatch.context() as patch:
            computed = count_computed(patch)
            sweep(TRIPOD, path, resume=True)
        kept += BLOCKS - len(computed)
        assert path.read_bytes() == whole, at
        path.unlink()
    # If nothing were ever kept the file would be right as well.
    assert kept > 60


def test_blocks_that_were_damaged_in_the_unfinished_file_are_computed_again(
    tmp_path: Path, whole: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, part = tmp_path / "a.h5", tmp_path / "a.h5.part"
    with pytest.raises(KeyboardInterrupt):
        sweep(TRIPOD, path, progress=Stop(6))
    with h5py.File(part, "r") as file:
        infos = [file["tip_angle"].id.get_chunk_info(i) for i in (1, 4)]
        blocks = [
            int(np.ravel_multi_index(np.array(i.chunk_offset) // (1, 2, 1, 7, 7), (4, 2, 1, 1, 1)))
            for i in infos
        ]
    content = bytearray(part.read_bytes())
    for info in infos:
        content[info.byte_offset + 50] ^= 1
    part.write_bytes(content)
    computed = count_computed(monkeypatch)
    sweep(TRIPOD, path, resume=True)
    assert sorted(computed) == sorted({*blocks, 6, 7})
    assert path.read_bytes() == whole


def test_what_stands_between_head_and_chunks_of_an_unfinished_file_is_cleared(
    tmp_path: Path, whole: bytes
) -> None:
    path, part = tmp_path / "a.h5", tmp_path / "a.h5.part"
    with pytest.raises(KeyboardInterrupt):
        sweep(TRIPOD, path, progress=Stop(5))
    skeleton = lay_out(TRIPOD, plan(TRIPOD, 98))
    free = np.ones(skeleton.size, bool)
    free[: len(skeleton.head)] = False
    for places, size in zip(skeleton.places, skeleton.chunk_bytes, strict=True):
        for place in places:
            free[place : place + size] = False
    assert free.any()
    data = np.frombuffer(part.read_bytes(), np.uint8).copy()
    data[free] = 0x44
    part.write_bytes(data.tobytes())
    sweep(TRIPOD, path, resume=True)
    assert path.read_bytes() == whole


class Stop:
    """A progress callback that presses Ctrl-C after some blocks."""

    def __init__(self, after: int) -> None:
        self.left = after

    def __call__(self, done: int, total: int) -> None:
        """Count down."""
        self.left -= 1
        if self.left == 0:
            raise KeyboardInterrupt


def test_a_block_of_zeros_is_known_to_be_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Of the channel `facet` a robot on three feet has only zeros, as a chunk that is not written.
    knots = "reach = [0.0, 0.01, 0.02, 0.03], swing = [-1.0, 0.0, 1.0]"
    recipe = lutgen.parse_recipe(tripod(knots, channels=("facet",), max_tilt=5.0))
    sweep(recipe, tmp_path / "whole.h5")
    assert not lutgen.load_map(tmp_path / "whole.h5").channel("facet").any()
    with pytest.raises(KeyboardInterrupt):
        sweep(recipe, tmp_path / "a.h5", progress=Stop(4))
    computed = count_computed(monkeypatch)
    sweep(recipe, tmp_path / "a.h5", resume=True)
    assert computed == [4, 5, 6, 7]
    assert (tmp_path / "a.h5").read_bytes() == (tmp_path / "whole.h5").read_bytes()
    verify(lutgen.load_map(tmp_path / "a.h5"))


# Two sweeps at once, and no room.


@pytest.fixture
def held(tmp_path: Path) -> Iterator[Path]:
    """Return the path of a map that another sweep is writing."""
    path = tmp_path / "a.h5"
    with Path(f"{path}.part").open("wb") as file:
        file.write(b"the other one's")
        file.flush()
        fcntl.flock(file, fcntl.LOCK_EX)
        yield path


@pytest.mark.parametrize("resume", [False, True])
def test_a_second_sweep_to_the_same_file_is_refused_and_leaves_it(resume: bool, held: Path) -> None:
    with pytest.raises(SweepError, match="another sweep is writing") as caught:
        sweep(TRIPOD, held, resume=resume)
    assert "\n" not in str(caught.value)
    assert Path(f"{held}.part").read_bytes() == b"the other one's"


def test_a_lock_of_a_file_that_got_its_name_meanwhile_is_not_taken_for_ours(
    tmp_path: Path, whole: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Between the opening of the part file and the lock, its writer finishes.
    path, part = tmp_path / "a.h5", tmp_path / "a.h5.part"
    part.write_bytes(whole)
    lock = fcntl.flock

    def late(handle: int, how: int) -> None:
        if part.exists() and not path.exists():
            part.rename(path)
        lock(handle, how)

    monkeypatch.setattr(fcntl, "flock", late)
    with pytest.raises(KeyboardInterrupt):
        sweep(TRIPOD, path, progress=Stop(1))
    assert path.read_bytes() == whole
    assert part.exists()


def test_a_file_system_without_locks_is_good_enough(
    tmp_path: Path, whole: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    def none(handle: int, how: int) -> None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(fcntl, "flock", none)
    sweep(TRIPOD, tmp_path / "a.h5")
    assert (tmp_path / "a.h5").read_bytes() == whole


def test_a_disk_without_room_is_refused_before_the_first_block(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    computed = count_computed(monkeypatch)
    disk = os.statvfs(tmp_path)
    full = os.statvfs_result([1, 1, disk.f_blocks, 20, 20, *disk[5:]])
    monkeypatch.setattr(os, "statvfs", lambda path: full)
    with pytest.raises(SweepError, match=r"too full for this map \(got 0\.00 GB free") as caught:
        sweep(TRIPOD, tmp_path / "a.h5")
    assert "\n" not in str(caught.value)
    assert computed == []
    assert list(tmp_path.iterdir()) == []


def test_a_full_disk_is_no_reason_to_lose_an_unfinished_file(
    tmp_path: Path, whole: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.h5"
    with pytest.raises(KeyboardInterrupt):
        sweep(TRIPOD, path, progress=Stop(5))
    with monkeypatch.context() as patch:
        disk = os.statvfs(tmp_path)
        full = os.statvfs_result([1, 1, disk.f_blocks, -(10**9), -(10**9), *disk[5:]])
        patch.setattr(os, "statvfs", lambda path: full)
        for how in ("resume", "force"):
            with pytest.raises(SweepError, match="too full"):
                sweep(TRIPOD, path, **{how: True})
    computed = count_computed(monkeypatch)
    sweep(TRIPOD, path, resume=True)
    assert computed == [5, 6, 7]
    assert path.read_bytes() == whole


def test_another_version_does_not_go_on_with_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(KeyboardInterrupt):
        sweep(TRIPOD, tmp_path / "a.h5", progress=Stop(5))
    monkeypatch.setattr("lutgen.mapping.template.__version__", "99.0.0")
    with pytest.raises(MapFileError, match=r"cannot be resumed .*version"):
        sweep(TRIPOD, tmp_path / "a.h5", resume=True)


# Whole processes.


def ran(module: str, count: int, tmp_path: Path) -> str:
    """Run one of the helpers of these tests; return what it printed last."""
    done = subprocess.run(
        [sys.executable, "-m", module, str(count), str(tmp_path)],
        capture_output=True,
        text=True,
        cwd=ROOT,
        env={**os.environ, "NUMBA_THREADING_LAYER": "workqueue"},
        timeout=1800 if SOAK else 300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    print(done.stdout)
    return done.stdout.splitlines()[-1]


def test_after_kill_9_at_random_moments_every_resumed_file_is_the_same(tmp_path: Path) -> None:
    count = 50 if SOAK else 3
    assert (
        ran("tests.mapping.soak_kill", count, tmp_path) == f"{count} kills, {count} identical files"
    )


def test_a_damaged_file_is_refused_in_a_sentence_or_holds_the_right_values(tmp_path: Path) -> None:
    count = 1000 if SOAK else 25
    last = ran("tests.mapping.soak_damage", count, tmp_path)
    assert last.startswith(f"{count} damaged files: 0 wrong values accepted")


def test_after_kills_with_edits_between_no_file_is_wrong_and_no_other_file_touched(
    tmp_path: Path,
) -> None:
    count = 200 if SOAK else 6
    last = ran("tests.mapping.soak_edits", count, tmp_path)
    assert last.startswith(f"{count} kills with edits: 0 wrong files, 0 foreign files touched")

"""What a sweep survives: every call that fails, every place to die, power cuts.

`make soak` runs more power cuts (LUTGEN_SOAK=1).
"""

import errno
import os
from contextlib import suppress

import numpy as np
import pytest

import lutgen
from lutgen.errors import SweepError
from lutgen.mapping import part as part_file
from lutgen.mapping import sweeper
from lutgen.mapping.compute import Computer
from tests.fixtures.recipes import tripod

SOAK = "LUTGEN_SOAK" in os.environ
# 8 postures of 7 x 7 nodes in 8 blocks, two channels.
TRIPOD, NODES, BLOCKS = lutgen.parse_recipe(tripod("reach = 4, swing = 2")), 49, 8
# Everything by which a sweep changes a file, and all of it goes through the module `os`.
CALLS = ("pwrite", "fsync", "ftruncate", "replace")


@pytest.fixture(autouse=True)
def small_blocks(cut, monkeypatch):
    """Cut every sweep into blocks of one posture, and do not wait for the disk."""
    cut(NODES)
    monkeypatch.setattr(os, "fsync", lambda handle: None)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "a.h5"


@pytest.fixture
def whole(tmp_path):
    lutgen.sweep(TRIPOD, tmp_path / "whole.h5", threads=1)
    return (tmp_path / "whole.h5").read_bytes()


def struck(path, strike, resume=False):
    """Sweep while `strike(count, name, real, *args)` stands for calls of `os`; return their names.

    Errors of the sweep are raised, a death is not.
    """
    log = []
    with pytest.MonkeyPatch.context() as patch:
        for name, real in [(name, getattr(os, name)) for name in CALLS]:

            def replaced(*args, name=name, real=real, **_):
                log.append(name)
                return strike(len(log), name, real, *args)

            patch.setattr(os, name, replaced)
        with suppress(Killed):
            lutgen.sweep(TRIPOD, path, threads=1, resume=resume)
    return log


def resumed(path):
    """Resume a sweep; return its file, which is removed, and how many blocks it computed."""
    blocks, compute = [], Computer.compute
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Computer, "compute", lambda self, b: blocks.append(b) or compute(self, b))
        lutgen.sweep(TRIPOD, path, threads=1, resume=True)
    content = path.read_bytes()
    path.unlink()
    return content, len(blocks)


class Killed(BaseException):
    """Stands for SIGKILL: from then on no call does anything."""


def undisturbed(path):
    log = struck(path, lambda count, name, real, *args: real(*args))
    path.unlink()
    # Head and its signature, two channels and their digests for each block, seal.
    assert {name: log.count(name) for name in CALLS} == {
        "pwrite": 2 + 3 * BLOCKS + 1,
        "fsync": 3 + 2 + 1,
        "ftruncate": 1,
        "replace": 1,
    }
    return log


def test_a_call_that_fails_anywhere_is_a_sentence_and_loses_no_block(path, whole):
    log = undisturbed(path)
    for at in range(1, len(log) + 1):

        def fail(count, name, real, *args, at=at):
            if count == at:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            return real(*args)

        with pytest.raises(SweepError, match=r"cannot be written \(got No space") as caught:
            struck(path, fail)
        assert ("--resume" in str(caught.value)) == path.with_name("a.h5.part").exists()
        # Only the last sync, of the folder, comes after the name.
        assert path.exists() == (at == len(log))
        done = max(0, log[: at - 1].count("pwrite") - 2) // 3 if at < len(log) else 0
        assert resumed(path) == (whole, BLOCKS - done), f"call {at} ({log[at - 1]})"


@pytest.mark.parametrize("share", [0.5, 1.0])
def test_a_process_that_dies_at_any_call_leaves_a_file_to_go_on_with(share, path, whole):
    for first in range(1, len(undisturbed(path)) + 1):
        for at, resume in ((first, False), (max(1, first // 2), True)):

            def die(count, name, real, *args, at=at):
                if count < at:
                    return real(*args)
                if count == at and name == "pwrite":
                    handle, data, place = args
                    # A system may also take less than it is given.
                    real(handle, data[: int(share * len(data))], place)
                elif count == at and share == 1.0:
                    real(*args)
                raise Killed

            with pytest.MonkeyPatch.context() as patch:
                # Not even the removal of a file that is not laid out yet.
                patch.setattr(os, "unlink", lambda *args, **kwargs: None)
                struck(path, die, resume)
            assert not path.exists() or path.read_bytes() == whole
        assert resumed(path)[0] == whole, f"call {first}"


def after_power_cut(operations, rng):
    """Return what may be on the disk after these operations, and whether it has its name.

    What was synced is there; of what came later any sectors of 512 bytes may be.
    """
    sure = max((i for i, (name, *_) in enumerate(operations) if name == "fsync"), default=0)
    content, renamed = bytearray(), False
    for index, (name, *args) in enumerate(operations):
        certain = index < sure
        if name == "ftruncate":
            content.extend(bytes(args[1] - len(content)))
        elif name == "pwrite":
            _, data, place = args
            for start in range(0, len(data), 512):
                if certain or rng.integers(2):
                    piece = data[start : start + 512]
                    content[place + start : place + start + len(piece)] = piece
        elif name == "replace":
            renamed = certain or bool(rng.integers(2))
    return bytes(content), renamed


def test_a_power_cut_after_any_call_leaves_a_file_to_go_on_with(path, whole):
    operations = []

    def note(count, name, real, *args):
        kept = [bytes(one) if isinstance(one, memoryview) else one for one in args]
        operations.append((name, *kept))
        return real(*args)

    struck(path, note)
    path.unlink()
    rng, kept = np.random.default_rng(20), 0
    for at in [i for i in range(len(operations) + 1) for _ in range(40 if SOAK else 2)]:
        left, named = after_power_cut(operations[:at], rng)
        # A map that has its name is whole; there is no second chance.
        assert not named or left == whole
        if not named:
            path.with_name("a.h5.part").write_bytes(left)
        content, computed = resumed(path)
        assert content == whole, at
        kept += BLOCKS - computed
    # If nothing were ever kept the file would be right as well.
    assert kept > 60


@pytest.mark.parametrize("edit", ["flipped", "cut", "grown", "moved", "zeros"])
def test_blocks_that_were_damaged_in_the_unfinished_file_are_computed_again(edit, path, whole):
    part = path.with_name("a.h5.part")
    struck(path, lambda count, name, real, *args: real(*args) if count < 30 else dies())
    place = lutgen.load_map(path.with_name("whole.h5")).layout.places[0]
    data, size = bytearray(part.read_bytes()), 4 * NODES
    assert data[place : place + 7 * size] == whole[place : place + 7 * size]
    if edit == "flipped":
        data[place + 3 * size] ^= 1
    elif edit == "cut":
        del data[place + 5 * size :]
    elif edit == "grown":
        data += b"x" * 1000
    elif edit == "moved":
        data[place : place + size] = data[place + size : place + 2 * size]
    else:
        data[place : place + 2 * size] = bytes(2 * size)
    part.write_bytes(data)
    content, computed = resumed(path)
    assert content == whole
    lost = {"flipped": 1, "cut": 7, "grown": 0, "moved": 1, "zeros": 2}[edit]
    assert computed == BLOCKS - 7 + lost


def dies():
    raise Killed


def test_a_second_sweep_to_the_same_file_is_refused_and_leaves_it(path):
    fcntl, part = pytest.importorskip("fcntl"), path.with_name("a.h5.part")
    with part.open("wb") as file:
        file.write(b"the other one's")
        file.flush()
        fcntl.flock(file, fcntl.LOCK_EX)
        for resume in (False, True):
            with pytest.raises(SweepError, match="another sweep is writing"):
                lutgen.sweep(TRIPOD, path, resume=resume)
        assert part.read_bytes() == b"the other one's"


def test_a_lock_of_a_file_that_got_its_name_meanwhile_is_not_taken_for_ours(
    path, whole, monkeypatch
):
    # Between the opening of the part file and the lock, its writer finishes.
    part, fcntl = path.with_name("a.h5.part"), pytest.importorskip("fcntl")
    part.write_bytes(whole)
    lock = fcntl.flock

    def late(handle, how):
        if part.exists() and not path.exists():
            part.rename(path)
        lock(handle, how)

    monkeypatch.setattr(fcntl, "flock", late)
    struck(path, lambda count, name, real, *args: real(*args) if count < 9 else dies())
    assert path.read_bytes() == whole
    assert part.exists()


@pytest.mark.parametrize("lacking", ["lock", "module", "pwrite"])
def test_a_system_without_locks_or_pwrite_is_good_enough(lacking, path, whole, monkeypatch):
    def none(handle, how):
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    if lacking == "lock":
        monkeypatch.setattr(pytest.importorskip("fcntl"), "flock", none)
    else:
        # As on Windows, where neither is.
        monkeypatch.setattr(part_file, "fcntl", None)
    if lacking == "pwrite":
        monkeypatch.delattr(os, "pwrite")
    lutgen.sweep(TRIPOD, path, threads=sweeper.numba.config.NUMBA_NUM_THREADS)
    assert path.read_bytes() == whole


def test_a_disk_without_room_is_refused_and_loses_no_unfinished_file(path, whole, monkeypatch):
    full = type("Usage", (), {"free": -(10**9)})
    for begun in (False, True):
        if begun:
            struck(path, lambda count, name, real, *args: real(*args) if count < 30 else dies())
        with monkeypatch.context() as patch:
            patch.setattr("shutil.disk_usage", lambda path: full)
            with pytest.raises(SweepError, match=r"too full for this map \(got -1\.00 GB free"):
                lutgen.sweep(TRIPOD, path, resume=True)
        assert path.with_name("a.h5.part").exists() == begun
    assert resumed(path) == (whole, BLOCKS - 7)


def test_an_interruption_while_the_file_is_laid_out_leaves_nothing_behind(path):
    with pytest.raises(KeyboardInterrupt):
        struck(path, lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
    assert list(path.parent.iterdir()) == []

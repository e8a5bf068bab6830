"""Threads that take whole blocks: the bytes of one thread, and nothing written after the end."""

import errno
import os
import sys
import threading
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numba
import pytest

import lutgen
from lutgen.errors import SweepError
from lutgen.mapping import sweeper
from lutgen.mapping.blocks import Block, Plan, plan
from lutgen.mapping.compute import Computer
from lutgen.recipe import Recipe
from tests.fixtures.recipes import sweep_part, tripod

# 48 postures of 7 x 7 nodes in 32 blocks, two channels.
RECIPE = lutgen.parse_recipe(tripod("reach = 8, swing = 6"))
pytestmark = pytest.mark.skipif(numba.config.NUMBA_NUM_THREADS < 2, reason="needs two cores")


@pytest.fixture(autouse=True)
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut every sweep into blocks of 98 nodes, and do not wait for the disk."""

    def small(recipe: Recipe) -> Plan:
        return plan(recipe, 98)

    monkeypatch.setattr(sweeper, "plan", small)
    monkeypatch.setattr(os, "fsync", lambda handle: None)
    assert small(RECIPE).count > 4 * sweeper.ENOUGH_BLOCKS


@pytest.fixture
def whole(tmp_path: Path) -> bytes:
    """Return the file of one thread."""
    lutgen.sweep(RECIPE, tmp_path / "one.h5", threads=1)
    return (tmp_path / "one.h5").read_bytes()


@pytest.fixture
def computed(monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, int]]:
    """Return the list of (block, thread) that are computed from now on."""
    log: list[tuple[int, int]] = []
    compute = Computer.compute

    def noted(self: Computer, block: Block) -> Any:
        log.append((block.number, threading.get_ident()))
        # Long enough for the other thread to be given a block.
        time.sleep(0.002)
        return compute(self, block)

    monkeypatch.setattr(Computer, "compute", noted)
    return log


def test_two_threads_write_the_bytes_of_one_and_compute_each_block_once(
    tmp_path: Path, whole: bytes, computed: list[tuple[int, int]]
) -> None:
    lutgen.sweep(RECIPE, tmp_path / "two.h5", threads=2)
    assert (tmp_path / "two.h5").read_bytes() == whole
    blocks = Counter(number for number, _ in computed)
    assert blocks == dict.fromkeys(range(sweeper.plan(RECIPE).count), 1)
    # The first is computed by who called, where Ctrl-C is heard.
    assert computed[0] == (0, threading.get_ident())
    assert len({thread for _, thread in computed[1:]}) == 2


def test_a_disk_that_fails_under_one_of_them_is_a_sentence_and_the_rest_is_resumed(
    tmp_path: Path, whole: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, count = os.pwrite, [0]

    def full(*args: Any) -> int:
        count[0] += 1
        if count[0] > 20:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return real(*args)

    with monkeypatch.context() as patch:
        patch.setattr(os, "pwrite", full)
        with pytest.raises(SweepError, match=r"No space left.*--resume"):
            lutgen.sweep(RECIPE, tmp_path / "two.h5", threads=2)
    lutgen.sweep(RECIPE, tmp_path / "two.h5", threads=2, resume=True)
    assert (tmp_path / "two.h5").read_bytes() == whole


def test_ctrl_c_waits_for_no_block_and_nothing_is_written_after_it(
    tmp_path: Path, whole: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    slow, compute, path = 3.0, Computer.compute, tmp_path / "two.h5"
    after: list[int] = []
    begun = threading.Event()

    def late(self: Computer, block: Block) -> Any:
        if block.number == 6:
            begun.set()
            time.sleep(slow)
        chunks = compute(self, block)
        after.append(block.number)
        return chunks

    pressed: list[float] = []

    def press(done: int, total: int) -> None:
        if done >= total // 8:
            assert begun.wait(30.0)
            pressed.append(time.perf_counter())
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(Computer, "compute", late)
        with pytest.raises(KeyboardInterrupt):
            lutgen.sweep(RECIPE, path, threads=2, progress=press)
        took = time.perf_counter() - pressed[0]
        left = path.with_name("two.h5.part").read_bytes()
        # Half of it is room for a busy machine.
        assert took < slow / 2
        assert 6 not in after
        time.sleep(1.2 * slow)
        assert 6 in after
    assert path.with_name("two.h5.part").read_bytes() == left
    lutgen.sweep(RECIPE, path, threads=2, resume=True)
    assert path.read_bytes() == whole


CODE = """
import threading
import numpy as np

threads = set()


def feet(q):
    threads.add(threading.get_ident())
    contacts = np.tile([[1.0, 0.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, -1.0]], (len(q), 1, 1))
    contacts[:, 0, 0] += q[:, 0]
    return contacts, np.zeros((len(q), 3))
"""


def test_a_robot_given_by_code_is_asked_by_the_thread_that_called(tmp_path: Path) -> None:
    (tmp_path / "asked_by.py").write_text(CODE)
    head = '[robot]\nname = "stool"\nlength_unit = "m"\npython = "asked_by:feet"\n'
    parameter = '[[robot.parameter]]\nname = "x"\nmin = 0\nmax = 2\nunit = "m"\n'
    text = head + parameter + sweep_part("x = 60")
    recipe = lutgen.parse_recipe(text, str(tmp_path / "stool.toml"), allow_python=True)
    lutgen.sweep(recipe, tmp_path / "code.h5", threads=2)
    assert sys.modules.pop("asked_by").threads == {threading.get_ident()}

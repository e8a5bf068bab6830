"""The run of a sweep: the same bits however it is cut, and what it refuses."""

import sys
import threading
import time
from itertools import pairwise

import numba
import numpy as np
import pytest

import lutgen
from lutgen.errors import InputError, MapFileError, RecipeError
from lutgen.mapping import expected_seconds, sweeper, verify
from lutgen.mapping.compute import Computer
from lutgen.mapping.head import BLOCK_NODES, plan
from lutgen.quantities import CHANNELS
from tests.fixtures.commands import broken_off
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import feet, parameter, rigid, rover, sweep_part, tripod

ROBOTS = {
    "points on a cone": tripod(nodes=11),
    "points on the sphere": tripod("reach = 3, swing = 2", chart="sphere", nodes=6),
    "all channels": tripod(nodes=5, channels=CHANNELS),
    "wheels": rover(nodes=9, channels=("sdg", "tip_angle", "facet")),
    "few directions": tripod(nodes=3),
}
# 12 postures of 7 x 7 nodes in 6 blocks.
TRIPOD, BLOCK = lutgen.parse_recipe(tripod()), 98


def values(stability_map):
    return {name: stability_map[name].tobytes() for name in stability_map.channels}


@pytest.mark.parametrize("text", ROBOTS.values(), ids=ROBOTS)
def test_values_depend_neither_on_threads_nor_on_the_size_of_blocks(text, tmp_path, cut):
    recipe = lutgen.parse_recipe(text)
    whole = values(lutgen.sweep(recipe, tmp_path / "whole.h5", threads=1))
    for size in (1 << 20, 1, 2 * recipe.chart.nodes, 3 * recipe.chart.nodes**2, 1000):
        cut(size)
        found = lutgen.sweep(recipe, tmp_path / "cut.h5", threads=numba.config.NUMBA_NUM_THREADS)
        assert values(found) == whole, size
        verify(found)


@pytest.mark.parametrize("name", ["paper_two", "marv", "excavator"])
def test_a_block_fills_at_least_half_of_what_it_may_hold(name):
    # Blocks of one row each would keep to the limit too, and be slow.
    recipe = lutgen.load_recipe(MAPS / f"{name}.toml")
    assert BLOCK_NODES / 2 < plan(recipe).rows * recipe.chart.nodes <= BLOCK_NODES


@pytest.mark.skipif(numba.config.NUMBA_NUM_THREADS < 2, reason="needs two cores")
def test_two_threads_compute_each_block_once(tmp_path, cut, monkeypatch):
    cut(BLOCK)
    threads, compute = {}, Computer.compute

    def noted(self, block):
        assert block.number not in threads
        threads[block.number] = threading.get_ident()
        # Long enough for the other thread to be given a block.
        time.sleep(0.002)
        return compute(self, block)

    monkeypatch.setattr(Computer, "compute", noted)
    recipe = lutgen.parse_recipe(tripod("reach = 8, swing = 6"))
    lutgen.sweep(recipe, tmp_path / "two.h5", threads=2)
    assert len(threads) == sweeper.plan(recipe).count
    # The first is computed by who called, where Ctrl-C is heard.
    assert threads.pop(0) == threading.get_ident()
    assert len(set(threads.values())) == 2


def test_progress_rises_to_the_number_of_nodes_while_the_file_has_its_temporary_name(tmp_path, cut):
    cut(BLOCK)
    seen = []
    names = set()

    def look(*now):
        seen.append(now)
        names.update(path.name for path in tmp_path.iterdir())

    lutgen.sweep(TRIPOD, tmp_path / "a.h5", progress=look)
    assert len(seen) == plan(TRIPOD, BLOCK).count == 6
    assert all(a < b for (a, _), (b, _) in pairwise(seen))
    assert seen[-1] == (12 * 49, 12 * 49)
    assert names == {"a.h5.part"}
    assert [path.name for path in tmp_path.iterdir()] == ["a.h5"]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("recipe", "one that belongs to another recipe"),
        ("blocks", "other blocks, another version"),
        ("version", "other blocks, another version"),
        ("text", "a file that is not HDF5"),
        ("head", "a damaged head"),
    ],
)
def test_an_unfinished_file_of_something_else_is_refused_and_kept(
    change, said, tmp_path, cut, monkeypatch
):
    cut(BLOCK)
    path, part, recipe = tmp_path / "a.h5", tmp_path / "a.h5.part", TRIPOD
    broken_off(TRIPOD, path, 2, threads=1)
    if change == "recipe":
        recipe = lutgen.parse_recipe(tripod(nodes=9))
    elif change == "blocks":
        cut(3 * BLOCK)
    elif change == "version":
        monkeypatch.setattr("lutgen.mapping.head.__version__", "99.0.0")
    elif change == "text":
        part.write_text("not HDF5")
    else:
        content = bytearray(part.read_bytes())
        content[40] ^= 1
        part.write_bytes(content)
    before = part.read_bytes()
    with pytest.raises(MapFileError, match=said):
        lutgen.sweep(recipe, path, resume=True)
    assert part.read_bytes() == before


def test_places_options_and_robots_that_cannot_be_swept_are_refused_and_leave_no_file(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("no folder")
    (tmp_path / "folder").mkdir()
    for path in ("none/a.h5", "file/a.h5", "folder", "", ".", "/"):
        with pytest.raises(InputError, match="cannot be written"):
            lutgen.sweep(TRIPOD, path)
    for options, said in (
        ({"engine": "cloud"}, "unknown engine 'cloud'"),
        ({"scheduler": "tcp://x:1"}, "scheduler needs the engine dask"),
        *(({"threads": n}, rf"threads .*got {n}") for n in (0, -1, 10_000)),
    ):
        with pytest.raises(InputError, match=said):
            lutgen.sweep(TRIPOD, "a.h5", **options)
    above = lutgen.parse_recipe(rigid(feet([(1, 0, 1), (-1, 1, 1), (-1, -1, 1)])))
    with pytest.raises(RecipeError, match="stands in none"):
        lutgen.sweep(above, "a.h5")
    assert {one.name for one in tmp_path.iterdir()} == {"file", "folder"}


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


def test_a_robot_given_by_code_is_asked_by_one_thread_and_its_map_runs_no_code(tmp_path, cut):
    (tmp_path / "asked_by.py").write_text(CODE)
    head = '[robot]\nname = "stool"\nlength_unit = "m"\npython = "asked_by:feet"\n'
    text = head + parameter("x", 0, 2, "m") + sweep_part("x = 60")
    by_code = lutgen.parse_recipe(text, str(tmp_path / "stool.toml"), allow_python=True)
    cut(BLOCK)
    with pytest.raises(InputError, match=r"given by code .*use the engine local"):
        lutgen.sweep(by_code, tmp_path / "a.h5", engine="dask")
    stability_map = lutgen.sweep(by_code, tmp_path / "a.h5")
    assert sys.modules.pop("asked_by").threads == {threading.get_ident()}
    (tmp_path / "asked_by.py").write_text("raise SystemExit('the code of a map was run')")
    directions = by_code.chart.directions().reshape(-1, 3)
    want = lutgen.evaluate(by_code, [[2.0]], directions)["tip_angle"][0]
    got = lutgen.load_map(tmp_path / "a.h5").read([2.0], directions)["tip_angle"]
    np.testing.assert_allclose(got, want, rtol=5e-7, atol=1e-12)  # float32
    with pytest.raises(lutgen.LutgenError, match="allow"):
        lutgen.evaluate(stability_map.recipe, [[0.5]], [[0, 0, -1]])


def test_expected_seconds_are_positive_and_grow_with_the_map():
    before = numba.get_num_threads()
    large = lutgen.parse_recipe(tripod("reach = 60, swing = 60", nodes=65))
    # 15 million nodes against 588: any clock sees the difference.
    assert 0.0 < expected_seconds(TRIPOD) < expected_seconds(large)
    assert numba.get_num_threads() == before

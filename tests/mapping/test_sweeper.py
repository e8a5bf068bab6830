"""The run of a sweep: the same bits however it is cut, stopped and resumed."""

import errno
import os
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.typing import NDArray

import lutgen
from lutgen.errors import InputError, MapFileError, RecipeError, SweepError
from lutgen.mapping import compute as computer
from lutgen.mapping import sweeper
from lutgen.mapping.blocks import Block, Plan, plan
from lutgen.mapping.compute import Computer
from lutgen.mapping.template import BITMAP
from lutgen.mapping.verification import verify
from lutgen.recipe.recipe import Recipe
from tests.fixtures.recipes import ALL_CHANNELS, feet, rigid, rover, tripod

ROBOTS = {
    "points on a cone": tripod(nodes=11),
    "points on the sphere": tripod("reach = 3, swing = 2", chart="sphere", nodes=6),
    "all channels": tripod(nodes=5, channels=ALL_CHANNELS),
    "wheels": rover(nodes=9, channels=("sdg", "tip_angle", "facet")),
    "few directions": tripod(nodes=3),
}
# 12 postures of 7 x 7 nodes; with blocks of 98 nodes that is 6 or 12 of them.
TRIPOD = lutgen.parse_recipe(tripod())
BLOCK = 98


def values(path: Path) -> dict[str, bytes]:
    """Return the raw values of every channel of a map."""
    stability_map = lutgen.load_map(path)
    return {name: stability_map.channel(name).tobytes() for name in stability_map.channels}


@pytest.fixture
def cut(monkeypatch: pytest.MonkeyPatch) -> Callable[[int], None]:
    """Return a function that sets how many nodes a block may hold."""

    def set_size(nodes: int) -> None:
        monkeypatch.setattr(sweeper, "plan", lambda recipe: plan(recipe, nodes))

    return set_size


class Interrupted:
    """A progress callback that presses Ctrl-C after some blocks."""

    def __init__(self, after: int) -> None:
        self.after, self.calls = after, 0

    def __call__(self, done: int, total: int) -> None:
        """Count the blocks."""
        self.calls += 1
        if self.calls == self.after:
            raise KeyboardInterrupt


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Return the list of the blocks that are computed from now on."""
    blocks: list[int] = []
    compute = Computer.compute

    def noted(self: Computer, block: Block) -> dict[str, NDArray[np.float32]]:
        blocks.append(block.number)
        return compute(self, block)

    monkeypatch.setattr(Computer, "compute", noted)
    return blocks


@pytest.mark.parametrize("text", ROBOTS.values(), ids=ROBOTS)
def test_values_depend_neither_on_threads_nor_on_the_size_of_blocks(
    text: str, tmp_path: Path, cut: Callable[[int], None]
) -> None:
    recipe = lutgen.parse_recipe(text)
    lutgen.sweep(recipe, tmp_path / "whole.h5", threads=1)
    whole = values(tmp_path / "whole.h5")
    lutgen.sweep(recipe, tmp_path / "two.h5", threads=2)
    assert values(tmp_path / "two.h5") == whole
    for size in (1, 2 * recipe.chart.nodes, 3 * recipe.chart.nodes**2, 1000):
        cut(size)
        lutgen.sweep(recipe, tmp_path / "cut.h5", threads=2)
        assert values(tmp_path / "cut.h5") == whole, size
        # The last chunk along the cut axis is only partly full, and its checksum holds.
        verify(lutgen.load_map(tmp_path / "cut.h5"))


def test_past_the_end_of_the_map_a_chunk_is_nan(tmp_path: Path, cut: Callable[[int], None]) -> None:
    # Of 3 nodes of `swing` a chunk holds 2, so every other chunk is half empty.
    cut(BLOCK)
    lutgen.sweep(TRIPOD, tmp_path / "a.h5")
    with h5py.File(tmp_path / "a.h5", "r") as file:
        assert file["sdg"].chunks == (1, 2, 1, 7, 7)
        for name in ("sdg", "tip_angle"):
            _, raw = file[name].id.read_direct_chunk((0, 2, 0, 0, 0))
            chunk = np.frombuffer(raw[:-4], np.float32)
            assert np.isnan(chunk[49:]).all()
            assert np.isfinite(chunk[:49]).any()


def test_progress_rises_and_ends_at_the_number_of_nodes(
    tmp_path: Path, cut: Callable[[int], None]
) -> None:
    cut(BLOCK)
    seen: list[tuple[int, int]] = []
    lutgen.sweep(TRIPOD, tmp_path / "a.h5", progress=lambda *now: seen.append(now))
    done = [now for now, _ in seen]
    assert len(done) == plan(TRIPOD, BLOCK).count > 5
    assert all(a < b for a, b in pairwise(done))
    assert {total for _, total in seen} == {done[-1]} == {12 * 49}


def test_the_file_appears_under_its_name_only_when_it_is_whole(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    names: list[list[str]] = []

    def look(done: int, total: int) -> None:
        names.append([p.name for p in tmp_path.iterdir()])

    lutgen.sweep(TRIPOD, path, progress=look)
    assert names == [["a.h5.part"]]
    assert [p.name for p in tmp_path.iterdir()] == ["a.h5"]


@pytest.mark.parametrize("after", [1, 3])
def test_an_interrupted_sweep_is_resumed_where_it_stopped(
    after: int, tmp_path: Path, cut: Callable[[int], None], counted: list[int]
) -> None:
    cut(BLOCK)
    lutgen.sweep(TRIPOD, tmp_path / "whole.h5")
    count = len(counted)
    path, part = tmp_path / "a.h5", tmp_path / "a.h5.part"
    with pytest.raises(KeyboardInterrupt):
        lutgen.sweep(TRIPOD, path, threads=1, progress=Interrupted(after))
    assert not path.exists()
    with h5py.File(part, "r") as file:
        assert file.attrs["complete"] == 0
        done = np.unpackbits(file.attrs[BITMAP])[:count]
    assert done.tolist() == [1] * after + [0] * (count - after)
    with pytest.raises(MapFileError, match="not complete"):
        lutgen.load_map(part)
    counted.clear()
    seen: list[int] = []
    lutgen.sweep(TRIPOD, path, resume=True, progress=lambda done, total: seen.append(done))
    assert counted == list(range(after, count))
    assert seen[-1] == 12 * 49
    assert not part.exists()
    assert values(path) == values(tmp_path / "whole.h5")
    with h5py.File(path, "r") as file:
        assert BITMAP not in file.attrs


def test_a_sweep_interrupted_after_its_last_block_computes_nothing_again(
    tmp_path: Path, cut: Callable[[int], None], counted: list[int]
) -> None:
    cut(BLOCK)
    path, count = tmp_path / "a.h5", plan(TRIPOD, BLOCK).count
    with pytest.raises(KeyboardInterrupt):
        lutgen.sweep(TRIPOD, path, threads=1, progress=Interrupted(count))
    assert not path.exists()
    counted.clear()
    lutgen.sweep(TRIPOD, path, resume=True)
    assert counted == []
    verify(lutgen.load_map(path))


def test_an_interruption_leaves_an_older_map_of_that_name_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    lutgen.sweep(TRIPOD, path)
    before = path.read_bytes()
    other = lutgen.parse_recipe(tripod(nodes=9))
    with pytest.raises(KeyboardInterrupt):
        lutgen.sweep(other, path, threads=1, progress=Interrupted(1))
    assert path.read_bytes() == before


def test_only_force_begins_an_unfinished_file_anew(
    tmp_path: Path, cut: Callable[[int], None], counted: list[int]
) -> None:
    cut(BLOCK)
    path = tmp_path / "a.h5"
    with pytest.raises(KeyboardInterrupt):
        lutgen.sweep(TRIPOD, path, threads=1, progress=Interrupted(2))
    counted.clear()
    with pytest.raises(InputError, match=r"unfinished work.*--resume, or begin anew with --force"):
        lutgen.sweep(TRIPOD, path)
    assert counted == []
    lutgen.sweep(TRIPOD, path, force=True)
    assert counted == list(range(plan(TRIPOD, BLOCK).count))


def test_resume_without_an_unfinished_file_begins_anew(tmp_path: Path) -> None:
    lutgen.sweep(TRIPOD, tmp_path / "a.h5", resume=True)
    verify(lutgen.load_map(tmp_path / "a.h5"))


def test_resume_with_another_recipe_is_refused_and_keeps_the_file(
    tmp_path: Path, cut: Callable[[int], None]
) -> None:
    cut(BLOCK)
    path, part = tmp_path / "a.h5", tmp_path / "a.h5.part"
    with pytest.raises(KeyboardInterrupt):
        lutgen.sweep(TRIPOD, path, threads=1, progress=Interrupted(2))
    before = part.read_bytes()
    other = lutgen.parse_recipe(tripod(nodes=9))
    with pytest.raises(MapFileError, match="belongs to another recipe"):
        lutgen.sweep(other, path, resume=True)
    assert part.read_bytes() == before


def test_resume_of_a_file_cut_into_other_blocks_is_refused(
    tmp_path: Path, cut: Callable[[int], None]
) -> None:
    cut(BLOCK)
    path = tmp_path / "a.h5"
    with pytest.raises(KeyboardInterrupt):
        lutgen.sweep(TRIPOD, path, threads=1, progress=Interrupted(2))
    for size in (7, 3 * BLOCK):
        cut(size)
        with pytest.raises(MapFileError, match="cannot be resumed"):
            lutgen.sweep(TRIPOD, path, resume=True)


def test_resume_of_a_file_that_is_no_map_is_refused(tmp_path: Path) -> None:
    part = tmp_path / "a.h5.part"
    part.write_text("not HDF5")
    with pytest.raises(MapFileError, match="cannot be resumed"):
        lutgen.sweep(TRIPOD, tmp_path / "a.h5", resume=True)
    assert part.read_text() == "not HDF5"


def one_sentence(error: BaseException, path: Path) -> bool:
    """Tell whether a message is one line that names the file."""
    return str(path) in str(error) and "\n" not in str(error)


def test_places_that_cannot_be_written_are_refused_in_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")
    (tmp_path / "folder").mkdir()
    # No folder; a file where a folder should be; a folder where the file should be.
    for path in (tmp_path / "none" / "a.h5", tmp_path / "file" / "a.h5", tmp_path / "folder"):
        with pytest.raises(InputError, match="cannot be written") as caught:
            lutgen.sweep(TRIPOD, path)
        assert one_sentence(caught.value, path)


def test_a_path_without_a_file_name_is_refused() -> None:
    for path in ("", ".", "/"):
        with pytest.raises(InputError, match="cannot be written"):
            lutgen.sweep(TRIPOD, path)


def test_a_folder_without_permission_is_refused_in_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # The tests may run as root, to whom every folder is open.
    def denied(source: Path, target: Path) -> None:
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(target))

    monkeypatch.setattr(os, "replace", denied)
    with pytest.raises(SweepError, match="Permission denied") as caught:
        lutgen.sweep(TRIPOD, tmp_path / "a.h5")
    assert one_sentence(caught.value, tmp_path / "a.h5")


def test_a_full_disk_is_a_sentence_and_the_sweep_goes_on_when_there_is_space(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, cut: Callable[[int], None]
) -> None:
    cut(BLOCK)
    path = tmp_path / "a.h5"
    lutgen.sweep(TRIPOD, tmp_path / "whole.h5")
    write, left = os.pwrite, [5]

    def until_full(handle: int, data: memoryview, place: int) -> int:
        left[0] -= 1
        if left[0] < 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return write(handle, data, place)

    with monkeypatch.context() as patch:
        patch.setattr(os, "pwrite", until_full)
        with pytest.raises(SweepError, match="No space left"):
            lutgen.sweep(TRIPOD, path)
    lutgen.sweep(TRIPOD, path, resume=True)
    assert values(path) == values(tmp_path / "whole.h5")


def test_where_nothing_was_begun_no_message_tells_to_go_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def too_large(handle: int, size: int) -> None:
        raise OSError(errno.EFBIG, os.strerror(errno.EFBIG))

    monkeypatch.setattr(os, "ftruncate", too_large)
    with pytest.raises(SweepError, match="File too large") as caught:
        lutgen.sweep(TRIPOD, tmp_path / "a.h5")
    assert "--resume" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_chunks_are_whole_though_the_system_writes_them_in_pieces(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write = os.pwrite
    lutgen.sweep(TRIPOD, tmp_path / "whole.h5")
    monkeypatch.setattr(os, "pwrite", lambda h, data, at: write(h, data[:1000], at))
    lutgen.sweep(TRIPOD, tmp_path / "a.h5")
    assert values(tmp_path / "a.h5") == values(tmp_path / "whole.h5")


def test_an_unknown_engine_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="unknown engine 'cloud'"):
        lutgen.sweep(TRIPOD, tmp_path / "a.h5", engine="cloud")


@pytest.mark.parametrize("threads", [0, -1, 10_000])
def test_an_impossible_number_of_threads_is_refused(threads: int, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=rf"threads .*got {threads}"):
        lutgen.sweep(TRIPOD, tmp_path / "a.h5", threads=threads)
    assert list(tmp_path.iterdir()) == []


def test_a_robot_that_never_stands_is_refused_before_a_file_is_made(tmp_path: Path) -> None:
    recipe = lutgen.parse_recipe(rigid(feet([(1, 0, 1), (-1, 1, 1), (-1, -1, 1)])))
    with pytest.raises(RecipeError, match="stands in none"):
        lutgen.sweep(recipe, tmp_path / "a.h5")
    assert list(tmp_path.iterdir()) == []


def test_a_map_of_a_single_direction_holds_level_ground(tmp_path: Path) -> None:
    recipe = lutgen.parse_recipe(tripod(nodes=1, channels=ALL_CHANNELS))
    lutgen.sweep(recipe, tmp_path / "a.h5")
    stability_map = lutgen.load_map(tmp_path / "a.h5")
    params = recipe.grid.params(np.arange(12))
    want = lutgen.evaluate(recipe, params, [[0, 0, -1]], ALL_CHANNELS)
    for name in ALL_CHANNELS:
        assert stability_map.channel(name).shape == (4, 3, 1, 1, 1)
        np.testing.assert_allclose(
            stability_map.channel(name).ravel(), want[name].ravel(), rtol=1e-7
        )  # one rounding to float32
    level = stability_map.read(params, np.tile([[0.0, 0.0, -2.0]], (12, 1)), ["sdg"])["sdg"]
    np.testing.assert_allclose(level, want["sdg"][:, 0], rtol=1e-7)


def test_a_robot_without_parameters_has_a_map_of_its_directions(tmp_path: Path) -> None:
    recipe = lutgen.parse_recipe(rigid(feet([(1, 0, -1), (-1, 1, -1), (-1, -1, -1)])))
    lutgen.sweep(recipe, tmp_path / "a.h5")
    stability_map = lutgen.load_map(tmp_path / "a.h5")
    assert stability_map.channel("sdg").shape == (1, 7, 7)
    got = stability_map.read(np.zeros((1, 0)), [[0, 0, -1]])
    assert got["tip_angle"][0] == pytest.approx(
        lutgen.evaluate(recipe, np.zeros((1, 0)), [[0, 0, -1]])["tip_angle"][0, 0], rel=1e-7
    )


PLUGIN = """
import numpy as np

def postures(q):
    m = len(q)
    feet = np.zeros((m, 3, 3))
    feet[:, 0, 0] = 1.0 + q[:, 0]
    feet[:, 1, :2] = (-1.0, 1.0)
    feet[:, 2, :2] = (-1.0, -1.0)
    return feet, np.tile([0.0, 0.0, 0.8], (m, 1))
"""


@pytest.fixture
def plugin(tmp_path: Path, request: pytest.FixtureRequest) -> Recipe:
    """Return a recipe whose robot is Python code, beside a module of a name of its own."""
    name = f"plugin_{abs(hash(request.node.nodeid))}"
    (tmp_path / f"{name}.py").write_text(PLUGIN)
    text = rigid("", head=f'python = "{name}:postures"', nodes=5).replace(
        "[sweep]\n", "[sweep]\nsamples = { reach = 4 }\n"
    )
    head, sweep = text.split("[sweep]", 1)
    parameter = '[[robot.parameter]]\nname = "reach"\nmin = 0.0\nmax = 1.0\nunit = "m"\n'
    path = tmp_path / "plugin.toml"
    path.write_text(head + parameter + "[sweep]" + sweep)
    return lutgen.load_recipe(path, allow_python=True)


def test_a_robot_given_by_code_is_swept_and_its_map_loads_without_running_it(
    plugin: Recipe, tmp_path: Path
) -> None:
    lutgen.sweep(plugin, tmp_path / "a.h5")
    for module in tmp_path.glob("plugin_*.py"):
        module.write_text("raise SystemExit('the code of a map was run')")
    stability_map = lutgen.load_map(tmp_path / "a.h5")
    got = stability_map.read([[0.5]], [[0.1, 0.0, -1.0]])
    assert got["tip_angle"][0] > 0.0
    stored = stability_map.channel("tip_angle")
    want = lutgen.evaluate(plugin, [[1.0]], plugin.chart.directions().reshape(-1, 3))["tip_angle"]
    np.testing.assert_allclose(stored[-1].ravel(), want.ravel(), rtol=5e-7, atol=1e-12)  # float32


def test_evaluating_the_recipe_of_such_a_map_is_refused(plugin: Recipe, tmp_path: Path) -> None:
    lutgen.sweep(plugin, tmp_path / "a.h5")
    with pytest.raises(lutgen.LutgenError, match="allow"):
        lutgen.evaluate(lutgen.load_map(tmp_path / "a.h5").recipe, [[0.5]], [[0, 0, -1]])


def test_the_number_of_threads_is_put_back_afterwards(tmp_path: Path) -> None:
    import numba

    before = numba.get_num_threads()
    lutgen.sweep(TRIPOD, tmp_path / "a.h5", threads=1)
    assert numba.get_num_threads() == before


def test_expected_seconds_are_positive_and_grow_with_the_map() -> None:
    small = computer.expected_seconds(TRIPOD)
    large = computer.expected_seconds(
        lutgen.parse_recipe(tripod("reach = 60, swing = 60", nodes=65))
    )
    # 15 million nodes against 588: any clock sees the difference.
    assert 0.0 < small < large


def test_a_plan_of_the_recipe_is_what_the_file_is_cut_into(tmp_path: Path) -> None:
    lutgen.sweep(TRIPOD, tmp_path / "a.h5")
    layout: Plan = plan(TRIPOD)
    with h5py.File(tmp_path / "a.h5", "r") as file:
        assert file["sdg"].chunks == layout.chunk
        assert file["sdg"].shape == layout.shape


def test_an_interruption_while_the_file_is_laid_out_leaves_nothing_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "fsync", interrupted)
    with pytest.raises(KeyboardInterrupt):
        sweeper.sweep(TRIPOD, tmp_path / "map.h5")
    assert list(tmp_path.iterdir()) == []

"""The emulated targets: one run of each kind, and a fault that each gate finds."""

import re
import shutil
from dataclasses import replace
from functools import partial

import pytest

from firmware_export.emit import facts, package
from firmware_export.emit.size import FILE, measured
from targets import baseline, cases, control, pages, run
from targets import size as size_measure
from targets.boards import BOARDS
from targets.elf import section_bytes
from targets.image import compiled, execute
from tests.fixtures.exports import tripod_export

ON = {board.name: board for board in BOARDS}
CASE = cases.Case("tripod", partial(tripod_export, "tripod"))


@pytest.fixture
def row(tmp_path, monkeypatch):
    monkeypatch.setattr(cases, "BUILD", tmp_path)
    return run.prepared(CASE)


@pytest.mark.parametrize(
    "board", [pytest.param(board, marks=pytest.mark.needs(*board.programs)) for board in BOARDS]
)
def test_a_target_answers_as_the_host_does(row, board):
    cell = run.run_cell(row, board, board.options[-1], 0)
    assert cell["code"] > 1000
    assert ("read" in cell) is bool(board.unit)


@pytest.mark.needs(*ON["m4f"].programs)
def test_one_wrong_bit_in_a_table_gives_another_hash(row):
    source = row.job.folder / "tripod.c"
    text = source.read_text()
    found = re.search(r"(\d+),\s*\};", text)
    source.write_text(f"{text[: found.start(1)]}{int(found[1]) ^ 1}{text[found.end(1) :]}")
    job, wanted = row.asked(ON["m4f"])
    assert execute(replace(job, counted=1), ON["m4f"], "-Os").hash != wanted


@pytest.mark.needs(*ON["m4f"].programs)
def test_a_chip_commands_what_this_machine_does_bit_for_bit(tmp_path, monkeypatch):
    monkeypatch.setattr("firmware_export.control.maker.POSTURES", 100)
    monkeypatch.setattr(control, "BUILD", tmp_path)
    robot = control.prepared("paper_two")
    same, counts, _ = control.execute(robot, ON["m4f"], "-O2")
    assert same
    assert len(counts) == control.CYCLES
    assert max(counts) < 5_000


def test_more_than_two_percent_is_worse_and_another_export_is_told():
    cell = {"code": 1000, "stack": 500, "at": [100, 200, 50]}
    known = {"compilers": {}, "rows": {"a": {"export": {"spec": "x"}, "m4f -O2": cell}}}
    assert baseline.compare(known, known) == ([], [])
    now = {**cell, "code": 1030, "at": [100, 150, 50]}
    found = {"compilers": {}, "rows": {"a": {"export": {"spec": "x"}, "m4f -O2": now}}}
    assert baseline.compare(known, found) == (
        ["a m4f -O2 code: 1,000, now 1,030 (+3.0%)"],
        ["a m4f -O2 at largest: 200, now 150 (-25.0%)"],
    )
    other = {"compilers": {}, "rows": {"a": {"export": {"spec": "y"}}}}
    assert baseline.compare(known, other)[0] == ["a: is another export than that of the baseline"]


def test_the_pages_show_the_committed_counts(tmp_path, monkeypatch):
    before = [path.read_text("utf-8") for path in (pages.PAGE, pages.README)]
    for name in ("PAGE", "README"):
        shutil.copy(getattr(pages, name), tmp_path / f"{name}.md")
        monkeypatch.setattr(pages, name, tmp_path / f"{name}.md")
    pages.update(baseline.load())
    assert [path.read_text("utf-8") for path in (pages.PAGE, pages.README)] == before


def test_a_report_tells_the_counts_of_just_the_export_that_was_counted():
    export = cases.of_recipe("paper_two", "contacts")
    told = facts.counted(export)
    known = baseline.load()["rows"]["paper_two"]["m4f -O2"]["at"]
    assert [
        [one["median"], one["max"], one["stack"]]
        for one in told
        if (one["option"], one["call"]) == ("-O2", "at")
    ] == [known]
    assert facts.counted(replace(export, channels=("tip_angle",))) is None


ROWS = measured(FILE)


@pytest.mark.needs(size_measure.BOARD.tool)
@pytest.mark.parametrize("family", ["points", "tables_i"])  # `make size` measures all
def test_the_committed_sizes_are_those_of_the_runtime(tmp_path, family):
    found = size_measure.measure_row(family, tmp_path)
    # Another version of the compiler may differ by a few instructions.
    assert found["code"] == pytest.approx(ROWS[family]["code"], rel=0.03)
    assert found["stack"] == pytest.approx(ROWS[family]["stack"], abs=16)


@pytest.mark.needs(size_measure.BOARD.tool)
def test_the_flash_of_a_robot_of_the_gallery_is_that_of_its_object_file(tmp_path):
    export = cases.of_recipe("paper_two", "contacts")
    said = package.write(export, tmp_path)["bytes"]
    assert said["measured"]
    compiled("paper_two", size_measure.BOARD, "-Os", tmp_path, {})
    held = section_bytes(tmp_path / "paper_two.o", ".text", ".rodata", ".data")
    assert said["total"] == pytest.approx(held, rel=0.03)
    assert (
        f"#define PAPER_TWO_FLASH      {said['total']}u" in (tmp_path / "paper_two.h").read_text()
    )

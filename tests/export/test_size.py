"""The measured sizes of the runtime."""

import pytest

from firmware_export.emit import package
from firmware_export.emit.size import FILE, measured
from targets import size as size_measure
from targets.cases import of_recipe
from targets.elf import section_bytes
from targets.image import compiled

ROWS = measured(FILE)


def test_every_family_has_its_numbers():
    assert set(ROWS) == set(size_measure.EXPORTS)
    assert {name.split(",")[0] for name in ROWS} == set(size_measure.FAMILIES)
    assert all(set(row) >= {"code", "stack", "control", "pose"} for row in ROWS.values())


@pytest.mark.needs(size_measure.BOARD.tool)
@pytest.mark.parametrize("family", ["points", "tables_i"])  # `make size` measures all
def test_the_committed_sizes_are_those_of_the_runtime(tmp_path, family):
    found = size_measure.measure_row(family, tmp_path)
    # Another version of the compiler may differ by a few instructions.
    assert found["code"] == pytest.approx(ROWS[family]["code"], rel=0.03)
    assert found["stack"] == pytest.approx(ROWS[family]["stack"], abs=16)


@pytest.mark.needs(size_measure.BOARD.tool)
def test_the_flash_of_a_robot_of_the_gallery_is_that_of_its_object_file(tmp_path):
    export = of_recipe("paper_two", "contacts")
    said = package.write(export, tmp_path)["bytes"]
    assert said["measured"]
    compiled("paper_two", size_measure.BOARD, "-Os", tmp_path, {})
    held = section_bytes(tmp_path / "paper_two.o", ".text", ".rodata", ".data")
    assert said["total"] == pytest.approx(held, rel=0.03)
    assert (
        f"#define PAPER_TWO_FLASH      {said['total']}u" in (tmp_path / "paper_two.h").read_text()
    )

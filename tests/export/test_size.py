"""The measured sizes of the runtime."""

import shutil
from pathlib import Path

import pytest

from firmware_export.emit.size import measured, parse_sizes
from targets import size as size_measure


@pytest.mark.needs(size_measure.BOARD.tool)
def test_the_committed_sizes_are_those_of_the_runtime(tmp_path: Path) -> None:
    content = measured()
    assert {frozenset(on) for on in size_measure.SETS.values()} == set(content["sets"])
    for on in list(size_measure.SETS.values())[:2]:  # `make size` measures all
        known = content["sets"][frozenset(on)]
        found = size_measure.measure_set(on, tmp_path)
        # Another version of the compiler may differ by a few instructions.
        assert found["code"] == pytest.approx(known["code"], rel=0.03), on
        assert found["stack"] == pytest.approx(known["stack"], abs=16), on
        assert (found["data"], found["bss"]) == (0, 0)


@pytest.mark.needs(size_measure.BOARD.tool)
def test_an_update_rewrites_the_file_that_exports_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    title = next(iter(size_measure.SETS))
    monkeypatch.setattr(size_measure, "SIZES", tmp_path / "sizes.json")
    monkeypatch.setattr(size_measure, "SETS", {title: size_measure.SETS[title]})
    page = tmp_path / "page.md"
    shutil.copy(size_measure.PAGE, page)
    monkeypatch.setattr(size_measure, "PAGE", page)
    assert size_measure.main(["--update"]) == 0
    written = parse_sizes((tmp_path / "sizes.json").read_text())
    assert set(written["sets"]) == {frozenset(size_measure.SETS[title])}
    assert f"| {title} | `" in page.read_text("utf-8")

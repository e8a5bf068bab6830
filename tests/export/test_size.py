"""The measured sizes of the runtime."""

import shutil
from pathlib import Path

import pytest

from firmware_export.emit.size import measured, parse_sizes
from lutgen.errors import ExportError
from targets import size as size_measure

GRAPH = """\
graph: { title: "smap.c"
node: { title: "smap_read" label: "smap_read\\nsmap.c:9:5\\n64 bytes (static)" }
node: { title: "smap.c:root" label: "root\\nsmap.c:3:1\\n8 bytes (static)" }
node: { title: "smap.c:facet" label: "facet\\nsmap.c:5:1\\n40 bytes (static)" }
edge: { sourcename: "smap_read" targetname: "smap.c:root" label: "smap.c:10:3" }
edge: { sourcename: "smap_read" targetname: "smap.c:facet" label: "smap.c:11:3" }
edge: { sourcename: "smap.c:facet" targetname: "smap.c:root" label: "smap.c:6:3" }
}
"""


def test_the_stack_is_that_of_the_deepest_chain_of_calls() -> None:
    assert size_measure.deepest(GRAPH) == 64 + 40 + 8


def test_the_stack_of_a_call_has_no_chain_that_it_never_takes() -> None:
    assert size_measure.deepest(GRAPH, "smap_read", without="facet") == 64 + 8
    assert size_measure.deepest(GRAPH, "facet") == 40 + 8


def test_a_recursion_is_found() -> None:
    edge = 'edge: { sourcename: "smap.c:root" targetname: "smap.c:facet" label: "" }\n'
    with pytest.raises(ExportError, match="calls itself"):
        size_measure.deepest(GRAPH + edge)


@pytest.mark.needs(size_measure.COMPILER)
def test_the_committed_sizes_are_those_of_the_runtime(tmp_path: Path) -> None:
    content = measured()
    sets = size_measure.feature_sets()
    assert {frozenset(features) for features in sets} == set(content["sets"])
    for features in sets[:2]:  # `make size` measures all
        known = content["sets"][frozenset(features)]
        found = size_measure.measure_set(features, tmp_path)
        # Another version of the compiler may differ by a few instructions.
        assert found["code"] == pytest.approx(known["code"], rel=0.03), features
        assert found["stack"] == pytest.approx(known["stack"], abs=16), features
        assert (found["data"], found["bss"]) == (0, 0)


@pytest.mark.needs(size_measure.COMPILER)
def test_an_update_rewrites_the_file_that_exports_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert parse_sizes(size_measure.SIZES.read_text()) == measured()
    one = size_measure.feature_sets()[0]
    monkeypatch.setattr(size_measure, "SIZES", tmp_path / "sizes.json")
    monkeypatch.setattr(size_measure, "feature_sets", lambda: [one])
    page = tmp_path / "page.md"
    shutil.copy(size_measure.PAGE, page)
    monkeypatch.setattr(size_measure, "PAGE", page)
    monkeypatch.setattr(size_measure, "TITLES", ["one"])
    monkeypatch.setattr(size_measure, "SETS", [sorted(one)])
    assert size_measure.main(["--update"]) == 0
    written = parse_sizes((tmp_path / "sizes.json").read_text())
    assert set(written["sets"]) == {frozenset(one)}
    assert f"| one | `{' '.join(sorted(one))}` |" in page.read_text("utf-8")

"""Robots of many parameters are exported from their recipe: no product of their axes is built."""

import math
import tracemalloc

import pytest

import lutgen
from firmware_export import choose
from firmware_export.exporter import export
from lutgen.errors import ExportError
from tests.fixtures.fits import untried
from tests.fixtures.recipes import steered

MIB = 1 << 20
EIGHT = lutgen.parse_recipe(steered().replace("= 2", "= 61"))


def test_a_robot_whose_map_would_be_petabytes_is_exported_in_bounded_memory(tmp_path, monkeypatch):
    assert len(EIGHT.parameters) == 8
    # float32 of two channels: 10 to the 14 bytes and more.
    assert 8 * EIGHT.grid.size * math.prod(EIGHT.chart.shape) > 1e14
    # Candidates are compared on a fifth of the points: what is chosen is certified anyway.
    monkeypatch.setattr(choose, "POINTS", 3000)
    tracemalloc.start()
    try:
        with untried():
            report = export(EIGHT, tmp_path / "out", codec="contacts", points=4000)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    # 8 nodes along each of 8 axes would be 128 MiB for a single number per node.
    assert peak < 100 * MIB
    found = report["certificate"]
    assert found["false_safe"] == 0
    assert found["channels"]["sdg"]["p99_percent"] <= 1.0
    assert found["false_tip"] < 0.1
    assert report.table_bytes <= 1024


def test_a_grid_of_eight_parameters_is_refused_for_their_number(tmp_path):
    with pytest.raises(ExportError, match=r"at most 6 parameters \(got 8\)") as caught:
        export(EIGHT, tmp_path / "out", codec="grid", points=1000)
    assert "\n" not in str(caught.value)
    assert "contacts" in str(caught.value)
    assert not (tmp_path / "out").exists()

"""The licence: in every file of C, and whole in every export."""

from firmware_export.emit import package
from tests.fixtures.exports import tripod_export
from tests.fixtures.places import ROOT

LINES = ["SPDX-License-Identifier: MIT", "Copyright (c) The lutgen authors"]
SOURCES = sorted(
    path
    for room in ("benchmarks", "firmware_export", "proofs", "targets")
    for path in (ROOT / room).rglob("*")
    if path.suffix in (".c", ".h", ".S", ".mjs")
)


def on_top(text):
    """Return the first two lines of a file without the marks of a comment."""
    return [line.strip("/*# ") for line in text.splitlines()[:2]]


def test_every_file_of_c_says_its_licence():
    assert SOURCES
    assert [path for path in SOURCES if on_top(path.read_text(encoding="utf-8")) != LINES] == []


def test_every_file_of_an_export_says_its_licence_and_the_export_holds_it(tmp_path):
    package.write(tripod_export("feet"), tmp_path / "out")
    texts = {path.name: path for path in (tmp_path / "out").rglob("*")}
    for name in (
        *("feet.c", "feet.h", "smap.h", "read.c", "alarm.c", "ros2_node.cpp", "feet.ino"),
        *("CMakeLists.txt", "library.properties", "module.yml"),
    ):
        assert on_top(texts[name].read_text(encoding="utf-8")) == LINES, name
    assert texts["LICENSE"].read_bytes() == (ROOT / "LICENSE").read_bytes()

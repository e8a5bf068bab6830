"""The C runtime on this machine: its bits, its structs, and what it refuses."""

import csv
import json
import shutil

import numpy as np
import pytest

from firmware_export.certify.answers import device
from firmware_export.device import ExportFolder
from firmware_export.emit import load_report, package
from firmware_export.host import Host, reader
from firmware_export.protocol import restored
from lutgen.errors import ExportError, InputError
from tests.fixtures.compiled import HostLibrary
from tests.fixtures.exports import host_of, rover_export, tripod_export
from tests.fixtures.frozen import HEAD, PLACE, rows

NAMES = sorted(path.stem for path in PLACE.glob("*.json"))
POINT = ([[0.31, 0.2]], [[0.1, 0.1, -1.0]])


@pytest.mark.parametrize("name", NAMES)
def test_the_answers_are_the_frozen_ones(name):
    held = json.loads((PLACE / f"{name}.json").read_text())
    with (PLACE / f"{name}.csv").open(newline="") as file:
        head, *known = csv.reader(file)
    assert tuple(head) == HEAD
    integer = held["integer"]

    def numbers(text):
        return [int(word, 10 if integer else 16) for word in text.split()]

    asked = [np.array([numbers(row[at]) for row in known]) for at in (0, 1)]
    host = Host(restored(held))
    if integer:
        params, gravity = (array.astype(np.int16) for array in asked)
        status, reading = host.read_i(params, gravity)
    else:
        params, gravity = (array.astype(np.uint32).view(np.float32) for array in asked)
        status, reading = host.read(params, gravity)
    assert rows(params, gravity, status, reading) == [tuple(row) for row in known]
    # Answers of every kind are among them.
    assert {0, 2, 6} <= set(status.tolist())


def test_many_queries_are_answered_in_order_whatever_the_threads(monkeypatch):
    read = device(tripod_export()).read
    rng = np.random.default_rng(1)
    params, gravity = rng.random((50_001, 2)), rng.normal(size=(50_001, 3)) - [0, 0, 2]
    found = []
    for cores in (1, 2, 7):
        monkeypatch.setattr("firmware_export.host.reader.os.cpu_count", lambda cores=cores: cores)
        found.append(read(params, gravity))
    for status, reading in found[1:]:
        np.testing.assert_array_equal(status, found[0][0])
        assert reading.tobytes() == found[0][1].tobytes()
    single = [read(params[at : at + 1], gravity[at : at + 1])[1] for at in (0, 25_000, 50_000)]
    assert np.concatenate(single).tobytes() == found[0][1][[0, 25_000, 50_000]].tobytes()


@pytest.mark.parametrize("way", ["read", "read_i"])
def test_queries_of_one_posture_are_answered_as_if_each_came_alone(way):
    export, rng = rover_export(), np.random.default_rng(4)
    host, model = host_of(export), export.model
    whole = way == "read_i"
    params = rng.integers(0, 32768, (30, model.k)) if whole else model.at(rng.random((30, model.k)))
    # Off its axis, and no number at all.
    params[7, 0] = -9 if whole else 1e9
    params[8] = 32767 if whole else np.nan
    rows = np.repeat(params, 8, axis=0).astype(np.int16 if whole else np.float32)
    downs = rng.normal(size=(len(rows), 3)) - [0.0, 0.0, 2.0]
    downs = (5000.0 * downs).clip(-32767.0, 32767.0).astype(rows.dtype)
    status, reading = host.ask(way, rows, downs)
    assert len(set(status.tolist())) >= 3
    alone = [host.ask(way, rows[at : at + 1], downs[at : at + 1]) for at in range(len(rows))]
    assert status.tolist() == [int(one[0][0]) for one in alone]
    for name in reading.dtype.names or ():
        assert reading[name].tobytes() == b"".join(one[1][name].tobytes() for one in alone), name


def test_queries_of_another_shape_are_refused():
    host = host_of(tripod_export())
    for params, gravity in (
        ([[0.1]], [[0, 0, -1]]),
        ([[0.1, 0.1]], [[0, 0]]),
        ([[0.1, 0.1]], [[0, 0, -1], [0, 0, -1]]),
        ([0.1, 0.1], [0, 0, -1]),
    ):
        with pytest.raises(InputError, match="must have the shapes"):
            host.read(params, gravity)


@pytest.fixture
def elsewhere(tmp_path, monkeypatch):
    place = shutil.copytree(reader.RUNTIME, tmp_path / "runtime")
    monkeypatch.setattr(reader, "RUNTIME", place)
    monkeypatch.setattr(reader, "load_library", reader.load_library.__wrapped__)
    return place


def test_without_the_library_one_sentence_says_how_to_build_it(elsewhere):
    for path in elsewhere.glob("_host*"):
        path.unlink()
    with pytest.raises(ExportError, match=r"install a C compiler, then lutgen again"):
        reader.load_library()


def test_a_library_of_other_sources_is_refused(elsewhere):
    assert reader.load_library().smap_points_host_sources()
    path = elsewhere / "smap_three.h"
    path.write_text(path.read_text() + "\n/* changed */\n")
    with pytest.raises(ExportError, match="was built from other files"):
        reader.load_library()


@pytest.fixture
def folder(tmp_path):
    package.write(tripod_export("feet"), tmp_path / "feet")
    return tmp_path / "feet"


def test_a_folder_is_read_without_a_compiler(folder, monkeypatch):
    status, reading = HostLibrary(folder).read(*POINT)
    monkeypatch.setenv("PATH", "")
    monkeypatch.setenv("CC", "no-such-compiler")
    found = ExportFolder(folder).host.read(*POINT)
    assert found[0].tolist() == status.tolist() == [0]
    assert found[1].tobytes() == reading.tobytes()


def test_a_folder_whose_c_file_was_changed_is_refused(folder):
    path = folder / "feet.c"
    path.write_text(path.read_text().replace("SMAP_SERIES 0", "SMAP_SERIES 1", 1))
    with pytest.raises(InputError, match=r"feet\.c: is not the file that was exported"):
        ExportFolder(folder)
    path.unlink()
    with pytest.raises(InputError, match=r"feet\.c: cannot be read"):
        ExportFolder(folder)


def test_a_folder_with_damaged_tables_or_without_any_is_refused(folder):
    report = load_report(folder)
    tables = report.pop("tables")
    short = {"blob": "fW3MEwwAAAADAQIA"}  # of the right CRC-32, codec and parameters
    changes = ({"blob": 3}, {"blob": "AAAAAAAA"}, short, {"codec": "first"}, {"params": 3})
    wrong = [{**tables, **one} for one in changes]
    for damaged in (*({"tables": one} for one in (*wrong, {"source_sha256": "0"})), {}):
        (folder / "feet_report.json").write_text(json.dumps(report | damaged))
        with pytest.raises(InputError, match="the tables of its report are damaged"):
            ExportFolder(folder)

"""The matrix of emulated targets: its pure parts, its gate, and one small run."""

import re
import struct
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from firmware_export.certify.answers import device
from firmware_export.emit import package
from firmware_export.emit.source import body_of
from firmware_export.host import Host
from firmware_export.host.reader import READING, READING_I
from firmware_export.protocol import describe
from lutgen.errors import ExportError
from proofs.exports import tripod_export
from targets import baseline, cases, image, queries, run, tables
from targets.boards import board
from targets.compiled import HostLibrary
from targets.digest import START, answer_bytes, answers, fnv1a
from targets.footprint import Footprint

needs_arm = pytest.mark.needs(*board("m4f").packages)


# The hash


def test_the_hash_is_fnv_1a() -> None:
    # Vectors of the FNV page's test suite.
    assert fnv1a(b"") == START == 0x811C9DC5
    assert fnv1a(b"foobar") == 0xBF9CF968
    assert fnv1a(b"bar", fnv1a(b"foo")) == fnv1a(b"foobar")


def readings(sdg: float, tip: float, height: float) -> np.ndarray[Any, Any]:
    row = np.zeros(1, READING)
    row[0] = (sdg, tip, height, (1, 255))
    return row


def test_answers_are_hashed_as_the_structs_lie_in_memory() -> None:
    reading = readings(1.5, -2.0, np.nan)
    bits = struct.pack("<bffIBB", -1, 1.5, -2.0, reading["height"].view(np.uint32)[0], 1, 255)
    assert answer_bytes(np.array([-1], np.int8), reading).tobytes() == bits
    whole = np.zeros(1, READING_I)
    whole[0] = (65535, -32767, 3, (0, 2))
    expected = struct.pack("<bHhHBB", 2, 65535, -32767, 3, 0, 2)
    assert answer_bytes(np.array([2], np.int8), whole).tobytes() == expected


def test_one_bit_of_one_answer_changes_the_hash() -> None:
    reading = np.zeros(1000, READING)
    other = reading.copy()
    other["tip_angle"].view(np.uint32)[500] ^= 1
    status = np.zeros(1000, np.int8)
    one, two = (answer_bytes(status, rows).tobytes() for rows in (reading, other))
    assert fnv1a(one) != fnv1a(two)


def test_every_call_of_the_api_is_in_the_hash() -> None:
    asked, whole = small_queries()
    host = Host(describe(tripod_export(), body_of(tripod_export())))
    found = answers(host, True, True, asked, whole)
    # smap_read, smap_pose, smap_at, smap_at_n; smap_at_i of both poses, and smap_read_i.
    assert len(found) == len(asked[0]) * (15 + 1 + 15 + 15 + 3 * 9)
    rows = np.frombuffer(found, np.uint8).reshape(len(asked[0]), -1)
    np.testing.assert_array_equal(rows[:, :15], rows[:, 16:31])  # read is pose and at
    assert len(answers(host, True, False, asked, whole)) == len(asked[0]) * 46


def small_queries() -> tuple[Any, Any]:
    """Return ten ordinary queries of the tripod, in floats and as whole numbers."""
    params, gravity = (rows[:10] for rows in queries.counted(tripod_export()))
    return (params, gravity), queries.whole(tripod_export(), params, gravity)


# The queries


def test_the_queries_bring_out_every_answer_and_both_sides_of_tipping() -> None:
    export = tripod_export()
    params, gravity = queries.checked(export)
    assert params.shape == (1000, 2)
    assert gravity.shape == (1000, 3)
    status, reading = device(export).read(params, gravity)
    for said in (-1, 0, 2, 3, 5):
        assert (status == said).sum() >= 5
    near = reading[700:900, 1][np.isin(status[700:900], (0, 2, 4))]
    # Bisected to neighbouring floats, which are 1e-7 rad apart, and as many again.
    assert np.median(np.abs(near)) < 1e-5
    assert (near >= 0.0).sum() >= 50
    assert (near < 0.0).sum() >= 50
    everything = np.concatenate([params.ravel(), gravity.ravel()])
    assert np.isnan(everything).any()
    assert np.isinf(everything).any()
    assert ((np.abs(everything) > 0) & (np.abs(everything) < 1e-38)).any()
    assert (gravity == 0.0).all(axis=1).any()


def test_the_queries_of_the_counts_lie_inside_but_for_the_last_32() -> None:
    export = tripod_export()
    params, gravity = queries.counted(export)
    assert len(params) == 256
    status, _ = device(export).read(params, gravity)
    assert not np.isin(status[:-32], (-1, 3, 5)).any()
    assert np.isin(status[-32:], (3, 5)).any()


def test_the_queries_are_the_same_every_time_and_stored_bit_for_bit() -> None:
    export = tripod_export()
    params, gravity = queries.checked(export)
    first, second = (queries.as_bytes(export, *queries.checked(export)) for _ in range(2))
    assert first == second
    # Five floats, five whole numbers, and one that fills up the word.
    rows = np.frombuffer(first, np.dtype([("real", "<u4", 5), ("whole", "<i2", 5), ("_", "<i2")]))
    assert rows.itemsize == queries.row_bytes(2, floats=True)
    real = np.concatenate([params, gravity], axis=1)
    np.testing.assert_array_equal(rows["real"], real.view(np.uint32))
    np.testing.assert_array_equal(
        rows["whole"], np.concatenate(queries.whole(export, params, gravity), axis=1)
    )


def test_whole_numbers_tell_the_same_posture_and_direction_as_the_floats() -> None:
    (params, gravity), (steps, down) = small_queries()
    model = tripod_export().model
    share = (params - model.lower) / (model.upper - model.lower)
    np.testing.assert_allclose(steps / 32767.0, share, atol=0.51 / 32767.0)  # half a step
    lengths = np.linalg.norm(gravity, axis=1) * np.linalg.norm(down.astype(float), axis=1)
    cosine = (gravity * down).sum(axis=1) / lengths
    long = np.abs(down).max(axis=1) > 1000  # those of few counts are rounded further
    assert long.any()
    assert cosine[long].min() > 1.0 - 1e-6
    odd = queries.whole(tripod_export(), params[:1] * np.nan, gravity[:1] * np.nan)
    assert odd[0].min() == -32767
    assert np.isin(odd[1], (-32768, 32767)).all()


# The rows


def test_a_folder_of_another_export_is_not_taken_for_that_of_its_recipe(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cases, "ROOT", tmp_path)
    monkeypatch.setattr(cases, "BUILD", tmp_path / "targets")
    export = tripod_export()
    package.write(export, tmp_path / "made")
    case = cases.Case("tripod", lambda: export, tmp_path / "made")
    _, folder = cases.written(case)
    source = tmp_path / "made" / "tripod.c"
    assert (folder / "tripod.c").read_text() == source.read_text()
    source.write_text(one_bit_wrong(source.read_text()))
    with pytest.raises(ExportError, match="another export than that of its recipe"):
        cases.written(case)


def one_bit_wrong(text: str) -> str:
    """Return NAME.c with one bit of the last byte of its blob turned round."""
    found = re.search(r"(\d+),\s*\};", text)
    assert found is not None
    return text[: found.start(1)] + str(int(found[1]) ^ 1) + text[found.end(1) :]


# What is skipped


def test_a_missing_compiler_is_a_loud_skip_and_a_failure_in_ci(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("targets.boards.shutil.which", lambda name: None)
    monkeypatch.setattr(run, "prepared", lambda case: row(tmp_path))
    monkeypatch.delenv("CI", raising=False)
    monkeypatch.setattr(baseline, "compare", lambda *whatever: ([], []))
    arguments = ["--only", "rv32imc", "--export", "paper_two"]
    assert run.main(arguments) == 0
    said = capsys.readouterr().out
    assert "SKIPPED RV32IMC: not installed: apt-get install gcc-riscv64-unknown-elf" in said
    assert "1 targets skipped" in said
    assert run.main([*arguments, "--strict"]) == 1
    monkeypatch.setenv("CI", "true")
    assert run.main(arguments) == 1


def row(folder: Path) -> run.Row:
    """Return a row of a small export, its hashes right."""
    export = tripod_export()
    package.write(export, folder / "firmware")
    asked = queries.checked(export)
    host = Host(describe(export, body_of(export)))
    right = fnv1a(answers(host, True, True, asked, queries.whole(export, *asked)))
    rows = queries.as_bytes(export, *asked) + queries.as_bytes(export, *queries.counted(export))
    job = image.Job(folder / "firmware", export.name, 2, True, True, rows, 1000, 256)
    case = cases.Case("tripod", lambda: export)
    return run.Row(case, export, job, right, right, job, right)


def test_a_wrong_hash_and_a_failed_cell_are_failures(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    one = row(tmp_path)

    def fake(job: image.Job, on: Any, option: str) -> image.Outcome:
        if option == "-Os":
            raise image.CellError("qemu: said nothing")
        return image.Outcome(one.wanted ^ 1, {"at": [5, 6, 7]}, Footprint(1, 2), 80, 40)

    monkeypatch.setattr(run, "execute", fake)
    monkeypatch.setattr(run, "version", lambda on: "1")
    monkeypatch.setattr("targets.boards.shutil.which", lambda name: name)
    matrix = run.Matrix([one], [board("m4f")])
    matrix.run(1)
    assert matrix.verdicts == {"tripod": {"m4f": ["FAIL", "FAIL"]}}
    assert matrix.failures == [
        f"tripod m4f -O2: hash {one.wanted ^ 1:08x}, the host's is {one.wanted:08x}",
        "tripod m4f -Os: qemu: said nothing",
    ]
    assert "FAIL" in tables.hashes(matrix.verdicts, {"tripod": ("0", "ok")})


def test_a_sample_compiles_every_export_and_every_board_in_both_ways_but_each_cell_in_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    one = row(tmp_path)
    rows = [replace(one, case=replace(one.case, name=name)) for name in ("a", "b")]
    asked = list[tuple[str, str]]()

    def fake(job: image.Job, on: Any, option: str) -> image.Outcome:
        asked.append((on.name, option))
        return image.Outcome(one.wanted, {"at": [5]}, Footprint(1, 2), 80, 40)

    monkeypatch.setattr(run, "execute", fake)
    monkeypatch.setattr(run, "version", lambda on: "1")
    monkeypatch.setattr("targets.boards.shutil.which", lambda name: name)
    boards = [board(name) for name in ("m4f", "m0", "rv32imc")]
    matrix = run.Matrix(rows, boards, sample=True)
    matrix.run(1)
    assert matrix.failures == []
    both = {"-O2", "-Os"}
    found = {name: list(one["boards"].values()) for name, one in matrix.found["rows"].items()}
    assert sorted(asked) == sorted(
        [("m4f", option) for option in both] * 2 + [(n, o) for n in ("m0", "rv32imc") for o in both]
    )
    for cells in found.values():
        assert [len(options) for options in cells] == [2, 1, 1]
        assert {option for options in cells[1:] for option in options} == both


# The run itself


@needs_arm
def test_an_emulated_m4f_answers_as_the_host_does(tmp_path: Path) -> None:
    one = row(tmp_path)
    params, gravity = queries.checked(one.export)
    certified, own = device(one.export).read, HostLibrary(one.job.folder).read
    for expected, found in zip(certified(params, gravity), own(params, gravity), strict=True):
        assert expected.tobytes() == found.tobytes()
    first = image.execute(one.job, board("m4f"), "-O2")
    assert first.hash == one.wanted
    assert {call: len(counts) for call, counts in first.counts.items()} == dict.fromkeys(
        ("pose", "both", "at", "at_i", "read"), 256
    )
    assert min(min(counts) for counts in first.counts.values()) > 20
    # A posture is made once, and then read for less.
    assert max(first.counts["at"]) < max(first.counts["read"])
    # The counts of an emulator are exact, so a second run has the same.
    assert image.execute(one.job, board("m4f"), "-O2") == first


@pytest.mark.needs(*board("mega328p").packages)
def test_a_pose_at_an_odd_address_of_an_avr_reads_as_on_the_host(tmp_path: Path) -> None:
    one = row(tmp_path)
    assert image.execute(replace(one.job, counted=1), board("mega328p"), "-Os").hash == one.wanted


@needs_arm
def test_an_image_with_one_wrong_bit_in_a_table_has_another_hash(tmp_path: Path) -> None:
    one = row(tmp_path)
    source = one.job.folder / "tripod.c"
    source.write_text(one_bit_wrong(source.read_text()))
    job = replace(one.job, counted=1)
    assert image.execute(job, board("m4f"), "-Os").hash != one.wanted


@needs_arm
def test_what_does_not_compile_is_a_failed_cell(tmp_path: Path) -> None:
    one = row(tmp_path)
    (one.job.folder / "smap.c").write_text("int x = ;\n")
    with pytest.raises(image.CellError, match="error: expected expression"):
        image.execute(one.job, board("m4f"), "-O2")


def test_what_a_board_is_not_asked_is_an_empty_cell_and_no_failure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    one = row(tmp_path)
    one = replace(one, case=replace(one.case, without=("m3",)))
    monkeypatch.setattr(run, "version", lambda on: "1")
    monkeypatch.setattr("targets.boards.shutil.which", lambda name: name)
    matrix = run.Matrix([one], [board("m3")])
    matrix.run(1)
    assert matrix.failures == []
    assert matrix.verdicts == {"tripod": {"m3": ["-"]}}
    assert matrix.found["rows"]["tripod"]["boards"]["m3"] == {"-O2": {}}


# Beside CMSIS-DSP

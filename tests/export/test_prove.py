"""Proofs that exports on three points are never falsely safe, and the program that checks them."""

import hashlib
import json
import math
import zlib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from firmware_export.contacts import INFO
from firmware_export.emit import write
from firmware_export.emit.source import body_of
from firmware_export.exporter import proved
from firmware_export.host import Host
from firmware_export.protocol import Blob, Export, describe
from firmware_export.prove import Statement, intervals, record, state
from firmware_export.prove.blob import held
from firmware_export.prove.intervals import Interval
from firmware_export.prove.motion import Waves
from firmware_export.prove.search import problem_of
from firmware_export.truth import Model
from lutgen.recipe import load_recipe, parse_recipe
from proofs import check_proof, faults
from tests.fixtures.commands import run
from tests.fixtures.exports import rover_export, tripod_export
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import tripod


@pytest.fixture(scope="module")
def maps() -> list[tuple[Model, Blob]]:
    """Return a map of each codec, with the guard that its proof needs."""
    return faults.proved_maps()


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of paper_two's export, with its proof."""
    folder = tmp_path_factory.mktemp("prove") / "two"
    export = proved(_export(load_recipe(MAPS / "paper_two.toml")))
    write(export, folder)
    assert run("prove", folder).exit_code == 0
    return folder


def _export(recipe: Any) -> Export:
    model = Model(recipe)
    made = tripod_export("paper_two")
    tables = INFO.encode(model, made.channels, INFO.sizes(model, made.channels, "float")[0])
    return replace(made, recipe=recipe, model=model, tables=tables)


def test_intervals_hold_sines_and_products_of_what_they_hold() -> None:
    rng = np.random.default_rng(1)
    a, b = np.sort(rng.normal(size=(2, 400)) * 8.0, axis=0)
    x = Interval(a, b)
    inside = a + (b - a) * rng.random((50, 400))
    for wave, exact in ((intervals.sine, np.sin), (intervals.cosine, np.cos)):
        found = wave(x)
        assert np.all(found.low <= exact(inside) + 1e-15)
        assert np.all(found.high >= exact(inside) - 1e-15)
    other = inside[::-1]
    product = x * x
    assert np.all((product.low <= inside * other) & (inside * other <= product.high))


def test_exact_positions_hold_those_of_the_kinematics() -> None:
    recipe = parse_recipe(tripod())
    model = Model(recipe)
    params = model.at(np.random.default_rng(2).random((50, model.k)))
    blob = describe(tripod_export(), body_of(tripod_export())).bytes
    problem = problem_of(recipe, held(blob), False)
    waves = Waves.over(Interval.of(params.T.copy()))
    centres = model.postures(params).centres[:, list(held(blob).order)]
    for at, truth in enumerate(problem.truth):
        found = waves.value(truth)
        assert np.all(np.abs(found.low - centres[:, at].T) < 1e-12)
        assert np.all(found.high >= found.low)


def test_positions_of_the_c_are_no_further_off_than_was_bounded() -> None:
    export = tripod_export()
    blob = describe(export, body_of(export))
    map_ = held(blob.bytes)
    problem = problem_of(export.recipe, map_, False)
    low, high = problem.box.T
    params = low + (high - low) * np.random.default_rng(3).random((4000, len(low)))
    params = params.astype(np.float32).astype(np.float64)
    true = export.model.postures(params).centres[:, list(map_.order)].reshape(-1, 9)
    off = Host(blob).positions(params).reshape(-1, 9) - true
    bound = problem.stored.off(Waves.over(Interval.of(params.T.copy())))
    room = problem.stored.errors[:, None] + 1e-13
    assert np.all((bound.low - room <= off.T) & (bound.high + room >= off.T))
    # Not by orders of magnitude, or the guard would be more than is needed.
    assert problem.stored.errors.max() < 20.0 * np.abs(off).max()


def test_every_codec_is_proved_with_a_guard_that_a_search_comes_near(
    maps: list[tuple[Model, Blob]],
) -> None:
    rng = np.random.default_rng(4)
    for model, blob in maps:
        stated = state(model.recipe, blob.bytes, blob.integer)
        assert stated.proved, stated.reason
        assert stated.needed <= stated.guard
        assert faults.search(model, blob, rng) == 0
    # With half of its guard the polynomials' map is falsely safe, and so not proved.
    model, blob = maps[1]
    less = _with_guard(blob, 0.5)
    assert not state(model.recipe, less.bytes, False).proved
    assert any(faults.search(model, less, rng) for _ in range(4))


def _with_guard(blob: Blob, part: float) -> Blob:
    packed = bytearray(blob.bytes)
    guard = np.frombuffer(blob.bytes, "<f4", 1, 20)[0] * np.float32(part)
    packed[20:24] = np.float32(guard).tobytes()
    return replace(blob, bytes=zlib.crc32(packed[4:]).to_bytes(4, "little") + packed[4:])


def test_no_fault_that_a_search_finds_unsafe_is_proved(maps: list[tuple[Model, Blob]]) -> None:
    rng = np.random.default_rng(5)
    seen = []
    for model, blob in maps[:1] * 3 + maps[3:] * 3:
        verdict = faults.judge(model, faults.seeded(blob, rng), rng)
        assert not (verdict.proved and verdict.unsafe)
        seen.append(verdict)
    assert any(one.proved for one in seen), "a prover that always says no proves nothing"
    assert any(one.unsafe for one in seen), "faults that do nothing test nothing"


def test_many_contacts_and_code_are_told_what_stands_in_the_way() -> None:
    rover = rover_export()
    found = state(rover.recipe, describe(rover, body_of(rover)).bytes, False)
    assert (found.proved, found.told["status"]) == (False, "tested")
    assert "three contact points" in found.reason


def test_a_folder_of_many_contacts_is_answered_without_a_traceback(tmp_path: Path) -> None:
    write(rover_export(), tmp_path / "rover")
    said = run("prove", tmp_path / "rover")
    assert said.exit_code == 1
    assert said.stdout.startswith("not proved, guard ")
    assert not list((tmp_path / "rover").glob("*_proof.json"))
    assert run("prove", tmp_path).exit_code == 2


def test_paper_two_is_proved_with_a_guard_below_a_third_of_a_degree(two: Path) -> None:
    answer = run("prove", two, "--json")
    report = json.loads(answer.stdout)
    assert report["status"] == "proved"
    assert report["guard_deg"] < 0.0005
    assert report["needed_deg"] <= report["guard_deg"] <= 1.0001 * report["needed_deg"]
    assert "Proved never to be falsely safe" in (two / "paper_two.h").read_text()
    assert "Proved never to be falsely safe" in (two / "paper_two_report.md").read_text()


def test_the_same_export_gives_the_same_proof(two: Path, tmp_path: Path) -> None:
    assert run("prove", two, "-o", tmp_path / "again.json").exit_code == 0
    assert (tmp_path / "again.json").read_bytes() == (two / "paper_two_proof.json").read_bytes()


def test_a_recipe_that_was_changed_in_the_report_is_refused(two: Path, tmp_path: Path) -> None:
    for path in two.glob("paper_two*"):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    report = tmp_path / "paper_two_report.json"
    report.write_text(report.read_text().replace("max = 50.0", "max = 45.0", 1))
    answer = run("prove", tmp_path)
    assert answer.exit_code == 2
    assert "the recipe of its report was changed" in answer.stderr


def test_another_program_finds_the_proof_right(
    two: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert check_proof.main(two) == 0
    assert capsys.readouterr().out.startswith("proved: ")


def _lower_guard(proof: dict[str, Any], source: str) -> str:
    """Return a C file whose guard is 0.9 of what it was: its bytes are 20 to 23."""
    first = source.index("guard, rad */")
    begin = source.index("\n", first) + 1
    end = source.index("\n", begin)
    guard = np.array([int(x) for x in source[begin:end].split(",") if x.strip()], np.uint8)
    less = (guard.view("<f4") * np.float32(0.9)).view(np.uint8)
    return source[:begin] + "  " + ",".join(map(str, less)) + "," + source[end:]


@pytest.mark.parametrize("fault", ["guard", "file", "cells", "link", "trail"])
def test_another_program_finds_a_wrong_proof_wrong(fault: str, two: Path, tmp_path: Path) -> None:
    proof = json.loads((two / "paper_two_proof.json").read_text())
    source = (two / "paper_two.c").read_text()
    if fault == "guard":
        source = _lower_guard(proof, source)
        proof["source_sha256"] = hashlib.sha256(source.encode()).hexdigest()
    elif fault == "file":
        source += "\n"
    elif fault == "cells":
        proof["cuts"][0][-1] -= 1e-4
    elif fault == "link":
        proof["links"][0]["rpy"][0] += 1e-6
    else:
        proof["trail"] += "."
    (tmp_path / "paper_two.c").write_text(source)
    (tmp_path / "paper_two_proof.json").write_text(json.dumps(proof))
    assert check_proof.main(tmp_path) == 1


def test_a_guard_is_stored_no_smaller_than_was_proved() -> None:
    export = proved(tripod_export())
    assert export.proof is not None
    assert export.proof["status"] == "proved"
    assert float(np.float32(export.tables.guard)) == export.tables.guard
    assert math.degrees(export.tables.guard) >= export.proof["needed_deg"]
    found = state(export.recipe, describe(export, body_of(export)).bytes, False)
    assert isinstance(found, Statement)
    assert record(export.recipe, found, "tripod", "0")["cells"] == export.proof["cells"]

"""The proofs of the C runtime and of exports: one seeded fault that each of them finds."""

import shutil

import numpy as np
import pytest

from firmware_export.host import RUNTIME
from firmware_export.protocol import describe
from lutgen.recipe import load_recipe
from proofs import eva, exhaustive, fuzz, run, structure
from proofs.prove import __main__ as proved
from proofs.prove.held import CannotProveError, Map
from proofs.prove.search import prove
from proofs.subjects import made
from proofs.tools import FAILED, OK
from tests.fixtures.exports import rover_export
from tests.fixtures.places import MAPS

PATIENCE = 300.0


def faulty(folder, name, text, instead):
    """Return a copy of the runtime with one text replaced in one part."""
    parts = folder / "parts"
    shutil.copytree(RUNTIME, parts, ignore=shutil.ignore_patterns("*.so"))
    changed(parts / name, text, instead)
    return parts


def changed(path, text, instead):
    source = path.read_text()
    assert text in source
    path.write_text(source.replace(text, instead))


@pytest.fixture
def points(tmp_path):
    return made("paper_two", tmp_path / "exports")


@pytest.mark.needs("frama-c", "gcc")
def test_eva_finds_an_index_that_goes_one_too_far(tmp_path):
    subject = made("tables_integer", tmp_path / "exports")
    source = subject.folder / f"{subject.name}.c"
    changed(source, "cell[k] = x >> 16;", "cell[k] = (x >> 16) + 1u;")
    (tmp_path / "eva").mkdir()
    found = eva.prove(subject, tmp_path / "eva", PATIENCE)
    assert found.state == FAILED
    assert "alarms" in found.text


@pytest.mark.needs("gcc")
@pytest.mark.parametrize(
    ("name", "text", "instead"),
    [
        ("root", "digits += digits & 1u;", "digits += 0u;"),
        ("whole_root", "8u + 1u;\n    result = (result + odd / result) >> 1;", "8u + 1u;"),
    ],
)
def test_trying_everything_finds_a_root_that_is_off(name, text, instead, tmp_path):
    parts = faulty(tmp_path, "smap_core.h", text, instead)
    # 127 divides 0x3F80, the upper half of 1.0f, beside which faults of guards are.
    found = {row.subject: row for row in exhaustive.prove(tmp_path, PATIENCE, 127, parts)}
    # Arcsines are made of roots.
    also = {"arcsine"} if name == "root" else set()
    assert {key for key, row in found.items() if row.state == FAILED} == {name} | also


@pytest.mark.needs("clang", "gcc")
def test_the_fuzzer_finds_a_reading_that_tips_and_is_said_to_stand(points, tmp_path):
    length = fuzz.Length(runs=500)
    assert fuzz.fuzz(points, tmp_path / "right", length).state == OK
    source = points.folder / f"{points.name}.c"
    changed(source, "return stands ? good : (int8_t)SMAP_TIPS;", "return good;")
    found = fuzz.fuzz(points, tmp_path / "wrong", fuzz.Length(runs=500_000))
    assert "broken claim" in found.text


@pytest.mark.needs("clang", "gcc")
def test_the_fuzzer_finds_a_check_that_looks_at_no_size(points, tmp_path):
    source = points.folder / f"{points.name}.c"
    changed(source, "smap_check_positions(map, limit)", "1")
    found = fuzz.fuzz(points, tmp_path / "wrong", fuzz.Length(seconds=60), "damage")
    assert found.state == FAILED


@pytest.mark.needs("gcc")
def test_globals_recursion_and_library_calls_are_found(tmp_path):
    more = (
        "\nstatic volatile int reads;\nvoid extra(int n);\n#include <stdlib.h>\n"
        "void extra(int n)\n{\n  reads += n + rand();\n  for (;;) {\n    extra(n - 1);\n  }\n}\n"
    )
    text = (RUNTIME / "smap_grid.c").read_text()
    parts = faulty(tmp_path, "smap_grid.c", text, text + more)
    rows = {row.subject: row for row in structure.prove(tmp_path, PATIENCE, parts)}
    assert {name for name, row in rows.items() if row.state == FAILED} == {"loops", "object code"}
    for said in ("reads can be written", "rand of a library", "calls itself"):
        assert said in rows["object code"].text


def test_what_is_missing_is_skipped_and_fails_in_ci(monkeypatch, capsys):
    monkeypatch.setattr("proofs.run.shutil.which", lambda name: None)
    monkeypatch.delenv("CI", raising=False)
    assert run.main(["--only", "structure"]) == 0
    assert "SKIPPED" in capsys.readouterr().out
    monkeypatch.setenv("CI", "true")
    assert run.main(["--only", "structure"]) == 1


CONTACTS, GRID = "paper_two: contacts, float", "paper_one: grid i8 1 4 1, integer"


@pytest.mark.parametrize("row", [CONTACTS, GRID])
def test_an_export_is_proved_and_none_whose_entry_is_shifted(row):
    recipe, blob, integer = proved.made(row)
    whole = prove(recipe, blob, integer)
    assert whole.reason == ""
    assert 0.0 < whole.guard < 0.01
    # The height of the leg that no joint moves, by one of its codes; or a weight by 1e-5.
    wrong = bytearray(blob)
    if integer:
        wrong[-1] += 1
    else:
        first = Map(blob, False).at + 22
        weight = np.frombuffer(blob, "<f4", 1, first)[0] * np.float32(1.0 + 1e-5)
        wrong[first : first + 4] = np.float32(weight).tobytes()
    found = prove(recipe, bytes(wrong), integer)
    assert "deg is needed" in found.reason or "not known" in found.reason
    if not integer:
        # A guard that is too small.
        less = bytearray(blob)
        less[20:24] = (np.frombuffer(blob, "<f4", 1, 20)[0] * np.float32(0.3)).tobytes()
        assert "deg is needed" in prove(recipe, bytes(less), False).reason


def test_what_the_lemmas_say_nothing_about_is_refused():
    rover = rover_export()
    with pytest.raises(CannotProveError, match="not one of three points"):
        prove(rover.recipe, describe(rover).bytes, False)
    _, blob, _ = proved.made(CONTACTS)
    with pytest.raises(CannotProveError, match="contacts or parameters"):
        prove(load_recipe(MAPS / "paper_one.toml"), blob, False)

"""Proofs that exports on three points are never falsely safe, and a fault that they find."""

from pathlib import Path

import numpy as np
import pytest

from firmware_export.emit import write
from firmware_export.host import Host
from firmware_export.protocol import describe
from lutgen.recipe import load_recipe
from proofs.prove.__main__ import MAPS, made, main
from proofs.prove.held import CannotProveError, Map, Points
from proofs.prove.motion import Postures, contacts_of
from proofs.prove.search import prove
from tests.fixtures.exports import rover_export, tripod_export

CONTACTS, GRID = "paper_two: contacts, float", "paper_one: grid i8 1 4 1, integer"


def test_positions_of_the_c_are_no_further_off_than_was_bounded() -> None:
    export = tripod_export()
    blob = describe(export)
    map_ = Map(blob.bytes, False)
    stored = Points(map_, contacts_of(export.recipe, map_.order))
    low, high = np.array(map_.box).T
    params = low + (high - low) * np.random.default_rng(3).random((60, len(low)))
    params = params.astype(np.float32).astype(np.float64)
    centres = export.model.postures(params).centres[:, map_.order].reshape(-1, 9)
    seen = Host(blob).positions(params).reshape(-1, 9)
    worst = 0.0
    for at, true, held in zip(params, centres, seen, strict=True):
        truth, off = stored.compared(Postures([(x, x) for x in at]))
        for i in range(9):
            # The kinematics are right to some 1e-15 of lengths of 1.
            assert abs(float(truth[i].middle) - true[i]) < 1e-13
            away = abs(held[i] - true[i] - float(off[i].middle))
            assert away <= float(stored.errors[i]) + 1e-13
            worst = max(worst, away)
    # Not by orders of magnitude, or the guard would be more than is needed.
    assert max(map(float, stored.errors)) < 20.0 * worst


@pytest.mark.parametrize("row", [CONTACTS, GRID])
def test_an_export_is_proved_and_none_whose_entry_is_shifted(row: str) -> None:
    recipe, blob, integer = made(row)
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


def test_a_guard_that_is_too_small_is_not_proved() -> None:
    recipe, blob, _ = made(CONTACTS)
    less = bytearray(blob)
    less[20:24] = (np.frombuffer(blob, "<f4", 1, 20)[0] * np.float32(0.3)).tobytes()
    assert "deg is needed" in prove(recipe, bytes(less), False).reason


def test_what_the_lemmas_say_nothing_about_is_refused() -> None:
    rover = rover_export()
    with pytest.raises(CannotProveError, match="not one of three points"):
        prove(rover.recipe, describe(rover).bytes, False)
    _, blob, _ = made(CONTACTS)
    with pytest.raises(CannotProveError, match="contacts or parameters"):
        prove(load_recipe(MAPS / "paper_one.toml"), blob, False)


def test_folders_are_proved_from_their_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write(tripod_export(), tmp_path / "tripod")
    write(rover_export(), tmp_path / "rover")
    assert main([str(tmp_path / "tripod")]) == 0
    assert " cells, " in capsys.readouterr().out
    assert main([str(tmp_path / "rover")]) == 1
    assert "NOT proved" in capsys.readouterr().out

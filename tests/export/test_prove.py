"""Proofs that exports on three points are never falsely safe, and a fault that they find."""

import numpy as np
import pytest

from firmware_export.protocol import describe
from lutgen.recipe import load_recipe
from proofs.prove.__main__ import MAPS, made
from proofs.prove.held import CannotProveError, Map
from proofs.prove.search import prove
from tests.fixtures.exports import rover_export

CONTACTS, GRID = "paper_two: contacts, float", "paper_one: grid i8 1 4 1, integer"


@pytest.mark.parametrize("row", [CONTACTS, GRID])
def test_an_export_is_proved_and_none_whose_entry_is_shifted(row):
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
    if not integer:
        # A guard that is too small.
        less = bytearray(blob)
        less[20:24] = (np.frombuffer(blob, "<f4", 1, 20)[0] * np.float32(0.3)).tobytes()
        assert "deg is needed" in prove(recipe, bytes(less), False).reason


def test_what_the_lemmas_say_nothing_about_is_refused():
    rover = rover_export()
    with pytest.raises(CannotProveError, match="not one of three points"):
        prove(rover.recipe, describe(rover).bytes, False)
    _, blob, _ = made(CONTACTS)
    with pytest.raises(CannotProveError, match="contacts or parameters"):
        prove(load_recipe(MAPS / "paper_one.toml"), blob, False)

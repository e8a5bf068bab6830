"""Robots given by code: their positions as series over pieces, and what these may promise."""

import functools
from dataclasses import replace

import numpy as np
import pytest

from firmware_export.certify.answers import device
from firmware_export.certify.certificate import certify
from firmware_export.codecs import usable
from firmware_export.contacts import codec as contacts
from firmware_export.contacts.series import series_of
from firmware_export.model import Model, widened
from lutgen.errors import InputError
from lutgen.quantities import EXPORTABLE
from lutgen.recipe import robot_size_of
from tests.fixtures.exports import off_at
from tests.fixtures.linkage import COARSEST, coded

OK = 0


@functools.cache
def export_of(name, error=None):
    spec = contacts.Spec(error or COARSEST.get(name, 3e-4))
    return contacts.INFO.export(Model(coded(name)), "robot", EXPORTABLE, spec=spec)


@pytest.mark.parametrize("name", COARSEST)
def test_no_contact_is_further_off_than_was_said_at_100_000_postures(name):
    for error in (COARSEST[name], 3e-6):
        one = export_of(name, error)
        said = contacts.off_of(one.model, one.tables.spec, one.tables.terms)
        places = np.random.default_rng(41).random((100_000, one.model.k))
        seen = off_at(one, widened(one.model).at(places).astype(np.float32)).max()
        assert seen <= said
        # A bound of ten times what is seen would be of little use; the error asked for is kept.
        assert said < 10.0 * seen
        assert said <= 4.0 * error * robot_size_of(one.recipe)


@pytest.mark.parametrize("name", ["legs", "wheels"])
def test_the_worst_points_of_the_truth_find_no_false_safe(name):
    one = export_of(name)
    found = certify(device(one), EXPORTABLE, points=12_000)
    assert found.false_safe == 0
    assert found.standing > 1000
    # A guard that leaves out what contacts are off would be found.
    bold = replace(one, tables=replace(one.tables, guard=4e-6))
    assert name != "legs" or certify(device(bold), EXPORTABLE, points=12_000).false_safe > 0


def test_axes_are_cut_where_the_function_has_a_kink_and_nowhere_else():
    terms = export_of("stops").tables.terms
    assert [len(one) for one in terms.knots] == [3, 2]
    assert terms.knots[0][1] == pytest.approx(0.37, abs=1e-6)
    # Without the cut next to a kink: five times the bytes and more.
    assert export_of("stops").body.bytes < 120


def test_what_no_series_hold_is_refused_in_one_sentence():
    for name, reason in (
        ("latched", "jump (by 0.05 where reach is 0.37)"),
        ("one_way", "kinks along no axis"),
    ):
        found = str(contacts.INFO.refusal(Model(coded(name)), "float"))
        assert reason in found
        assert "\n" not in found
    assert [info.name for info in usable(Model(coded("latched")), "integer")] == ["grid"]
    recipe = coded("scissors")
    more = replace(recipe.parameters[0], name="more")
    four = replace(recipe, parameters=(*recipe.parameters, more), function=lambda q: four)
    with pytest.raises(InputError, match=r"at most 3 parameters \(got 4\)"):
        series_of(Model(four), (0, 1, 2), 1e-3)


def test_positions_of_a_robot_without_parameters_are_constants():
    recipe = coded("scissors")
    contacts_, com = recipe.function(np.array([[1.0, 0.0, 0.1]]))

    def still(q):
        return np.repeat(contacts_, len(q), axis=0), np.repeat(com, len(q), axis=0)

    model = Model(replace(recipe, parameters=(), function=still, home=None))
    one = contacts.INFO.export(model, "robot", EXPORTABLE)
    assert device(one).read(np.zeros((1, 0)), [[0.02, 0.0, -1.0]])[0][0] == OK
    assert off_at(one, np.zeros((1, 0), np.float32)).max() < 1e-6


def test_what_repeats_after_a_turn_wraps():
    turns = np.array([[0.4], [0.4 + 2.0 * np.pi], [0.4 - 6.0 * np.pi]], np.float32)
    status, reading = device(export_of("round_about")).read(turns, [[0.1, 0.05, -1.0]] * 3)
    assert status.tolist() == [OK] * 3
    np.testing.assert_allclose(reading, reading[:1].repeat(3, axis=0), atol=1e-5)

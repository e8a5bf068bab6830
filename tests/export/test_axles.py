"""Robots with an axle that swings, in C: as the definition has them, and never safer."""

import math

import numpy as np
import pytest

from firmware_export.certify.answers import Reader, device
from firmware_export.codecs import codec
from firmware_export.control import Wishes, design
from firmware_export.host import STANDS, Host
from firmware_export.protocol import describe
from firmware_export.truth import Model, biased, join, uniform
from lutgen.errors import InputError
from lutgen.recipe import parse_recipe
from tests.fixtures.exports import rover_export
from tests.fixtures.tractors import tractor

TRACTORS = [tractor(), tractor(0.7, 1), tractor(0.6, 2), tractor(0.8, 2, radius=0.4)]
LEFT, FRONT = 0, {2, 3}


@pytest.mark.parametrize("text", TRACTORS)
@pytest.mark.parametrize("whole", [False, True])
def test_no_tractor_is_safer_in_c_than_in_the_definition(text, whole):
    export = rover_export(text=text)
    model, host = export.model, Host(describe(export))
    reader = Reader(model, host.read_i, export.body.steps) if whole else device(export)
    # The guard is 1e-4, of the integer form 4e-4, and nothing but it and rounding is lost.
    most = 5e-4 if whole else 1.1e-4
    seen = reader.measure(join([uniform(model, 50_000, 1), biased(model, 50_000, 2)]))
    assert not seen.false_safe.any()
    both = seen.standing & seen.answers.stands
    lost = seen.exact.tip_angle - seen.answers.tip_angle
    assert 0.0 < lost[both].min() < lost[both].max() < most
    assert seen.exact.tip_angle[seen.standing & ~seen.answers.stands].max() < most
    assert seen.errors("sdg").max() < (2e-3 if whole else 1e-5)
    assert seen.standing.mean() > 0.2


@pytest.mark.parametrize(("pivot", "sideways"), [(0.7, 38.5), (0.5, 35.7), (0.0, 30.1)])
def test_a_tractor_tips_sideways_over_its_pivot(pivot, sideways):
    # Worked by hand: 0.8 (1 - 0.8 / x) / 0.9 with x = 0.8 + 1.5 * 0.9 / (0.9 - z).
    slope = np.radians(np.arange(25.0, 45.0, 0.01))
    down = np.column_stack([0.0 * slope, np.sin(slope), -np.cos(slope)])
    _, status, reading = Host(describe(rover_export(text=tractor(pivot)))).at(np.zeros(0), down)
    stands = np.isin(status, STANDS)
    assert math.degrees(slope[stands].max()) == pytest.approx(sideways, abs=0.06)
    assert not stands[slope > slope[stands].max()].any()
    # Over the line from the rear left wheel to the pivot, which is nearest to the front ones.
    names = set(reading["over"][stands][-1].tolist())
    assert LEFT in names
    assert names & FRONT


def test_what_has_no_bound_with_an_axle_is_refused_with_a_way_out():
    uncertain = Model(parse_recipe(tractor(head="com_uncertainty = 0.01")))
    assert "--arithmetic integer" in str(codec("contacts").refusal(uncertain, "float"))
    with pytest.raises(InputError, match=r"axles that swing \(got front\); read its export"):
        design(Model(parse_recipe(tractor(parameters=1))), Wishes())

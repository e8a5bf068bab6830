"""Margins written down from the papers: values of a public library, and our channels."""

import numpy as np
import pytest

import lutgen
from lutgen.analysis import Posture, compare_metrics
from proofs.margins import MARGINS

LEVEL = np.array([[0.0, 0.0, -1.0]])


def test_on_one_polygon_they_are_our_channels_under_any_gravity():
    posture = Posture(lutgen.load_recipe("recipe:paper_two"), np.radians([31.0, 12.0]))
    stance = posture.stance_of_weight()
    down = np.random.default_rng(3).normal(size=(50, 3)) * 0.4 + LEVEL
    down /= np.linalg.norm(down, axis=1, keepdims=True)
    ours = compare_metrics(posture, down)
    corners = stance.facets[0].points
    for name, channel in (("static_margin", "margin"), ("force_angle", "force_angle")):
        assert MARGINS[name](corners, down) == pytest.approx(ours.values[channel], rel=1e-6)
    stands = ours.standing
    assert stands.any()
    assert not stands.all()
    # Beyond the limit ours takes the least rise of the axes that are passed, theirs of all.
    energy = MARGINS["energy_margin"](corners, down)
    assert energy[stands] == pytest.approx(ours.values["energy_margin"][stands], rel=1e-6)
    for rule in MARGINS.values():
        assert np.array_equal(rule(corners, down) > 0.0, stands)

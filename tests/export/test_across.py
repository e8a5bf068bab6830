"""The guard of `grid` on three contacts: what errors of positions turn of the tip-over planes."""

import numpy as np
import pytest

from firmware_export.grid import lookup
from firmware_export.grid.points import bounds, reach_of
from firmware_export.truth.model import Model
from firmware_export.truth.rest import least_edge_of
from lutgen.recipe import load_recipe
from tests.fixtures.exports import before_guard


@pytest.mark.parametrize(("bits", "nodes"), [(8, (3, 3)), (16, (5, 4))])
def test_planes_turn_as_far_as_tip_angles_are_off_and_hardly_less_than_the_guard(bits, nodes):
    model = Model(load_recipe("maps/paper_two.toml"))
    channels = ("sdg", "tip_angle", "height")
    spec = lookup.Spec(bits, ((nodes[0], 1), (1, nodes[1]), (1, 1)))
    export = lookup.INFO.export(model, "table", channels, spec=spec)
    rng = np.random.default_rng(8)
    params = model.at(rng.random((60_000, model.k))).astype(np.float32)
    u, v = rng.uniform(-1.0, 1.0, (2, 60_000)) * model.chart_limit
    gravity = model.uv_to_gravity(0, u, v).astype(np.float32)
    exact = model.exact(params.astype(np.float64), gravity[:, None].astype(np.float64))
    said = before_guard(export, params, gravity)[:, 1]
    off = (said - exact.tip_angle[:, 0])[said >= 0.0].max()
    wide, unit = bounds(model)
    misplaced = 2.0 * lookup.MISPLACED * unit * reach_of(wide) / least_edge_of(model)
    assert off <= export.tables.guard < 1.3 * off + 1.1 * misplaced

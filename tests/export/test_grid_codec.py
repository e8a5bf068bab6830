"""The codec `grid`: multilinear tables with fitted nodes, and a verdict that is never too safe."""

from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.typing import NDArray

from firmware_export.certify.answers import device
from firmware_export.grid import codec as grid
from firmware_export.grid import fit as grid_fit
from firmware_export.grid import lookup
from firmware_export.grid.lattice import at_points
from firmware_export.grid.points import bounds, depends_on, fit_point
from firmware_export.grid.spec import Spec
from firmware_export.grid.tables import SPAN, Tables
from firmware_export.protocol.exported import Export
from firmware_export.truth import widened
from firmware_export.truth.model import Exact, Model
from firmware_export.verdict import codec as verdict
from firmware_export.verdict import lower, train
from firmware_export.verdict.knots import chosen_knots, places_of
from firmware_export.verdict.lower import Places, excess
from firmware_export.verdict.outline import outlines
from lutgen.quantities import EXPORTABLE
from lutgen.recipe.recipe import load_recipe, parse_recipe
from tests.fixtures.fits import few_points
from tests.fixtures.recipes import rover

OK = 0


@pytest.fixture(scope="module")
def model() -> Model:
    return Model(load_recipe("maps/paper_two.toml"))


@pytest.fixture(scope="module", autouse=True)
def small_samples() -> Iterator[None]:
    """Fit on few points."""
    with few_points():
        yield


def places(model: Model, count: int, seed: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return params and gravity, a third of the coordinates at an end."""
    rng = np.random.default_rng(seed)
    x = rng.random((count, model.k + 2))
    x = np.where(rng.random(x.shape) < 1 / 3, np.round(x), x)
    u, v = ((2.0 * x[:, model.k :] - 1.0) * model.chart_limit).T
    params = model.lower + (model.upper - model.lower) * x[:, : model.k]
    gravity = model.uv_to_gravity(rng.integers(0, model.faces, count), u, v)
    return params.astype(np.float32), gravity.astype(np.float32)


def truth(model: Model, params: NDArray[np.float32], gravity: NDArray[np.float32]) -> Exact:
    return model.exact(params.astype(np.float64), gravity[:, None].astype(np.float64))


def export_of(model: Model, tables: Tables, arithmetic: str = "float") -> Export:
    return Export("robot", model.recipe, model, "grid", arithmetic, tables.channels, tables)


@pytest.fixture(scope="module", params=["float", "integer"])
def looked_up(request: pytest.FixtureRequest, model: Model) -> Export:
    tables = lookup.encode(model, EXPORTABLE, lookup.Spec(16, ((1, 7), (7, 1), (1, 1))))
    return Export("two", model.recipe, model, "grid", request.param, EXPORTABLE, tables)


def test_three_contacts_looked_up_are_never_safer_than_the_truth_and_as_exact_in_every_direction(
    model: Model, looked_up: Export
) -> None:
    params, gravity = places(model, 40_000, 3)
    if looked_up.integer:
        share = (params - model.lower) / (model.upper - model.lower)
        params = np.rint(share * 32767.0).astype(np.int16)
        gravity = np.rint(gravity / np.abs(gravity).max(axis=1, keepdims=True) * 32000.0)
    reader = device(looked_up)
    status, reading = reader.read(params, gravity)
    values = reader._units(reading)
    asked = model.at(params / 32767.0) if looked_up.integer else params.astype(np.float64)
    exact = model.exact(asked, np.asarray(gravity, np.float64)[:, None])
    safe = status == OK
    tip = exact.tip_angle[:, 0]
    assert not np.any(safe & (tip < 0.0))
    # An arcsine of 1/32767 is off by up to 0.008 rad where the sine is near 1.
    low = np.minimum(tip, 1.4)
    assert np.all(
        values[safe, 1] <= low[safe] + (0.01 if looked_up.integer else 0.0) + (tip > 1.4)[safe]
    )
    assert safe[tip > 3.0 * looked_up.tables.guard].all()
    span = np.ptp(exact.sdg[tip >= 0.0, 0])
    # Seven nodes over 51 degrees: chords of 8.5 degrees, halved by the fit, are off by 0.07 %.
    assert np.abs(values[safe, 0] - exact.sdg[safe, 0]).max() < 0.01 * span
    assert np.abs(values[safe, 2] - exact.height[safe, 0]).max() < 0.003 * 23.3
    assert looked_up.tables.bytes < 100


def test_a_point_has_the_axes_on_which_it_depends_and_errors_within_its_bound(model: Model) -> None:
    wide, unit = bounds(model)
    for contact, axes in ((0, (0,)), (1, (1,)), (2, ())):
        assert depends_on(wide, contact) == axes
        point = fit_point(wide, contact, (5,) * len(axes), 16, unit)
        t = np.random.default_rng(4).random((3000, 2))
        exact = wide.postures(wide.at(t)).centres[:, contact]
        found = (
            np.broadcast_to(point.codes.astype(np.float64) * unit, (3000, 3)) if not axes else None
        )
        if axes:
            x = t[:, axes[0]] * 4.0
            cell = np.minimum(x.astype(int), 3)
            values = point.codes * unit
            part = (x - cell)[:, None]
            found = values[cell] * (1.0 - part) + values[cell + 1] * part
        off = np.sqrt(((found - exact) ** 2).sum(axis=1)).max()
        assert off <= point.error
        # The bound is no more than the largest error and what lies between the places looked at.
        assert point.error < 1.3 * off + unit


def test_a_size_grows_along_one_parameter_at_a_time_and_is_read_from_its_label(
    model: Model,
) -> None:
    first, wider = lookup.start(model, EXPORTABLE, "float")
    assert (first.bits, wider.bits) == (8, 16)
    grown = lookup.grow(model, first)
    assert len(grown) == 3
    for spec in grown:
        assert lookup.read_label(spec.label) == spec
        assert spec.bytes > first.bytes
        assert lookup.encode(model, EXPORTABLE, spec).spec == spec


def test_bytes_are_known_before_anything_is_encoded() -> None:
    wheels = Model(parse_recipe(rover()))
    spec = Spec(8, (("tip", (5, 5, 5)),))
    blank, made = (make(wheels, ("tip_angle",), spec) for make in (verdict.blank, verdict.encode))
    assert blank.bytes == made.bytes
    assert made.bytes == sum(a.bytes for a in made.body(False).arrays if a.table)


def test_a_robot_on_wheels_is_never_called_safe_where_it_tips() -> None:
    wheels = Model(parse_recipe(rover()))
    tables = verdict.encode(wheels, ("tip_angle",), Spec(8, (("tip", (9, 11, 11)),)))
    query = places(wheels, 60_000, 6)
    safe = device(export_of(wheels, tables)).read(*query)[1][:, 1] >= 0.0
    exact = truth(wheels, *query).tip_angle[:, 0]
    assert not (safe & (exact < 0.0)).any()
    assert safe[exact > 0.0].mean() > 0.8


def test_outlines_hold_what_tips_nearby() -> None:
    wheels = Model(parse_recipe(rover()))
    rng = np.random.default_rng(7)
    limit = wheels.chart_limit
    down = wheels.uv_to_gravity(0, *rng.uniform(-limit, limit, (2, 400)))
    found = outlines(wheels, 20, down)
    cell = rng.integers(0, 20, 300)
    part = rng.random(300)
    t = found.axes[0][cell] + part * np.diff(found.axes[0])[cell]
    params = wheels.lower + (wheels.upper - wheels.lower) * t[:, None]
    tips = wheels.exact(params, np.repeat(down[None], 300, axis=0)).tip_angle < 0.0
    # This robot's region does not jump: the nearest posture alone says so.
    assert not (tips & ~found.tips[np.where(part < 0.5, cell, cell + 1)]).any()
    assert found.tips.mean() < tips.mean() + 0.1


def test_where_a_region_jumps_one_of_the_postures_around_knows_what_the_nearest_does_not() -> None:
    wide = widened(Model(load_recipe("maps/absolem.toml")))
    # Found among 3.2 million configurations: it tips where what is nearest to it stands, with room.
    posture = np.array([[2.9165471108881995, -2.806358183819956]])
    down = np.array([[0.43122, -0.05026, -0.90085]])
    assert wide.exact(posture, down[None]).tip_angle[0, 0] < 0.0
    span = wide.upper - wide.lower
    place = (posture[0] - wide.lower) / span * 512.0
    for first, tips in ((np.floor(place), True), (np.floor(place) + 0.5, False)):
        low = wide.lower + first / 512.0 * span
        window = tuple(
            replace(parameter, minimum=a, maximum=a + b / 512.0)
            for parameter, a, b in zip(wide.recipe.parameters, low, span, strict=True)
        )
        found = outlines(Model(replace(wide.recipe, parameters=window)), 1, down)
        # The corners of its sub-cell; then the sub-cell's middle.
        said = found.tips.any() if tips else found.tips[0, 0]
        assert said == tips


def test_a_table_that_calls_safe_what_stands_at_one_corner_only_is_lowered() -> None:
    counts = np.array([4, 3])
    rng = np.random.default_rng(12)
    tips = rng.random((12, 7)) < 0.1
    near = train.anywhere_near(tips, counts)
    at = np.stack(np.unravel_index(np.arange(12), counts), axis=1)
    for p in range(12):
        beside = np.abs(at - at[p]).max(axis=1) <= 1
        np.testing.assert_array_equal(near[p], tips[beside].any(axis=0))
        turns = {lower.beside(p, counts, turn) for turn in range(9)}
        assert turns - {-1} == set(np.flatnonzero(beside).tolist())
    # No piece at the first posture, one at the second: the first is lowered too, the fourth is not.
    node = np.ones((4, 1, 2, 2))
    index, weight = np.arange(4, dtype=np.int32)[:, None], np.ones((4, 1))
    pieces, first = np.array([[0.2, 0.2, 0.8, 0.8]], np.float32), np.array([0, 0, 1, 1, 1])
    ends = np.array([0.0, 1.0])
    found = Places(index, weight, np.array([4]), pieces, first, np.zeros((4, 4), bool), ends, ends)
    fallen = excess(node, found, False)[0].reshape(4, -1).max(axis=1)
    assert fallen.tolist() == [1.0, 1.0, 1.0, 0.0]
    alone = excess(node, found, False, None, around=False)[0].reshape(4, -1).max(axis=1)
    assert alone.tolist() == [0.0, 1.0, 0.0, 0.0]


def test_no_knot_of_a_verdict_lies_between_two_of_the_postures_at_which_it_is_proved() -> None:
    for model in (Model(parse_recipe(rover())), Model(load_recipe("maps/paper_two.toml"))):
        wide = widened(model)
        for axis in range(model.k):
            for count in range(3, 40):
                found = chosen_knots(wide, axis, count) / SPAN * places_of(wide)
                # Knots and places are rounded to 1/65534.
                assert np.abs(found - np.rint(found)).max() <= 1.01 * places_of(wide) / SPAN


def test_a_lowered_table_is_below_zero_on_every_piece() -> None:
    rng = np.random.default_rng(8)
    u, v = np.array([0.0, 0.3, 0.7, 1.0]), np.array([0.0, 0.5, 1.0])
    node = rng.normal(size=(2, 1, 3, 4))
    pieces = rng.random((40, 4)).astype(np.float32)
    index, weight = np.array([[0, 1], [1, 0]], np.int32), np.array([[0.4, 0.6], [1.0, 0.0]])
    first, tips = np.array([0, 40, 40]), np.zeros((2, 12), np.bool_)
    places = Places(index, weight, np.array([2]), pieces, first, tips, u, v)
    lowered = node - excess(node, places, False)[0]
    for share in ([0.4, 0.6], [0.0, 1.0]):
        plane = np.tensordot(share, lowered[:, 0], 1)
        along = np.linspace(0.0, 1.0, 501)[:, None, None]
        at = pieces[:, :2] + along * (pieces[:, 2:] - pieces[:, :2])
        i = np.clip(np.searchsorted(v, at[..., 1], "right") - 1, 0, 1)
        j = np.clip(np.searchsorted(u, at[..., 0], "right") - 1, 0, 2)
        g = (at[..., 1] - v[i]) / np.diff(v)[i]
        f = (at[..., 0] - u[j]) / np.diff(u)[j]
        value = (1 - g) * ((1 - f) * plane[i, j] + f * plane[i, j + 1]) + g * (
            (1 - f) * plane[i + 1, j] + f * plane[i + 1, j + 1]
        )
        # float32 ends of pieces, crossings skipped within 1e-9.
        assert value.max() < 1e-6


def test_postures_below_zero_need_not_be_looked_at_again() -> None:
    rng = np.random.default_rng(10)
    u, v = np.linspace(0.0, 1.0, 4), np.linspace(0.0, 1.0, 3)
    node = rng.normal(size=(6, 1, 3, 4)) - 0.3
    pieces = rng.random((50, 4)).astype(np.float32)
    index = np.stack([np.arange(5), np.arange(1, 6)], axis=1).astype(np.int32)
    weight, counts = np.full((5, 2), 0.5), np.array([5])
    tips = rng.random((5, 12)) < 0.1
    places = Places(index, weight, counts, pieces, np.arange(0, 51, 10), tips, u, v)
    whole, part, which = node.copy(), node.copy(), None
    left = []
    for _ in range(30):
        whole -= 0.5 * excess(whole, places, True)[0]
        drop, which = excess(part, places, True, which)
        part -= 0.5 * drop
        left.append(len(which))
    np.testing.assert_array_equal(part, whole)
    assert sorted(left, reverse=True) == left
    assert set(which) == set(excess(part, places, True)[1])


def test_points_of_the_training_interpolate_as_the_table_does(model: Model) -> None:
    lattice = grid.lattice_of(model, (4, 5, 6, 7))
    rng = np.random.default_rng(11)
    place, face = rng.random((3_000, 4)), np.zeros(3_000, np.int64)
    node, importance, value = rng.normal(size=840), rng.random(3_000), rng.normal(size=3_000)
    spots = lattice.spots(place, face)
    index, weight, start = lattice.find(place, face)
    here = at_points(index, weight, node[:, None], start)[:, 0]
    # Places in float32: 6e-8 of a cell, across which a few units are interpolated.
    np.testing.assert_allclose(spots.at(node), here, atol=3e-6)
    # The transpose.
    assert spots.spread(value) @ node == pytest.approx(value @ spots.at(node), rel=1e-9)
    np.testing.assert_allclose(
        spots.spread(importance, node), spots.spread(importance * spots.at(node)), atol=1e-10
    )
    squares = np.bincount(index.ravel(), (weight**2 * importance[:, None]).ravel(), 840)
    np.testing.assert_allclose(spots.spread(importance, power=2), squares, atol=1e-5)


def test_a_node_below_the_ground_does_not_shift_the_heights_without_floats(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def fit(*_: object) -> NDArray[np.float64]:
        # One node where nothing stands: its height is no length.
        return np.append(np.linspace(0.2, 0.4, 26), -1.0)[:, None]

    monkeypatch.setattr(grid_fit, "fit", fit)
    wheels = Model(parse_recipe(rover()))
    part = grid.length_table(wheels, "height", (3, 3, 3), 8)
    heights = part.offset[0] + part.step * part.codes.ravel().astype(np.float64)
    read = part.height_step * (
        part.zero[0] + np.arange(256) * 256.0 * part.fine_step / part.height_step
    )
    np.testing.assert_allclose(heights[:26], np.linspace(0.2, 0.4, 26), atol=0.001)
    np.testing.assert_allclose(read[part.codes.ravel()[:26]], heights[:26], atol=0.001)


def test_nodes_are_shared_out_as_the_axes_need_and_never_more_than_asked() -> None:
    wheels = Model(parse_recipe(rover()))
    before = (3, 3, 3)
    for nodes in (27, 200, 1_000, 5_000):
        shape = verdict.of_nodes(wheels, ("tip_angle",), {"tip": nodes}, 8).nodes[0][1]
        # Beyond some 1,400 nodes nothing more is lost along any axis.
        assert 0.7 * min(nodes, 1_400) <= np.prod(shape) <= nodes
        assert all(more >= few for more, few in zip(shape, before, strict=True))
        before = shape
    # u and v matter more than how far one wheel is lifted.
    assert shape[0] < min(shape[1:])


def test_where_nothing_is_outlined_no_point_is_drawn() -> None:
    axes = [np.linspace(0.0, 1.0, 4), np.linspace(0.0, 1.0, 3)]
    for pieces, first in ((0, np.zeros(7, int)), (5, np.minimum(np.arange(7), 5))):
        found = SimpleNamespace(pieces=np.ones((pieces, 4)), first=first, axes=axes)
        place, face = train._outline_points(found, 1, 100, 3)  # type: ignore[arg-type]
        assert len(place) == len(face) == (100 if pieces else 0)

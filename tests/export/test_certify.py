"""The certificate: honest exports pass it, and every way of cheating is found."""

import numpy as np
import pytest

import lutgen
from firmware_export.certify import certificate as certifying
from firmware_export.certify.answers import Reader, span_of
from firmware_export.certify.attack import largest_jump, sdg_error
from firmware_export.certify.certificate import certify
from firmware_export.model import Model, biased, uniform
from firmware_export.quantity import ErrorBound
from lutgen.errors import ExportError
from tests.fixtures.recipes import feet, rigid, rover, tripod

TRIPOD = Model(lutgen.parse_recipe(tripod(channels=("sdg", "tip_angle", "height"))))
ROVER = Model(lutgen.parse_recipe(rover()))
CHANNELS = ("sdg", "tip_angle", "height")
POINTS = 4_000
GUARD = 1e-4
# An `answer` is a function of normalised parameters (n, k), directions (n, 3) and the exact sdg,
# tip angle and height (n, 3); it returns those that are said (n, 3).


def reader(model, answer, guard=GUARD):
    """Return a smap_read that answers a function of the exact answer, less a guard."""

    def read(params, gravity):
        exact = model.exact(params.astype(np.float64), gravity[:, None].astype(np.float64))
        true = np.stack([exact.sdg.ravel(), exact.tip_angle.ravel(), exact.height.ravel()], 1)
        t = (params.astype(np.float64) - model.lower) / (model.upper - model.lower)
        unit = gravity / np.linalg.norm(gravity, axis=1)[:, None]
        values = np.array(answer(t, unit, true), np.float64)
        values[:, 1] -= guard
        tips = values[:, 1] < 0.0
        values[tips, 0] = values[tips, 2] = np.nan
        return np.where(tips, 2, 0).astype(np.int8), values.astype(np.float32)

    return read


def honest(t, g, true):
    return true


def certificate(answer, model=TRIPOD, guard=GUARD, **more):
    device = Reader(model, reader(model, answer, guard))
    return certify(device, CHANNELS, points=POINTS, **more)


def corner(t, g, true):
    near = (np.abs(t - (0.0, 1.0)) < 1e-5).all(axis=1)
    return true + np.where(near, 2.0 * GUARD, 0.0)[:, None] * [0.0, 1.0, 0.0]


def hair(t, g, true):
    # More than the guard by the resolution of a float32.
    return np.add(true, [0.0, GUARD + 2e-7, 0.0])


def test_an_honest_export_passes_and_loses_only_its_guard():
    found = certificate(honest)
    assert found.points >= POINTS
    assert found.false_safe == 0
    assert found.witness is None
    assert not found.jumps
    for name in ("sdg", "height"):
        # float32 of values near 1, and |SD_g| near 0 magnifies what a float32 direction loses
        assert found.channels[name]["max_percent"] < 1e-4
    assert found.channels["tip_angle"]["max"] == pytest.approx(GUARD, rel=0.01)
    assert found.false_tip < 20.0 * GUARD
    # The search came as near to a false safe as the guard lets it.
    assert found.nearest == pytest.approx(GUARD, rel=0.01)
    found.refuse_false_safe("robot")
    assert certificate(honest).as_dict() == found.as_dict()


def constant(t, g, true):
    return np.tile([0.3, 0.5, 1.0], (len(t), 1))


def nothing(t, g, true):
    return np.tile([0.0, GUARD, 0.0], (len(t), 1))


def nearest_node(t, g, true):
    node = TRIPOD.lower + np.rint(t * 8.0) / 8.0 * (TRIPOD.upper - TRIPOD.lower)
    place = np.rint(g[:, :2] / -g[:, 2:] * 8.0) / 8.0
    down = np.concatenate([place, -np.ones((len(g), 1))], axis=1)
    exact = TRIPOD.exact(node, down[:, None])
    return np.stack([exact.sdg[:, 0], exact.tip_angle[:, 0], exact.height[:, 0]], 1)


@pytest.mark.parametrize("answer", [constant, nothing, nearest_node, corner, hair])
def test_an_answer_that_does_not_look_is_refused(answer):
    found = certificate(answer)
    assert found.false_safe > 0
    params, gravity, said, true = found.witness
    assert said >= 0.0 > true
    # The witness is a point of its own right: the exact model says the same of it.
    again = TRIPOD.exact(params[None], gravity[None, None]).tip_angle[0, 0]
    assert again == true
    with pytest.raises(ExportError, match="called safe where it tips"):
        found.refuse_false_safe("robot")


def test_no_answer_and_no_number_are_infinite_errors():
    found = certificate(lambda t, g, true: true * 0.0 - 1.0)
    assert (found.false_safe, found.false_tip) == (0, 1.0)
    assert found.error(relative=True) == np.inf

    def gap(t, g, true):
        return np.where((t[:, :1] < 0.01) & (np.arange(3) == 0), np.nan, true)

    found = certificate(gap)
    assert found.channels["sdg"]["max"] == np.inf
    assert np.isfinite(found.channels["height"]["max"])


def test_a_guard_that_is_too_small_in_a_spot_of_the_box_is_found_by_the_search():
    # 0.2 % more than the guard covers, only about one posture: no point of the sample is wrong.
    def answer(t, g, true):
        far = ((t - (0.371, 0.642)) ** 2).sum(axis=1) / (2.0 * 0.05**2)
        return true + [[0.0, 1.0, 0.0]] * (1.002 * GUARD * np.exp(-far))[:, None]

    device = Reader(TRIPOD, reader(TRIPOD, answer))
    for draw in (uniform, biased):
        assert not device.measure(draw(TRIPOD, POINTS // 2, 1001)).false_safe.any()
    found = certificate(answer)
    assert found.false_safe > 0
    assert found.nearest < 0.0
    with pytest.raises(ExportError):
        found.refuse_false_safe("robot")


def test_the_largest_error_is_climbed_to_from_the_worst_points(monkeypatch):
    monkeypatch.setattr(certifying, "LEAST", 25)  # as of 500,000 points

    def answer(t, g, true):
        far = ((t - (0.333, 0.777)) ** 2).sum(axis=1) + ((g - (0.1, 0.0, -0.995)) ** 2).sum(axis=1)
        return true + [[1.0, 0.0, 0.0]] * (0.1 / (1.0 + far / 0.01**2))[:, None]

    device = Reader(TRIPOD, reader(TRIPOD, answer))
    seen = max(
        sdg_error(device.measure(draw(TRIPOD, POINTS // 2, 1001))).max()
        for draw in (uniform, biased)
    )
    found = certificate(answer).channels["sdg"]["max"]
    assert seen < 0.09
    assert found > 0.098


def test_the_stability_factor_jumps_where_the_support_facet_changes_and_nowhere_else():
    flat = rigid(feet([(1, 1, -1), (1, -1, -1), (-1, -1, -1), (-1, 1, -1)]))
    folded = feet([(2, 1, -1), (1, -1, -1.2), (-1, -1, -1), (-1, 1, -1.2)])
    folded = rigid(folded, head="rock_angle = 45.0")
    for text, jumps in ((tripod(), False), (flat, False), (rover(), True), (folded, True)):
        height = largest_jump(Model(lutgen.parse_recipe(text)))
        assert (height > 0.01) == (height > 0.0) == jumps


HALF = ErrorBound(0.5, relative=True)


def test_where_the_stability_factor_jumps_no_largest_error_is_claimed():
    found = certificate(lambda t, g, true: true * [1.01, 1.0, 1.0], ROVER, bound=HALF)
    assert found.jumps
    sdg = found.channels["sdg"]
    assert "max" not in sdg
    assert sdg["largest_seen"] > sdg["p99"]
    assert "max" in found.channels["tip_angle"]
    assert found.error(relative=True) == sdg["p99_percent"]
    assert any("jumps" in text for text in found.text)
    error = 0.01 * ROVER.exact(*uniform(ROVER, 50_000, 77)).sdg
    share = float(np.mean(error[np.isfinite(error)] > 0.005 * sdg["range"]))
    assert found.beyond == pytest.approx(share, abs=0.02)  # two samples of 10,000 points


def test_the_bound_is_for_the_largest_error_where_nothing_jumps():
    found = certificate(lambda t, g, true: true * [1.01, 1.0, 1.02], bound=HALF)
    sdg, height = found.channels["sdg"], found.channels["height"]
    sample = uniform(TRIPOD, 50_000, 77)
    exact = TRIPOD.exact(*sample)
    assert sdg["range"] > 0.9 * (np.nanmax(exact.sdg) - np.nanmin(exact.sdg))
    # The search goes on to where |SD_g| is larger than anywhere in the sample.
    assert 0.98 < sdg["max_percent"] < 1.3
    assert 0.0098 * np.nanmax(exact.sdg) < sdg["max"] < 0.013 * np.nanmax(exact.sdg)
    assert sdg["max"] > sdg["p99"] > sdg["rms"] > 0.0
    assert height["max"] > 0.019 * np.nanmin(exact.height)
    assert found.error(relative=True) == max(sdg["max_percent"], height["max_percent"])
    assert found.text == ()


def test_a_height_that_changes_by_rounding_alone_has_no_range():
    # A car on four equal wheels: its com keeps its height in every posture, but for 1e-17 m.
    points = [(x, y, -0.3) for x in (-0.4, 0.3) for y in (-0.2, 0.2)]
    model = Model(lutgen.parse_recipe(rigid(feet(points))))
    seen = Reader(model, reader(model, honest)).measure(uniform(model, 1000, 7))
    for noise, span in ((1e-17, 0.0), (1e-6, 1e-6)):
        height = 0.3 + noise * (np.arange(seen.exact.height.size) % 2)
        exact = seen.exact._replace(height=height.reshape(seen.exact.height.shape))
        assert span_of([seen._replace(exact=exact)], "height") == pytest.approx(span)

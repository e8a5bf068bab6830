"""Reads in two phases, unsafe whatever goes in; `proofs.fuzz` compares their bits."""

import platform

import numpy as np
import pytest

from firmware_export.contacts import INFO
from firmware_export.emit import package
from firmware_export.model import Model, sensor_tolerance
from lutgen.recipe import forward, load_recipe
from tests.fixtures.compiled import FLAGS, HostLibrary, compile_c, run
from tests.fixtures.exports import coded_export, host_of, rover_export, tripod_export
from tests.fixtures.queries import ODD

OK, ROCKS, TIPS, OFF_CHART, OFF_RANGE, INVALID = 0, 1, 2, 3, 4, 6
MAKERS = {
    "contacts": tripod_export,
    "many": rover_export,
    "grid": lambda: tripod_export(codec="grid"),
    "by code": lambda: coded_export("coded", "legs"),
}

MAIN = r"""
#include "tripod.h"
#include <stdio.h>

static int unsafe(smap_status_t status, const smap_reading_t *reading)
{
  return !smap_is_safe(status) && reading->tip_angle < 0.0f && !(reading->sdg == reading->sdg) &&
         reading->over[0] == 255;
}

int main(void)
{
  static tripod_pose_t zero, pose;
  static tripod_pose_i_t whole;
  smap_pose_t *const p = &pose.pose;
  const float params[2] = {TWO_PARAMS}, bad[2] = {100.0f, 100.0f};
  const float gravity[3] = {0.05f, 0.02f, -1.0f};
  const float several[3][3] = {{0.0f, 0.0f, -1.0f}, {9.0f, 0.0f, -1.0f}, {0.0f, 0.1f, -1.0f}};
  const int16_t down[3] = {51, 20, -1024};
  const uint8_t both = SMAP_FLOAT | SMAP_INTEGER;
  smap_reading_t reading, many[3];
  smap_reading_i_t reading_i;
  int faults = 0;
  faults += !unsafe(smap_at(&zero.pose, gravity, &reading), &reading);
  faults += smap_at_i(&zero.pose, down, &reading_i) != SMAP_INVALID;
  faults += reading_i.tip >= 0 || reading_i.sdg != 65535;
  faults += smap_pose(&tripod, params, p, sizeof pose - 4, both) != SMAP_INVALID;
  faults += !unsafe(smap_at(p, gravity, &reading), &reading);
  faults += smap_pose(&tripod, params, p, sizeof pose, 0) != SMAP_INVALID;
  faults += smap_pose(&tripod, params, p, sizeof pose, 4) != SMAP_INVALID;
  faults += smap_pose(&tripod, params, p, sizeof pose, SMAP_FLOAT) != SMAP_OK;
  faults += smap_at(p, gravity, &reading) != SMAP_OK;
  faults += smap_at_i(p, down, &reading_i) != SMAP_INVALID || reading_i.tip >= 0;
  faults += smap_pose(&tripod, bad, p, sizeof pose, both) != SMAP_OFF_RANGE;
  faults += smap_at(p, gravity, &reading) != SMAP_OFF_RANGE || !unsafe(SMAP_OFF_RANGE, &reading);
  faults += smap_pose(&tripod, params, &whole.pose, sizeof whole, SMAP_INTEGER) != SMAP_OK;
  faults += smap_at_i(&whole.pose, down, &reading_i) != SMAP_OK || reading_i.tip < 0;
  faults += smap_at(&whole.pose, gravity, &reading) != SMAP_INVALID;
  faults += smap_pose(&tripod, params, p, sizeof pose, both) != SMAP_OK;
  faults += smap_at_n(p, several, 3, many) != SMAP_OFF_CHART || many[0].tip_angle < 0.0f;
  faults += many[2].tip_angle < 0.0f || many[1].tip_angle >= 0.0f;
  faults += smap_at_n(p, several, 0, many) != SMAP_INVALID;
  faults += smap_at_n(p, several, 1, many) != SMAP_OK;
  faults += smap_check(&tripod) != SMAP_OK;
  {
    const int16_t up[3] = {-32768, 5, 32767};
    int16_t turned[3];
    smap_gravity_from_up_i(up, turned);
    faults += turned[0] != 32767 || turned[1] != -5 || turned[2] != -32767;
  }
  printf("%d\n", faults);
  return faults;
}
"""


def some(model, count, seed=0):
    """Return random params (m, k) and directions (m, 3)."""
    rng = np.random.default_rng(seed)
    params = model.at(rng.random((count, model.k))).astype(np.float32)
    gravity = rng.normal(size=(count, 3)).astype(np.float32)
    gravity[:, 2] = -2.0 * np.abs(gravity[:, 2])
    return params, gravity


def test_what_a_pose_may_be_given_is_answered_and_nothing_of_it_is_safe(tmp_path):
    export = tripod_export()
    package.write(export, tmp_path / "e")
    middle = ", ".join(f"{value}f" for value in export.model.at(np.full(2, 0.5)).astype(np.float32))
    text = MAIN.replace("TWO_PARAMS", middle)
    (tmp_path / "main.c").write_text(text)
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wno-pedantic", "-fsanitize=address,undefined"]
    compile_c([*flags, "-Ie", "main.c", "e/tripod.c", "-o", "main"], tmp_path)
    assert run(tmp_path, "./main") == "0\n"


@pytest.mark.parametrize("name", MAKERS)
def test_whatever_the_bits_of_gravity_an_answer_is_safe_or_says_why_not(name):
    export, rng = MAKERS[name](), np.random.default_rng(5)
    host, bits = host_of(export), rng.integers(0, 1 << 32, (200_000, 3), dtype=np.uint64)
    odd = rng.choice(np.float32(ODD), (4000, 3))
    gravity = np.concatenate([odd, bits.astype(np.uint32).view(np.float32)])
    params = np.repeat(export.model.at(np.full((1, export.model.k), 0.4)), len(gravity), axis=0)
    status, reading = host.read(params, gravity)
    strange = ~np.isfinite(gravity).all(axis=1) | (gravity == 0.0).all(axis=1)
    assert np.all(status[strange] == INVALID)
    safe = np.isin(status, (OK, ROCKS))
    assert np.all(reading[safe, 1] >= 0.0)
    assert np.all(reading[~safe, 1] < 0.0)
    assert np.isnan(reading[~safe, 0]).all()
    assert safe.any()
    for value, answer in ((np.nan, INVALID), (-np.inf, INVALID), (1e30, OFF_RANGE)):
        row = params[:1].copy()
        row[0, -1] = value
        status, reading = host.read(row, [[0.0, 0.0, -1.0]])
        assert status[0] == answer
        assert reading[0, 1] < 0.0


@pytest.mark.parametrize("name", MAKERS)
def test_beyond_an_end_the_truth_is_read_up_to_a_sensors_slack_and_nothing_further(name):
    export = MAKERS[name]()
    model, host = export.model, host_of(export)
    _, gravity = some(model, 500, 2)
    for axis, parameter in enumerate(model.recipe.parameters):
        room = sensor_tolerance(parameter)
        for end, way in ((parameter.minimum, -1.0), (parameter.maximum, 1.0)):
            row = model.at(np.full(model.k, 0.3))
            row[axis] = end + way * 0.9 * room
            params = np.repeat(row[None].astype(np.float32), len(gravity), axis=0)
            status, reading = host.read(params, gravity)
            exact = model.exact(params[:1], gravity.astype(np.float64)[None]).tip_angle[0]
            safe = np.isin(status, (OK, ROCKS))
            assert np.all(exact[safe] >= reading[safe, 1])
            assert safe.any()
            row[axis] = end + way * 1.1 * room
            status, _ = host.read(np.repeat(row[None], 3, axis=0), gravity[:3])
            assert status.tolist() == [OFF_RANGE] * 3


@pytest.mark.skipif(platform.machine() != "x86_64", reason="sets a register of x86")
@pytest.mark.parametrize("name", MAKERS)
def test_flush_to_zero_changes_no_answer(name, tmp_path):
    export = MAKERS[name]()
    package.write(export, tmp_path / "e")
    flush = tmp_path / "flush.c"
    flush.write_text(
        "#include <immintrin.h>\nvoid flush(void) __attribute__((constructor));\n"
        "void flush(void) { _mm_setcsr(_mm_getcsr() | 0x8040u); }\n"
    )
    rng, model = np.random.default_rng(6), export.model
    odd = np.array([0.0, -0.0, 1e-45, -1e-45, 1e-42, -3e-39, 1.2e-38, -4e-38, 1e-30, 1e-19], "f4")
    gravity = rng.normal(size=(6000, 3)).astype(np.float32) * [1.0, 1.0, -1.0]
    gravity *= 2.0 ** rng.uniform(-148.0, 20.0, (6000, 1))
    put = rng.random((6000, 3)) < 0.3
    gravity[put] = rng.choice(odd, int(put.sum()))
    params = model.at(rng.random((6000, model.k))).astype(np.float32)
    at = rng.random(params.shape) < 0.1
    params[at] = rng.choice(odd, int(at.sum()))
    known = host_of(export).read(params, gravity)
    found = HostLibrary(tmp_path / "e", (*FLAGS, str(flush))).read(params, gravity)
    np.testing.assert_array_equal(found[0], known[0])
    assert found[1].tobytes() == known[1].tobytes()
    assert {OK, TIPS, INVALID} <= set(known[0].tolist())


def test_a_joint_that_turns_all_the_way_round_wraps():
    model = Model(load_recipe("recipe:excavator"))
    host = host_of(INFO.export(model, "arm", ("sdg", "tip_angle")))
    params = model.at(np.full((3000, 3), 0.4)).astype(np.float32)
    params[:, 0] = np.random.default_rng(3).uniform(-60.0, 60.0, 3000)
    _, gravity = some(model, 3000, 3)
    status, reading = host.read(params, gravity)
    down = gravity.astype(np.float64)[:, None]
    exact = model.exact(params.astype(np.float64), down).tip_angle[:, 0]
    safe = np.isin(status, (OK, ROCKS))
    assert not np.any(safe & (exact < reading[:, 1]))
    # The angle is reduced in single precision: 60 rad are known to 4e-6, which turns a plane by as
    # much.
    np.testing.assert_allclose(reading[safe, 1], exact[safe], atol=2e-3)
    assert np.all(exact[(status == TIPS)] < 2e-3)
    assert OFF_RANGE not in status
    # In steps: 0 and 32767 are one posture, and -1 is the step before.
    for pair in ([0, 32767], [-1000, 31767]):
        both = host.read_i([[at, 9000, 20000] for at in pair], [[100, 0, -1000]] * 2)[1]
        np.testing.assert_allclose(both[0], both[1], atol=2)


def test_the_reading_names_the_two_contacts_over_which_it_would_tip():
    recipe = load_recipe("maps/paper_two.toml")
    model = Model(recipe)
    host = host_of(INFO.export(model, "two", ("tip_angle",)))
    params = model.at(np.full((1, 2), 0.5)).astype(np.float32)
    points = forward(recipe, params).centres[0]
    middle = points.mean(axis=0)
    for pair in ((0, 1), (1, 2), (2, 0)):
        # Gravity leans from the middle of the facet towards the middle of one side.
        gravity = (0.2 * middle + 0.8 * points[list(pair)].mean(axis=0))[None].astype(np.float32)
        _, status, reading = host.at(params[0], gravity)
        assert status[0] == OK
        assert set(reading["over"][0].tolist()) == set(pair)

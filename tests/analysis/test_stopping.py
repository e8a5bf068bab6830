"""Speeds of dead stops: closed forms of a box on feet, and what the C makes of a reading."""

import math
import subprocess
from dataclasses import replace

import numpy as np
import pytest

import lutgen
from firmware_export.host import RUNTIME
from lutgen.analysis import Posture, stop_speeds
from lutgen.parts import Force
from tests.fixtures.compiled import compile_c
from tests.fixtures.recipes import feet, rigid

X, Y, Z, G = 0.3, 0.2, 0.5, 9.80665
CORNERS = np.array([[X, Y, -Z], [X, -Y, -Z], [-X, Y, -Z], [-X, -Y, -Z]])
LEVEL = np.array([0.0, 0.0, -1.0])
SIDE, LEAN = math.hypot(Y, Z), math.atan2(Y, Z)  # from the com to the nearer edge


def box(scale=1.0, **more):
    return Posture(lutgen.parse_recipe(rigid(feet(scale * CORNERS), **more)), [])


def speeds(down=LEVEL, bump=0.0, degrees=0.0):
    found = stop_speeds(box(), down, np.radians([degrees]), bump)
    return float(found.all_at_once[0]), found.anyhow


@pytest.mark.parametrize(
    ("degrees", "kept"),
    [
        (0.0, (Z / math.hypot(X, Z)) ** 2),
        (90.0, (Z / SIDE) ** 2),
        # Off straight the impulse wanders along the edge, to its end: then the corner is the pivot.
        (-5.0, (Z / math.hypot(X, Z) * math.cos(math.radians(5.0))) ** 2),
        (math.degrees(math.atan2(Y, X)), Z * Z / (X * X + Y * Y + Z * Z)),
    ],
)
def test_what_a_stop_leaves_lifts_the_com_to_the_least_edge_and_no_further(degrees, kept):
    whole = math.sqrt(2.0 * G * (SIDE - Z))
    assert speeds(degrees=degrees) == pytest.approx((whole / math.sqrt(kept), whole), rel=1e-9)


def test_a_slope_and_a_bump_leave_what_the_com_has_yet_to_rise():
    t = math.radians(10.0)
    down = np.array([0.0, math.sin(t), -math.cos(t)])  # left side down
    # What it sinks on its way back over an edge of 10 deg less of a slope of 10 deg.
    share = 1.0 / (1.0 + 2.0 * math.sin(t) / math.sin(LEAN - t))
    rise = SIDE * (1 - math.cos(LEAN - t))
    assert speeds(down)[1] == pytest.approx(math.sqrt(2.0 * G * rise * share))
    # The lean that lifts the com most is that over the front: a long side turns less.
    turn, lean = math.asin(0.02 / (2.0 * X)), math.atan2(X, Z)
    risen = math.hypot(X, Z) * (math.cos(lean - turn) - math.cos(lean))
    assert speeds(bump=0.02)[1] == pytest.approx(math.sqrt(2.0 * G * (SIDE - Z - risen)))
    assert speeds(bump=0.3) == speeds(bump=1.0) == speeds(np.array([0.0, 1.0, -1.0])) == (0.0, 0.0)


def test_units_count_and_what_is_not_known_is_no_number():
    for unit, scale in (("mm", 1000.0), ("cm", 100.0)):
        found = stop_speeds(box(scale, unit=unit), LEVEL, [0.0]).anyhow
        assert found == pytest.approx(speeds()[1])
    assert math.isnan(stop_speeds(box(unit="1"), LEVEL, [0.0]).anyhow)
    robot = box().recipe
    heavy = replace(robot.links[0], mass=10.0)
    pulled = replace(
        robot, links=(heavy,), forces=(Force("rope", heavy.name, (0, 0, 0), (1, 0, 0)),)
    )
    assert math.isnan(stop_speeds(Posture(pulled, []), LEVEL, [0.0]).anyhow)


def test_an_uncertain_com_may_go_no_faster_than_any_com_in_its_ball():
    rng, rho, around = np.random.default_rng(3), 0.02, np.radians(np.arange(0.0, 360.0, 15.0))
    doubted = box(head=f"com_uncertainty = {rho}")
    for bump in (0.0, 0.02):
        for down in (LEVEL, np.array([0.05, -0.1, -1.0])):
            found = stop_speeds(doubted, down, around, bump)
            least, slowest = np.full(len(around), np.inf), np.inf
            for _ in range(100):
                off = rng.normal(size=3)
                corners = CORNERS - rho * off / np.linalg.norm(off)
                real = Posture(lutgen.parse_recipe(rigid(feet(corners))), [])
                there = stop_speeds(real, down, around, bump)
                assert (found.all_at_once <= there.all_at_once).all()
                assert found.anyhow <= there.anyhow
                least, slowest = np.minimum(least, there.all_at_once), min(slowest, there.anyhow)
            assert found.anyhow > 0.75 * slowest
            assert (found.all_at_once > 0.6 * least).all()


def test_the_c_is_never_above_and_little_below_where_an_edge_is_near(tmp_path):
    (tmp_path / "stop.c").write_text(
        '#include "smap.h"\n#include <stdio.h>\nint main(void)\n{\n  smap_reading_t r;\n'
        "  float h, t;\n  int gaps;\n"
        '  while (scanf("%f %f %f %d", &r.tip_angle, &h, &t, &gaps) == 4)\n'
        '    printf("%.9g\\n", (double)smap_stop_speed(&r, h, t, gaps));\n  return 0;\n}\n'
    )
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", f"-I{RUNTIME}"]
    compile_c([*flags, "stop.c", "-o", "stop"], tmp_path)
    tip = np.concatenate([np.geomspace(1e-3, 1.57, 200), [3.14, -0.1, -3.14]])
    heights, slopes = np.array([0.01, 0.5, 20.0]), np.array([0.0, 0.1, 0.3])
    places = list(zip(heights, slopes, strict=True))
    lines = [f"{angle} {height} {slope} 0" for angle in tip for height, slope in places]
    asked = "\n".join([*lines, "0.3 0.5 0 1", "0.3 nan 0 0", "0.3 0.5 -0.1 0"])
    told = subprocess.run([tmp_path / "stop"], input=asked, capture_output=True, text=True).stdout
    found = np.array(told.split(), float)
    angle = np.clip(tip, 1e-9, math.pi / 2.0)[:, None]
    less = 1.0 + 2.0 * np.sin(slopes) / np.sin(angle)
    true = np.sqrt(2.0 * G * (1.0 - np.cos(angle)) * heights / less)
    share = found[:600] / true.ravel()[:600]
    assert share.max() < 1.0
    assert share.min() > 0.93
    assert (found[600:603] > 0.0).all()
    assert (found[603:] == 0.0).all()
    down = np.array([math.sin(0.2), 0.1, -math.cos(0.2)])
    near = lutgen.evaluate(box().recipe, [[]], down, ("tip_angle",))["tip_angle"][0, 0]
    less = 1.0 + 2.0 * math.hypot(*down[:2]) / np.linalg.norm(down) / math.sin(near)
    # H = r cos(lean) of a com above the middle, and the angle to the nearest edge.
    assert math.sqrt(2.0 * G * Z * (1.0 - math.cos(near)) / less) < speeds(down)[1]

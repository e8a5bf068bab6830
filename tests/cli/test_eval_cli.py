"""`lutgen eval` of a recipe, a map and an export, and `lutgen export`: what they print."""

import math
import re
from functools import partial

import pytest

import lutgen
from firmware_export import exporter
from firmware_export.emit import package
from lutgen.quantities import CHANNELS
from tests.fixtures.commands import data, good, run, stdout
from tests.fixtures.exports import tripod_export
from tests.fixtures.recipes import feet, rigid, rocker, tripod

POINT = ("-p", "reach=0.3", "-p", "swing=10")
# Nose down by so much `rocker` rocks, stands on its front wheels, and tips over them.
SEEN = {"rocks": "0,0,-1", "stands": "0.36,0,-1", "tips": "1.5,0,-1"}
CART = feet([(0.3, 0.3, -0.4), (-0.3, 0.3, -0.4), (-0.3, -0.3, -0.4), (0.3, -0.3, -0.4)])
CART += '[[robot.link]]\nname = "body"\nmass = 10.0\n'
# Half the weight, ahead.
PULL = '[[robot.force]]\nname = "rope"\nlink = "body"\nposition = [0, 0, 0]\n'
PULL += "force = [49.03325, 0, 0]\n"


# Few points, and one codec: how exact and how small an export is, other tests ask.
QUICK = ("--codec", "contacts", "--max-error", "1%", "--channels", "sdg", "--name", "feet")


@pytest.fixture(scope="module", autouse=True)
def few_points():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(exporter, "export", partial(exporter.export, points=2000))
        yield


@pytest.fixture(scope="module")
def place(few_points, tmp_path_factory):
    """Return a folder with recipes, maps and an export, which no test changes.

    What the export printed is beside it.
    """
    folder = tmp_path_factory.mktemp("eval")
    for name, text in {
        "tripod": tripod(channels=CHANNELS, max_tilt=60.0),
        "rocker": rocker(channels=CHANNELS, nodes=33, max_tilt=60.0),
        "alone": rocker(channels=("status",), nodes=33, max_tilt=60.0),
    }.items():
        (folder / f"{name}.toml").write_text(text)
        lutgen.sweep(lutgen.parse_recipe(text), folder / f"{name}.h5")
    (folder / "cart.toml").write_text(rigid(CART, name="cart"))
    (folder / "pulled.toml").write_text(rigid(CART + PULL, name="pulled"))
    text = rigid(CART + PULL, name="roped", head="com_uncertainty = 0.05")
    (folder / "roped.toml").write_text(text)
    printed = stdout("export", folder / "tripod.h5", "-o", folder / "firmware", *QUICK)
    (folder / "printed").write_text(printed)
    return folder


def test_of_what_tips_over_no_forces_are_told(place):
    tips = run("eval", place / "tripod.toml", *POINT, "-g", "-1,0,-0.1")
    assert (tips.exit_code, "tips over" in tips.stdout) == (3, True)
    assert "normal forces" not in tips.stdout
    assert "nan" not in tips.stdout


def test_a_map_agrees_with_read_and_with_the_recipe(place):
    exact = data("eval", place / "tripod.toml", *POINT)
    report = data("eval", place / "tripod.h5", *POINT)
    read = lutgen.load_map(place / "tripod.h5").read([[0.3, math.radians(10.0)]], [[0, 0, -1]])
    assert (report["source"], report["on_chart"]) == ("interpolated", True)
    assert report["sdg"] == pytest.approx(read["sdg"][0], rel=1e-12)
    assert report["tip_angle_deg"] == pytest.approx(math.degrees(read["tip_angle"][0]), rel=1e-12)
    # Cells of 0.2 m and 45 deg: the same verdict and the same size of angle.
    assert report["standing"] is exact["standing"]
    assert report["tip_angle_deg"] == pytest.approx(exact["tip_angle_deg"], abs=10.0)


def test_off_the_chart_a_map_knows_nothing(place):
    # What nobody can tell is not a 0 that lets a script go on.
    report = data("eval", place / "tripod.h5", *POINT, "-g", "0,0,1", code=3)
    assert (report["on_chart"], report["standing"]) == (False, None)
    assert report["sdg"] is report["tip_angle_deg"] is None
    assert data("eval", place / "alone.h5", "-g", "0,0,1", code=3)["status"] is None
    assert "unknown: off the chart" in run("eval", place / "tripod.h5", "-g", "0,0,1").stdout


@pytest.mark.parametrize("name", ["rocker.toml", "rocker.h5", "alone.h5"])
@pytest.mark.parametrize("status", SEEN)
def test_rocking_is_neither_standing_nor_tipping_over(place, name, status):
    code = 3 if status == "tips" else 0
    report = data("eval", place / name, "-g", SEEN[status], code=code)
    assert (report["status"], report["standing"]) == (status, status != "tips")
    first, *rest = run("eval", place / name, "-g", SEEN[status]).stdout.splitlines()
    assert first.endswith(f": {'tips over' if status == 'tips' else status}")
    assert any("the worst of the nodes around" in line for line in rest) is name.endswith(".h5")


def test_metrics_tell_headings_in_which_it_rocks_from_those_in_which_it_stands(place):
    report = data("metrics", place / "rocker.toml", "--tilt", 10, "--headings", 4)
    assert report["level"]["status"] == "rocks"
    found = [entry["status"] for entry in report["headings"]]
    assert found == ["stands", "rocks", "stands", "rocks"]
    text = stdout("metrics", place / "rocker.toml", "--tilt", 10, "--headings", 4)
    assert [line.split()[1] for line in text.splitlines()[2:]] == ["rocks", *found]


def test_an_acceleration_is_read_as_the_gravity_that_an_accelerometer_would_show(place):
    braking = data("eval", place / "cart.toml", "-a", "-4.903325,0,0")
    assert braking == data("eval", place / "cart.toml", "-g", "0.5,0,-1")
    assert braking["tip_angle_deg"] == pytest.approx(
        math.degrees(math.atan2(0.3, 0.4) - math.atan2(1, 2))
    )
    # A pull of half the weight reads alike; of the com's ball 1 / |F| counts, as it moves the
    # weight alone.
    pulled, roped = (data("eval", place / f"{name}.toml") for name in ("pulled", "roped"))
    for key in ("sdg", "margin"):
        assert pulled[key] == pytest.approx(braking[key])
    loss = 0.05 / math.hypot(1.0, 0.5)
    assert roped["margin"] == pytest.approx(braking["margin"] - loss)
    assert roped["com_uncertainty"] == 0.05
    assert roped["resultant_over_weight"] == pytest.approx([0.5, 0.0, -1.0])
    assert roped["energy_margin"] is None
    text = stdout("eval", place / "roped.toml")
    assert "for any com    within 0.05 m" in text
    assert "resultant      1.11803 of the weight" in text
    assert "resultant" not in stdout("eval", place / "cart.toml")


def test_an_export_refuses_forces_and_a_picture_shows_them(place, tmp_path):
    result = run("export", place / "roped.toml", "-o", tmp_path / "out")
    assert result.exit_code == 2
    assert "counts the weight and no other force (got rope)" in result.stderr
    assert not (tmp_path / "out").exists()
    good("plot", place / "roped.toml", "-o", tmp_path / "robot.svg", "--kind", "robot")
    assert "force" in (tmp_path / "robot.svg").read_text()


def test_export_prints_codec_bytes_errors_guard_and_folder_of_the_channels_asked_for(place):
    text = (place / "printed").read_text()
    assert re.search(r"^feet: contacts, float arithmetic$", text, re.M)
    assert re.search(r"^flash +at most [\d,]+ bytes, the largest .* of code$", text, re.M)
    assert re.search(r"^sdg +largest error \S+ m \([\d.e-]+ %\), p99 \S+ m", text, re.M)
    assert re.search(r"^tip_angle +largest error \S+ deg", text, re.M)
    assert re.search(
        r"^verdict +guard \S+ deg, \S+ % of the stable .* reported unsafe, 0 points", text, re.M
    )
    assert text.splitlines()[-1] == f"folder     {place / 'firmware'}"


@pytest.mark.parametrize(
    ("arguments", "status", "standing"),
    [
        (("-p", "reach=9", "-p", "swing=10"), "SMAP_OFF_RANGE", None),
        ((*POINT, "-g", "1,0,-1"), "SMAP_TIPS", False),
        ((*POINT, "-g", "0,0,1"), "SMAP_OFF_CHART", None),
    ],
)
def test_eval_of_an_export_names_the_status_and_warns_beyond_its_axes(
    place, arguments, status, standing, caplog
):
    report = data("eval", place / "firmware", *arguments, code=0 if standing else 3)
    assert (report["status"], report["standing"]) == (status, standing)
    assert (report["sdg"] is None) == (standing is not True)
    beyond = "parameter reach is outside the export's range" in caplog.text
    assert beyond is (status == "SMAP_OFF_RANGE")


def test_eval_of_an_integer_export_gives_degrees_too(tmp_path):
    export = tripod_export("whole", codec="grid", arithmetic="integer")
    package.write(export, tmp_path / "whole")
    report = data("eval", tmp_path / "whole", *POINT, "-g", "0.02,0.01,-0.5")
    assert (report["status"], report["standing"]) == ("SMAP_OK", True)
    direction = [[[0.02, 0.01, -0.5]]]
    exact = export.model.exact([[0.3, math.radians(10.0)]], direction).tip_angle[0, 0]
    # The table holds the sine, interpolated from below between few nodes.
    assert 0.5 * exact < math.radians(report["tip_angle_deg"]) <= exact
    for beyond in ("reach=-1", "reach=9"):
        below = data("eval", tmp_path / "whole", "-p", beyond, "-p", "swing=10", code=3)
        assert below["status"] == "SMAP_OFF_RANGE"


def test_eval_of_an_export_takes_what_p_leaves_out_from_its_recipe(place):
    report = data("eval", place / "firmware", "-p", "reach=0.3")
    assert report["posture"] == {"reach_m": 0.3, "swing_deg": pytest.approx(5.0)}
    assert report["posture_from"] == "middle of the range: swing"
    whole = data("eval", place / "firmware", "-p", "reach=0.3", "-p", "swing=5")
    assert report.pop("sdg") == pytest.approx(whole.pop("sdg"), rel=1e-5)

"""`lutgen export` and `lutgen eval EXPORT_DIR`: what they print, and how they refuse."""

import json
import math
import re
from functools import partial

import pytest

import lutgen
from firmware_export import exporter
from firmware_export.emit import package
from tests.fixtures.commands import data
from tests.fixtures.commands import stdout as good
from tests.fixtures.exports import tripod_export
from tests.fixtures.recipes import tripod

POINT = ("-p", "reach=0.3", "-p", "swing=10")


# Few points, and one codec: how exact and how small an export is, other tests ask.
QUICK = ("--codec", "contacts", "--max-error", "1%")


@pytest.fixture(scope="module", autouse=True)
def few_points():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(exporter, "export", partial(exporter.export, points=2000))
        yield


@pytest.fixture(scope="module")
def place(few_points, tmp_path_factory):
    """Return a folder with a recipe, its map and its export, which no test changes.

    What the export printed is beside it.
    """
    folder = tmp_path_factory.mktemp("export")
    text = tripod(channels=("sdg", "tip_angle"))
    (folder / "tripod.toml").write_text(text)
    lutgen.sweep(lutgen.parse_recipe(text), folder / "tripod.h5")
    printed = good("export", folder / "tripod.h5", "-o", folder / "firmware", *QUICK)
    (folder / "printed").write_text(printed)
    return folder


def test_export_prints_codec_bytes_errors_guard_and_folder(place):
    text = (place / "printed").read_text()
    assert re.search(r"^tripod: contacts, float arithmetic$", text, re.M)
    assert re.search(r"^flash +at most [\d,]+ bytes, the largest .* of code$", text, re.M)
    assert re.search(r"^sdg +largest error \S+ m \([\d.e-]+ %\), p99 \S+ m", text, re.M)
    assert re.search(r"^tip_angle +largest error \S+ deg", text, re.M)
    assert re.search(
        r"^verdict +guard \S+ deg, \S+ % of the stable .* reported unsafe, 0 points", text, re.M
    )
    assert text.splitlines()[-1] == f"folder     {place / 'firmware'}"


def test_channels_and_name_are_those_asked_for(place, tmp_path):
    out = tmp_path / "out"
    options = ("--channels", "tip_angle", "--name", "feet")
    report = data("export", place / "tripod.h5", "-o", out, *QUICK, *options)
    assert list(report["channels"]) == ["tip_angle"]
    assert (out / "feet.h").is_file()


# eval


def test_eval_of_an_export_is_close_to_eval_of_its_recipe(place):
    compiled = data("eval", place / "firmware", *POINT, "-g", "0.1,0.05,-1")
    exact = data("eval", place / "tripod.toml", *POINT, "-g", "0.1,0.05,-1")
    assert compiled["source"] == "compiled"
    assert compiled["status"] == "SMAP_OK"
    assert compiled["standing"] is exact["standing"] is True
    assert compiled["robot"] == exact["robot"]
    report = json.loads((place / "firmware" / "tripod_report.json").read_text())
    largest = report["channels"]["sdg"]["error"]["max"]
    assert compiled["sdg"] == pytest.approx(exact["sdg"], abs=largest)
    largest = math.degrees(report["channels"]["tip_angle"]["error"]["max"])
    assert compiled["tip_angle_deg"] == pytest.approx(exact["tip_angle_deg"], abs=largest)
    assert "height" not in compiled


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
    # Of the sine, interpolated from below between few nodes.
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

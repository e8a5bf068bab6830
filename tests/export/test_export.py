"""From a recipe or a map to a folder: what is asked for is what comes out, certified."""

import json
import math
import tracemalloc
from dataclasses import replace

import pytest

import firmware_export
import lutgen
from firmware_export import choose, exporter
from firmware_export.grid import lookup
from lutgen.errors import ExportError, InputError, MapFileError, RecipeError
from tests.fixtures.compiled import contents
from tests.fixtures.fits import few_points, untried
from tests.fixtures.linkage import coded
from tests.fixtures.recipes import contact, feet, rigid, steered, tripod

ALL = ("sdg", "tip_angle", "height")
TEXT = tripod(nodes=5, channels=ALL)
RECIPE = lutgen.parse_recipe(TEXT)
POINTS = 4000


@pytest.fixture(autouse=True)
def quick():
    with few_points(), untried():
        yield


def run(directory, source=RECIPE, **more):
    """Export with a short certificate; `contacts` has one size, `grid` many."""
    options = {"codec": "contacts", "points": POINTS} | more
    return firmware_export.export(source, directory, **options)


def test_an_export_is_a_folder_of_sources_with_its_report(tmp_path):
    found = run(tmp_path / "out", max_error="1%")
    names = set(contents(tmp_path / "out"))
    own = {"tripod.h", "tripod.c", "examples/read.c", "examples/alarm.c"}
    assert own | {"smap.h"} <= names
    assert found == json.loads((tmp_path / "out" / "tripod_report.json").read_text("utf-8"))
    assert found["false_safe"] == 0
    percent = found["channels"]["sdg"]["error"]["max_percent"]
    assert found["certificate"]["error_percent"] == percent <= 1.0
    assert found["guard_deg"] > 0.0
    assert found["bytes"]["total"] > found["bytes"]["tables"] > 0
    assert found["points"] >= POINTS


def test_the_same_source_gives_the_same_bytes_from_recipe_file_and_map(tmp_path):
    (tmp_path / "robot.toml").write_text(TEXT)
    lutgen.sweep(RECIPE, tmp_path / "robot.h5")
    sources = (RECIPE, str(tmp_path / "robot.toml"), lutgen.load_map(tmp_path / "robot.h5"))
    folders = [tmp_path / f"out{i}" for i in range(len(sources))]
    for folder, source in zip(folders, sources, strict=True):
        run(folder, source, max_error="2%")
    first = contents(folders[0])
    for folder in folders[1:]:
        assert contents(folder) == first


def test_a_smaller_error_takes_more_bytes_and_flash_gives_the_most_accurate_that_fits(tmp_path):
    coarse, fine = (run(tmp_path / name, codec="grid", max_error=name) for name in ("2%", "0.05%"))
    # In the length unit, too.
    most = 0.02 * coarse["certificate"]["channels"]["sdg"]["range"]
    found = run(tmp_path / "length", codec="grid", max_error=most)["certificate"]
    assert found["bound"] == f"{most:g}"
    assert found["channels"]["sdg"]["max"] <= most
    most = coarse["bytes"]["total"] + 100
    fitting = run(tmp_path / "fitting", codec="grid", flash=most)
    assert fitting["bytes"]["total"] <= most
    assert coarse["bytes"]["tables"] < fine["bytes"]["tables"]
    coarse, fine, fitting = (one["certificate"] for one in (coarse, fine, fitting))
    assert fine["error_percent"] <= 0.05 < coarse["error_percent"] > fitting["error_percent"]


def test_without_limits_the_recipes_are_used_and_without_those_one_percent(tmp_path):
    default = run(tmp_path / "a")
    assert default["certificate"]["bound"] == "1 %"
    text = TEXT + '[export]\nmax_error = "3%"\n'
    assert run(tmp_path / "b", lutgen.parse_recipe(text))["certificate"]["bound"] == "3 %"
    # A limit that is given takes the place of all of the recipe's.
    text = TEXT + '[export]\nmax_error = "3%"\nflash = "1B"\n'
    given = run(tmp_path / "c", lutgen.parse_recipe(text), max_error="2%")
    assert given["certificate"]["bound"] == "2 %"


def test_a_limit_that_nothing_meets_is_refused_and_nothing_is_written(tmp_path):
    for limits in ({"flash": 10}, {"max_error": "1e-9%"}, {"flash": 10, "max_error": "1%"}):
        with pytest.raises(ExportError, match="nearest that can be had"):
            run(tmp_path / "out", **limits)
        assert list(tmp_path.iterdir()) == []


def test_channels_are_those_of_the_recipe_and_the_verdict_is_always_there(tmp_path):
    two = lutgen.parse_recipe(tripod(nodes=5))
    for number, (recipe, asked, given) in enumerate(
        (
            (RECIPE, None, list(ALL)),
            (RECIPE, ["sdg"], ["sdg", "tip_angle"]),
            (two, None, ["sdg", "tip_angle"]),
            (two, ["tip_angle"], ["tip_angle"]),
        )
    ):
        found = run(tmp_path / str(number), recipe, channels=asked, points=1000)
        assert list(found["channels"]) == given


def test_what_means_nothing_is_refused_in_a_sentence(tmp_path):
    two = lutgen.parse_recipe(tripod(nodes=5))
    for options, error, words in (
        ({"codec": "zip"}, InputError, "codec: 'zip' is unknown"),
        ({"arithmetic": "decimal"}, InputError, "arithmetic: 'decimal' is unknown"),
        ({"codec": "contacts", "arithmetic": "integer"}, ExportError, "floating point"),
        ({"source": "missing.toml"}, RecipeError, "no such file"),
        ({"source": "missing.h5"}, MapFileError, "no such file"),
        ({"source": two, "channels": ["height"]}, InputError, "has no channel 'height'"),
        ({"source": two, "channels": ["speed"]}, InputError, "'speed' cannot be exported"),
    ):
        with pytest.raises(error, match=words):
            run(tmp_path / "out", **options)
        assert list(tmp_path.iterdir()) == []


def test_a_robot_given_by_code_is_exported_from_its_recipe_but_not_from_a_map(tmp_path):
    path = tmp_path / "turning.toml"
    path.write_text(coded("round_about").text)
    with pytest.raises(RecipeError, match="--allow-python"):
        run(tmp_path / "out", path)
    found = run(tmp_path / "out", path, allow_python=True, codec="grid", max_error="5%")
    assert found["false_safe"] == 0
    found = run(tmp_path / "series", path, allow_python=True, codec="contacts", max_error="5%")
    assert found["false_safe"] == 0
    lutgen.sweep(lutgen.load_recipe(path, allow_python=True), tmp_path / "turning.h5")
    with pytest.raises(InputError, match="given by code, which a map does not hold"):
        run(tmp_path / "other", tmp_path / "turning.h5", allow_python=True)


@pytest.mark.parametrize(
    ("guard", "limits", "fault"),
    [
        (0.0, {"max_error": "2%"}, "called safe where it tips.*guard"),
        (0.3, {"flash": "4KiB"}, r"too much of what stands as unsafe.*more than 25 %"),
    ],
)
def test_a_codec_whose_guard_is_too_small_or_too_large_is_never_shipped(
    tmp_path, monkeypatch, guard, limits, fault
):
    encode = lookup.INFO.encode
    monkeypatch.setattr(lookup.INFO, "encode", lambda *given: replace(encode(*given), guard=guard))
    with pytest.raises(ExportError, match=fault):
        run(tmp_path / "out", codec="grid", **limits)
    assert list(tmp_path.iterdir()) == []


IN_A_ROW = "".join(contact(f"W{x}", (x, 0.0, -0.5), 0.1, (0, 1, 0)) for x in (-1, 0, 1))
ABOVE = feet(((1, 1, 0.5), (-1, 1, 0.5), (0, -1, 0.5)))


def test_a_robot_that_never_stands_is_refused_by_what_its_contacts_are(tmp_path):
    for contacts, codec, arithmetic in (
        (ABOVE, "contacts", "float"),
        (IN_A_ROW, "grid", "integer"),
    ):
        recipe = lutgen.parse_recipe(rigid(contacts))
        with pytest.raises(ExportError, match=r"robot.contact.*only ever answer that .* tips"):
            run(tmp_path / "out", recipe, codec=codec, arithmetic=arithmetic)
        assert list(tmp_path.iterdir()) == []


def test_a_certificate_worse_than_the_choice_leads_to_a_finer_export(tmp_path, monkeypatch):
    examine, seen = exporter.examine, []

    def pessimist(export, *given):
        found = examine(export, *given)
        seen.append(export.body.bytes)
        sdg = found.channels["sdg"]
        worse = sdg | {"max_percent": 1.6 * sdg["max_percent"]}
        return replace(found, channels=found.channels | {"sdg": worse})

    usual = run(tmp_path / "usual", codec="grid", max_error="1%")
    monkeypatch.setattr(exporter, "examine", pessimist)
    found = run(tmp_path / "worse", codec="grid", max_error="1%")
    assert seen[0] == usual["bytes"]["tables"]
    assert found["certificate"]["error_percent"] <= 1.0
    assert seen == sorted(set(seen)) or len(seen) == 1


MIB = 1 << 20
EIGHT = steered().replace("= 2", "= 61")


def test_a_robot_whose_map_would_be_petabytes_is_exported_in_bounded_memory(tmp_path, monkeypatch):
    recipe = lutgen.parse_recipe(EIGHT)
    assert len(recipe.parameters) == 8
    # float32 of two channels: 10 to the 14 bytes and more.
    assert 8 * recipe.grid.size * math.prod(recipe.chart.shape) > 1e14
    # Candidates are compared on a fifth of the points: what is chosen is certified anyway.
    monkeypatch.setattr(choose, "POINTS", 6000)
    tracemalloc.start()
    try:
        report = run(tmp_path / "out", recipe)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    # 8 nodes along each of 8 axes would be 128 MiB for a single number per node.
    assert peak < 100 * MIB
    found = report["certificate"]
    assert found["false_safe"] == 0
    assert found["channels"]["sdg"]["p99_percent"] <= 1.0
    assert found["false_tip"] < 0.1
    assert report["bytes"]["tables"] <= 1024


def test_a_grid_of_eight_parameters_is_refused_for_their_number(tmp_path):
    with pytest.raises(ExportError, match=r"at most 6 parameters \(got 8\).*contacts"):
        run(tmp_path / "out", lutgen.parse_recipe(EIGHT), codec="grid")
    assert not (tmp_path / "out").exists()

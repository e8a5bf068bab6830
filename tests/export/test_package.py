"""The export folder: what it holds, that it is a library, and that it is whole or not there."""

import errno
import math
import os
import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from firmware_export.emit import package, size
from firmware_export.emit.facts import report
from firmware_export.emit.render import texts
from lutgen.errors import ExportError, InputError
from tests.fixtures.compiled import contents, run
from tests.fixtures.exports import rover_export, tripod_export
from tests.fixtures.places import ROOT
from tests.fixtures.recipes import rover

NAMES = {
    *("feet.c", "feet.h", "smap.h", "LICENSE"),
    *("CMakeLists.txt", "library.json", "library.properties"),
    *("examples/read.c", "examples/alarm.c", "examples/ros2_node.cpp", "examples/feet/feet.ino"),
    *("zephyr/module.yml", "zephyr/CMakeLists.txt"),
    *("feet_report.json", "feet_report.md"),
}


@pytest.fixture(scope="module")
def export():
    return tripod_export("feet")


def text_of(export, name):
    """Return a file of text of an export, in one line without marks of comments."""
    return re.sub(r"[ \n*]+", " ", dict(texts(export, report(export)))[name])


def test_the_folder_holds_these_files_and_its_report_lists_them(export, tmp_path):
    content = package.write(export, tmp_path / "out")
    assert set(contents(tmp_path / "out")) == NAMES
    assert set(content["files"]) == NAMES
    assert package.load_report(tmp_path / "out") == content
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    # Another export elsewhere, in an empty folder, has the same bytes and is as readable as any.
    (tmp_path / "another").mkdir()
    package.write(tripod_export("feet"), tmp_path / "another")
    assert contents(tmp_path / "another") == contents(tmp_path / "out")
    assert (tmp_path / "out").stat().st_mode == (tmp_path / "another").stat().st_mode
    licence = (ROOT / "LICENSE").read_bytes()
    assert (tmp_path / "out" / "LICENSE").read_bytes() == licence
    for name, text in contents(tmp_path / "out").items():
        assert str(tmp_path).encode() not in text, name
        silent = name.endswith((".json", ".md")) or name == "LICENSE"
        assert silent or b"SPDX-License-Identifier: MIT" in text[:60], name


def test_the_report_has_what_a_program_asks_for(export, tmp_path):
    content = package.write(export, tmp_path / "out")
    assert content["codec"] == "contacts"
    assert content["recipe_sha256"] == export.recipe.digest
    assert content["parameters"][1] == {
        "name": "swing",
        "macro": "FEET_SWING",
        "unit": "rad",
        "display_unit": "deg",
        "min": export.recipe.parameters[1].minimum,
        "max": export.recipe.parameters[1].maximum,
        "slack": pytest.approx(0.5 * math.pi / 180.0),
        "meaning": "turns hip",
    }
    assert content["chart"] == {"kind": "cone", "faces": 1, "max_tilt_deg": pytest.approx(50.0)}
    assert content["channels"]["sdg"]["unit"] == "m"
    assert content["channels"]["sdg"]["error"]["max"] == 0.0123
    assert content["bytes"]["tables"] == export.body.bytes
    assert content["bytes"]["code"] == size.family_row("points", {})["code"]
    assert content["bytes"]["measured"] is False
    assert (content["false_safe"], content["false_tip"]) == (0, 0.0123)


# @TOTAL@, @CODE@ and @DIGEST@ are replaced.
HEADER = (
    "stability map of the robot tripod",
    "FEET_REACH 0 .. 0.6 m +- 0.003 shifts leg",
    "FEET_SWING -0.6981317 .. 0.8726646 rad (-40 .. 50 deg) +- 0.5 deg turns hip",
    "up to 50 deg of pitch and of roll",
    "at most @TOTAL@ bytes, the largest",
    "@CODE@ of code",
    "#define FEET_FLASH",
    "#define FEET_POSE_BYTES 120u",
    "#define FEET_STACK",
    "Errors on 512,345 points",
    "sdg 0.0123 m (0.82 %) 0.0045 m (0.3 %) 0.0011 m (0.073 %)",
    "tip_angle 1.146 deg 0.573 deg 0.1146 deg",
    "0 points are answered safe where the robot tips",
    "stable configurations reported unsafe: 1.23 %",
    "Recipe sha256 @DIGEST@",
    "#define FEET_PARAMS 2",
    "#define FEET_REACH 0",
    "#define FEET_SWING 1",
    "extern const smap_t feet;",
    'extern "C" {',
)
PAGE = (
    "Flash: at most @TOTAL@ bytes",
    "| `sdg` | stability factor \\|SD_g\\|, 0 at its most stable | m | 0.0123 m (0.82 %) |",
    "safe where the robot tips: 0.",
    "reported unsafe: 1.23 %",
    "were not counted",
    "| `FEET_SWING` | -0.6981317 .. 0.8726646 rad (-40 .. 50 deg) | +- 0.5 deg | turns hip |",
    "smap_pose(&feet, params, &pose.pose, sizeof pose, SMAP_FLOAT | SMAP_INTEGER);",
)


@pytest.mark.parametrize(("name", "parts"), [("feet.h", HEADER), ("feet_report.md", PAGE)])
def test_header_and_page_say_what_a_reader_must_know(export, name, parts):
    told = {"@TOTAL@": f"{report(export)['bytes']['total']:,}"}
    told |= {
        "@CODE@": f"{size.family_row('points', {})['code']:,}",
        "@DIGEST@": export.recipe.digest,
    }
    text = text_of(export, name)
    for part in parts:
        for key, value in told.items():
            part = part.replace(key, value)
        assert part in text, part


def test_what_has_no_bound_or_was_not_measured_is_not_claimed():
    sdg = {"largest_seen": 0.5, "largest_seen_percent": 40.0, "p99": 0.01, "rms": 0.02}
    jumps = rover_export(certificate={"points": 9, "channels": {"sdg": sdg}, "jumps": True})
    assert "no bound, seen: 0.5 m (40 %)" in text_of(jumps, "rover.h")
    text = text_of(tripod_export(certificate=None), "tripod.h")
    assert "Errors: not measured." in text
    assert "reported unsafe: not measured" in text
    assert "bytes, measured" not in text


def test_names_of_a_recipe_are_no_markup_on_the_page(export):
    content = package.contents(export)[1] | {"robot": "<script>alert(1)</script> ![x](//y)"}
    text = dict(texts(export, content))["feet_report.md"]
    assert "<script" not in text
    assert "&lt;script&gt;alert(1)&lt;/script&gt; \\!\\[x\\](//y)" in text


@pytest.mark.parametrize(
    ("make", "first"),
    [
        (tripod_export, "reach        0.3 m"),
        # On three wheels, which must not rock to the fourth; and on two rests over a diagonal.
        (lambda name: rover_export(name, text=rover(ahead=0.1, rock_angle=0.0)), "lift  "),
        (rover_export, "lift  "),
    ],
)
def test_the_example_compiles_in_one_command_and_prints_the_exact_reading(make, first, tmp_path):
    export = make("robot")
    package.write(export, tmp_path / "out")
    run(tmp_path / "out", "sh", "-c", "cc -std=c99 -I. *.c examples/read.c -o ../example")
    printed = run(tmp_path, "./example").splitlines()
    assert printed[0].startswith(first)
    middle = 0.5 * (export.model.lower + export.model.upper)
    exact = export.model.exact([middle], [[[0.0, 0.0, -1.0]]])
    values = {line.split()[0]: line.split()[1:] for line in printed if len(line.split()) == 3}
    rocks = "rocks between two rests, but does not tip over"
    assert (rocks if make is rover_export else "stands") in printed
    assert float(values["sdg"][0]) == pytest.approx(exact.sdg[0, 0], abs=0.01)
    assert float(values["height"][0]) == pytest.approx(exact.height[0, 0], abs=0.01)
    assert values["height"][1] == "m"
    # The guard is subtracted, the rest is far smaller.
    degrees = math.degrees(exact.tip_angle[0, 0] - float(export.tables.guard))
    assert float(values["tip_angle"][0]) == pytest.approx(degrees, abs=1.0)
    assert values["tip_angle"][1] == "deg"


def test_the_export_of_another_robot_is_replaced_by_force_alone(export, tmp_path):
    package.write(rover_export("old"), tmp_path / "out")
    before = contents(tmp_path / "out")
    with pytest.raises(InputError, match=r"of the robot 'rover' \(got 'tripod'\).*--force"):
        package.write(export, tmp_path / "out")
    assert contents(tmp_path / "out") == before
    package.write(export, tmp_path / "out", force=True)
    assert set(contents(tmp_path / "out")) == NAMES
    # The same robot's under another name needs no force.
    package.write(replace(export, name="old"), tmp_path / "out")
    package.write(export, tmp_path / "out")
    assert set(contents(tmp_path / "out")) == NAMES


def test_an_export_that_was_edited_is_replaced_with_force_alone(export, tmp_path):
    package.write(export, tmp_path)
    before = contents(tmp_path)
    (tmp_path / "smap.h").write_text("/* mine */\n")
    with pytest.raises(InputError, match=r"was edited .*'smap\.h'.*--force"):
        package.write(export, tmp_path)
    assert (tmp_path / "smap.h").read_text() == "/* mine */\n"
    package.write(export, tmp_path, force=True)
    assert contents(tmp_path) == before


@pytest.mark.parametrize("foreign", ["notes.txt", "main.c", ".hidden", "sub"])
def test_what_has_no_name_of_an_export_is_left_alone(export, tmp_path, foreign):
    package.write(export, tmp_path)
    mine = tmp_path / foreign
    mine.mkdir() if foreign == "sub" else mine.write_text("mine")
    before = contents(tmp_path)
    with pytest.raises(InputError, match=f"is not of an export .*{foreign!r}"):
        package.write(export, tmp_path)
    assert contents(tmp_path) == before
    package.write(rover_export("feet"), tmp_path, force=True)
    assert mine.is_dir() or mine.read_text() == "mine"
    assert set(contents(tmp_path)) | {foreign} == NAMES | {foreign}


@pytest.mark.parametrize("link", ["", "examples", "feet.h"])
def test_a_link_in_the_place_of_an_export_is_never_followed(export, tmp_path, link):
    victim, out = tmp_path / "victim", tmp_path / "out"
    victim.mkdir()
    if link:
        package.write(export, out)
        shutil.rmtree(out / link) if (out / link).is_dir() else (out / link).unlink()
    (out / link).symlink_to(victim)
    for force in (False, True):
        with pytest.raises(InputError, match=r"is a link|holds a link"):
            package.write(export, out, force=force)
    assert list(victim.iterdir()) == []


def test_a_file_or_a_missing_place_is_refused(export, tmp_path):
    (tmp_path / "file").write_text("mine")
    for place, fault in (("file", "is no folder"), ("no/such", "does not exist")):
        with pytest.raises(InputError, match=fault):
            package.write(export, tmp_path / place)
    assert contents(tmp_path) == {"file": b"mine"}


@pytest.mark.parametrize("after", [0, 3, 11])
def test_a_full_disk_leaves_nothing_behind_and_an_earlier_export_as_it_was(
    export, tmp_path, monkeypatch, after
):
    package.write(replace(export, certificate=None), tmp_path / "old")
    before, write = contents(tmp_path / "old"), Path.write_bytes

    for place in ("old", "new"):
        written = []

        def until_full(path, data, written=written):
            written.append(path)
            if len(written) > after:
                write(path, data[: len(data) // 2])
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            return write(path, data)

        monkeypatch.setattr(Path, "write_bytes", until_full)
        with pytest.raises(ExportError, match="No space left on device"):
            package.write(export, tmp_path / place)
    assert contents(tmp_path / "old") == before
    assert [path.name for path in tmp_path.iterdir()] == ["old"]


def test_a_damaged_report_is_one_sentence(export, tmp_path):
    package.write(export, tmp_path)
    path = tmp_path / "feet_report.json"
    text = path.read_text()
    for damaged, fault in (
        (text[:100], "damaged"),
        ("[]", "damaged"),
        ("\0", "damaged"),
        (text.replace('"length_unit"', '"lenght_unit"'), "damaged"),
        (text.replace('"lutgen_export": 2', '"lutgen_export": 3'), "another format"),
    ):
        path.write_text(damaged)
        with pytest.raises(InputError, match=fault):
            package.load_report(tmp_path)

"""The export folder: what it holds, that it is a library, and that it is whole or not there."""

import errno
import json
import math
import os
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from firmware_export.emit import package, size
from firmware_export.emit.render import texts
from firmware_export.protocol.exported import Export
from lutgen.errors import ExportError, InputError
from tests.fixtures.exports import PARETO, rover_export, tripod_export
from tests.fixtures.programs import contents, run
from tests.fixtures.recipes import rover

NAMES = {
    *("feet.c", "feet.h", "smap.h", "LICENSE"),
    *("CMakeLists.txt", "library.json", "library.properties"),
    *("examples/read.c", "examples/alarm.c", "examples/ros2_node.cpp", "examples/feet/feet.ino"),
    *("zephyr/module.yml", "zephyr/CMakeLists.txt"),
    *("feet_report.json", "feet_report.md"),
}


@pytest.fixture(scope="module")
def export() -> Export:
    """Return a small export."""
    return tripod_export("feet")


def full_disk(monkeypatch: pytest.MonkeyPatch, after: int) -> None:
    """Let the disk be full once this many files are written."""
    write, count = Path.write_bytes, [0]

    def write_bytes(self: Path, data: bytes) -> int:
        count[0] += 1
        if count[0] > after:
            write(self, data[: len(data) // 2])
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return write(self, data)

    monkeypatch.setattr(Path, "write_bytes", write_bytes)


# contents


def test_the_folder_holds_these_files_and_its_report_lists_them(
    export: Export, tmp_path: Path
) -> None:
    content = package.write(export, tmp_path / "out")
    assert set(contents(tmp_path / "out")) == NAMES
    assert set(content["files"]) == NAMES
    assert package.load_report(tmp_path / "out") == content
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_the_same_export_gives_the_same_bytes_wherever_it_goes(
    export: Export, tmp_path: Path
) -> None:
    package.write(export, tmp_path / "one")
    package.write(tripod_export("feet"), tmp_path / "another")
    assert contents(tmp_path / "one") == contents(tmp_path / "another")
    for name, content in contents(tmp_path / "one").items():
        assert str(tmp_path).encode() not in content, name


def test_the_report_has_what_a_program_asks_for(export: Export, tmp_path: Path) -> None:
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
        "slack": pytest.approx(0.5 * 3.141592653589793 / 180.0),
        "meaning": "turns hip",
    }
    assert content["chart"] == {"kind": "cone", "faces": 1, "max_tilt_deg": pytest.approx(50.0)}
    assert content["channels"]["sdg"]["unit"] == "m"
    assert content["channels"]["sdg"]["error"]["max"] == 0.0123
    assert content["bytes"]["tables"] == export.body.bytes == export.tables.bytes
    assert content["bytes"]["code"] == size.code_bytes("points")
    assert content["bytes"]["measured"] is False
    assert (content["false_safe"], content["false_tip"]) == (0, 0.0123)
    assert content["pareto"] == PARETO


def test_the_page_says_how_large_exact_safe_and_fast_it_is_and_how_to_call_it(
    export: Export, tmp_path: Path
) -> None:
    content = package.write(export, tmp_path / "out")
    page = (tmp_path / "out" / "feet_report.md").read_text()
    total = content["bytes"]["total"]
    for part in (
        f"Flash: at most {total:,} bytes",
        "| `sdg` | stability factor \\|SD_g\\|, 0 at its most stable | m | 0.0123 m (0.82 %) |",
        "safe where the robot tips: 0.",
        "reported unsafe: 1.23 %",
        "were not counted",
        "| `FEET_SWING` | -0.6981317 .. 0.8726646 rad (-40 .. 50 deg) | +- 0.5 deg | turns hip |",
        "smap_pose(&feet, params, &pose.pose, sizeof pose, SMAP_FLOAT | SMAP_INTEGER);",
    ):
        assert part in page, part
    assert f"#define FEET_FLASH      {total}u" in (tmp_path / "out" / "feet.h").read_text()
    assert len(page.splitlines()) < 70


# a library for others


def beside_the_diagonal(name: str) -> Export:
    """Return the export of a rover that stands on three wheels and must not rock to the fourth."""
    return rover_export(name, text=rover(ahead=0.1, rock_angle=0.0))


@pytest.mark.parametrize(
    ("make", "first"),
    [(tripod_export, "reach        0.3 m"), (beside_the_diagonal, "lift         0.4 m")],
)
def test_the_example_compiles_in_one_command_and_prints_the_exact_reading(
    make: Callable[..., Export], first: str, tmp_path: Path
) -> None:
    export = make("robot")
    folder = tmp_path / "out"
    package.write(export, folder)
    run(folder, "sh", "-c", "cc -std=c99 -I. *.c examples/read.c -o ../example")
    printed = run(tmp_path, "./example").splitlines()
    assert printed[0] == first
    middle = 0.5 * (export.model.lower + export.model.upper)
    exact = export.model.exact([middle], [[[0.0, 0.0, -1.0]]])
    values = {line.split()[0]: line.split()[1:] for line in printed if len(line.split()) == 3}
    # Level on four wheels of which one is lifted, it may rock.
    assert {"stands", "rocks between two rests, but does not tip over"} & set(printed)
    assert float(values["sdg"][0]) == pytest.approx(exact.sdg[0, 0], abs=0.01)
    assert float(values["height"][0]) == pytest.approx(exact.height[0, 0], abs=0.01)
    assert values["height"][1] == "m"
    # The guard is subtracted, the rest is far smaller.
    degrees = 57.29578 * (exact.tip_angle[0, 0] - float(export.tables.guard))
    assert float(values["tip_angle"][0]) == pytest.approx(degrees, abs=1.0)
    assert values["tip_angle"][1] == "deg"


def test_the_example_of_a_robot_that_balances_on_a_diagonal_says_that_it_rocks(
    tmp_path: Path,
) -> None:
    # Two rests meet in the diagonal: it rocks over it, and is far from tipping over.
    export = rover_export("robot")
    middle = 0.5 * (export.model.lower + export.model.upper)
    exact = export.model.exact([middle], [[[0.0, 0.0, -1.0]]])
    package.write(export, tmp_path / "out")
    run(tmp_path / "out", "sh", "-c", "cc -std=c99 -I. *.c examples/read.c -o ../example")
    printed = run(tmp_path, "./example").splitlines()
    assert exact.tip_angle[0, 0] > math.radians(30.0)
    assert "rocks between two rests, but does not tip over" in printed


@pytest.mark.needs("cmake")
def test_cmake_builds_the_library_and_the_example(export: Export, tmp_path: Path) -> None:
    package.write(export, tmp_path / "out")
    run(tmp_path, "cmake", "-S", "out", "-B", "build")
    run(tmp_path, "cmake", "--build", "build")
    assert (tmp_path / "build" / "libsmap_feet.a").is_file()
    assert "tip_angle" in run(tmp_path / "build", "./feet_example")


def test_platformio_and_arduino_get_a_name_a_version_and_a_header(
    export: Export, tmp_path: Path
) -> None:
    package.write(export, tmp_path / "out")
    content = json.loads((tmp_path / "out" / "library.json").read_text())
    lines = (tmp_path / "out" / "library.properties").read_text().splitlines()
    properties = dict(line.split("=", 1) for line in lines if not line.startswith("#"))
    assert content["name"] == properties["name"] == "smap_feet"
    assert content["version"] == properties["version"]
    assert len(content["version"].split(".")) == 3
    assert content["headers"] == properties["includes"] == "feet.h"
    # What has a main of its own is no part of the library.
    assert content["build"]["srcFilter"] == ["+<feet.c>"]
    for example in ("read", "alarm"):
        path = f"examples/{example}.c"
        run(tmp_path / "out", "cc", "-std=c99", "-I.", "-DARDUINO=100", "-c", path)


# replacing


def test_an_earlier_export_is_replaced_even_under_another_name(
    export: Export, tmp_path: Path
) -> None:
    package.write(replace(export, name="old"), tmp_path / "out")
    package.write(export, tmp_path / "out")
    assert set(contents(tmp_path / "out")) == NAMES


def test_the_export_of_another_robot_is_replaced_by_force_alone(
    export: Export, tmp_path: Path
) -> None:
    package.write(rover_export("old"), tmp_path / "out")
    before = contents(tmp_path / "out")
    with pytest.raises(InputError, match=r"of the robot 'rover' \(got 'tripod'\).*--force"):
        package.write(export, tmp_path / "out")
    assert contents(tmp_path / "out") == before
    package.write(export, tmp_path / "out", force=True)
    assert set(contents(tmp_path / "out")) == NAMES


def test_an_empty_folder_is_filled(export: Export, tmp_path: Path) -> None:
    package.write(export, tmp_path)
    assert set(contents(tmp_path)) == NAMES


def test_the_new_folder_is_as_readable_as_any(export: Export, tmp_path: Path) -> None:
    package.write(export, tmp_path / "out")
    (tmp_path / "plain").mkdir()
    assert (tmp_path / "out").stat().st_mode == (tmp_path / "plain").stat().st_mode


def test_a_folder_with_foreign_content_is_refused_and_left_alone(
    export: Export, tmp_path: Path
) -> None:
    for number, foreign in enumerate(["notes.txt", "main.c", ".hidden", "sub"]):
        out = tmp_path / str(number)
        package.write(export, out)
        (out / foreign).mkdir() if foreign == "sub" else (out / foreign).write_text("mine")
        before = contents(out)
        with pytest.raises(InputError, match=f"is not of an export .*{foreign!r}"):
            package.write(export, out)
        assert contents(out) == before
        assert (out / foreign).exists()


def test_an_export_that_was_edited_is_replaced_with_force_alone(
    export: Export, tmp_path: Path
) -> None:
    package.write(export, tmp_path / "out")
    before = contents(tmp_path / "out")
    config = tmp_path / "out" / "smap.h"
    config.write_text("/* mine */\n")
    with pytest.raises(InputError, match=r"was edited .*'smap\.h'.*--force"):
        package.write(export, tmp_path / "out")
    assert config.read_text() == "/* mine */\n"
    package.write(export, tmp_path / "out", force=True)
    assert contents(tmp_path / "out") == before


def test_force_leaves_what_has_no_name_of_an_export(export: Export, tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "feet.c").write_text("mine")
    package.write(rover_export("old"), tmp_path, force=True)
    package.write(export, tmp_path, force=True)
    assert (tmp_path / "notes.txt").read_text() == "mine"
    assert set(contents(tmp_path)) == NAMES | {"notes.txt"}


@pytest.mark.parametrize("link", ["", "examples", "feet.h"])
def test_a_link_in_the_place_of_an_export_is_never_followed(
    export: Export, tmp_path: Path, link: str
) -> None:
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


def test_names_of_a_recipe_are_no_markup_on_the_page(export: Export, tmp_path: Path) -> None:
    content = package.contents(export)[1] | {"robot": "<script>alert(1)</script> ![x](//y)"}
    text = dict(texts(export, content))["feet_report.md"]
    assert "<script" not in text
    assert "&lt;script&gt;alert(1)&lt;/script&gt; \\!\\[x\\](//y)" in text


def test_a_folder_of_somebody_elses_sources_is_refused(export: Export, tmp_path: Path) -> None:
    (tmp_path / "feet.c").write_text("int main(void) { return 0; }\n")
    for listed in (
        '{"files": ["feet.c"]}',
        '{"lutgen_export": 2, "files": [["feet.c"]], "sha256": {}}',
    ):
        (tmp_path / "other_report.json").write_text(listed)
        with pytest.raises(InputError, match=r"'feet\.c'"):
            package.write(export, tmp_path)
    assert (tmp_path / "feet.c").read_text().startswith("int main")


def test_a_file_or_a_missing_place_is_refused(export: Export, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    for place, fault in (("file", "is no folder"), ("no/such", "does not exist")):
        with pytest.raises(InputError, match=fault):
            package.write(export, tmp_path / place)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
    assert (tmp_path / "file").read_text() == "mine"


@pytest.mark.parametrize("after", [0, 3, 11])
def test_a_full_disk_leaves_nothing_behind_and_an_earlier_export_as_it_was(
    export: Export, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, after: int
) -> None:
    package.write(replace(export, certificate=None), tmp_path / "old")
    before = contents(tmp_path / "old")
    for place in ("old", "new"):
        with monkeypatch.context() as patch:
            full_disk(patch, after)
            with pytest.raises(ExportError, match="No space left on device"):
                package.write(export, tmp_path / place)
    assert contents(tmp_path / "old") == before
    assert [path.name for path in tmp_path.iterdir()] == ["old"]


def test_a_name_that_c_cannot_have_writes_nothing(export: Export, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="keyword"):
        package.write(replace(export, name="int"), tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


# reading a report back


def test_a_damaged_report_is_one_sentence(export: Export, tmp_path: Path) -> None:
    package.write(export, tmp_path / "out")
    path = tmp_path / "out" / "feet_report.json"
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
            package.load_report(tmp_path / "out")

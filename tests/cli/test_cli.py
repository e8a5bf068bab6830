"""The command line: what goes to stdout, what to stderr, and the exit codes."""

import csv
import json
import math
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import click
import h5py
import numpy as np
import pytest

import lutgen
from lutgen.cli import main
from lutgen.mapping.compute import Computer
from lutgen.plot import KINDS
from tests.fixtures.commands import data, good, run
from tests.fixtures.places import MAPS, VECTORS
from tests.fixtures.recipes import ALL_CHANNELS, feet, rigid, tripod

A0 = math.degrees(math.atan(0.6))


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a recipe and its map, which no test changes."""
    folder = tmp_path_factory.mktemp("cli")
    text = tripod(channels=ALL_CHANNELS, max_tilt=60.0)
    (folder / "tripod.toml").write_text(text)
    lutgen.sweep(lutgen.parse_recipe(text), folder / "tripod.h5")
    (folder / "bad.toml").write_text(text.replace("[[robot.contact]]", "[[robot.contcat]]", 1))
    (folder / "above.toml").write_text(rigid(feet([(1, 0, 1), (-1, 1, 1), (-1, -1, 1)])))
    (folder / "code.toml").write_text(rigid("", head='python = "cli_plugin:postures"'))
    (folder / "cli_plugin.py").write_text("def postures(q):\n    return 'nothing'\n")
    (folder / "text.h5").write_text("this is no HDF5")
    (folder / "folder.toml").mkdir()
    with h5py.File(folder / "tripod.h5", "r") as file:
        place = file["margin"].id.get_offset()
    content = bytearray((folder / "tripod.h5").read_bytes())
    content[place + 20] ^= 4
    (folder / "damaged.h5").write_bytes(content)
    return folder


POINT = ("-p", "reach=0.3", "-p", "swing=10")


# check


def test_check_prints_robot_parameters_nodes_size_and_time(place: Path) -> None:
    result = good("check", place / "tripod.toml")
    for part in (
        "tripod: 3 contacts (front left right), 2 parameters, unit m",
        "reach: 0 to 0.6 m, 4 nodes",
        "swing: -40 to 50 deg, 3 nodes",
        "cone, 1 face(s) of 7 x 7 nodes",
        "588 nodes, 4,116 values, 14.4 KiB",
    ):
        assert part in result.stdout
    assert result.stderr == ""


def test_check_as_json_agrees_with_the_file_that_a_sweep_writes(place: Path) -> None:
    report = data("check", place / "tripod.toml")
    assert report["nodes"] == 4 * 3 * 7 * 7
    assert report["channels"] == list(ALL_CHANNELS)
    assert report["parameters"] == {
        "reach": {"from": 0.0, "to": 0.6, "unit": "m", "nodes": 4},
        "swing": {"from": -40.0, "to": 50.0, "unit": "deg", "nodes": 3},
    }
    assert report["digest"] == lutgen.load_recipe(place / "tripod.toml").digest
    size = (place / "tripod.h5").stat().st_size
    # The values; the rest of the file is its header, some 50 kB of names and addresses.
    # Six channels of float32 and one of bytes.
    assert report["file_bytes"] == (6 * 4 + 1) * 588
    assert 0 < size - report["file_bytes"] < 60_000


# sweep


def test_sweep_writes_the_map_and_prints_nothing_on_stdout(place: Path, tmp_path: Path) -> None:
    result = good("sweep", place / "tripod.toml", "-o", tmp_path / "a.h5", "--threads", 1)
    assert result.stdout == ""
    assert str(tmp_path / "a.h5") in result.stderr
    assert (tmp_path / "a.h5").read_bytes() == (place / "tripod.h5").read_bytes()
    quiet = good("-q", "sweep", place / "tripod.toml", "-o", tmp_path / "a.h5")
    assert quiet.output == ""


def test_an_interrupted_sweep_says_how_to_go_on_and_does(
    place: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(self: Computer, block: object) -> None:
        raise KeyboardInterrupt

    path = tmp_path / "a.h5"
    with monkeypatch.context() as patch:
        patch.setattr(Computer, "compute", interrupt)
        result = run("sweep", place / "tripod.toml", "-o", path)
    assert result.exit_code == 1
    assert "--resume" in result.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["a.h5.part"]
    good("sweep", place / "tripod.toml", "-o", path, "--resume")
    assert path.read_bytes() == (place / "tripod.h5").read_bytes()


# info


def test_info_prints_axes_channels_ranges_and_provenance(place: Path) -> None:
    result = good("info", place / "tripod.h5", "--verify")
    for part in (
        f"stability map of tripod (format 2, lutgen {lutgen.__version__})",
        "reach: 0 to 0.6 m, 4 nodes",
        "swing: -40 to 50 deg, 3 nodes",
        "% of directions",
        lutgen.load_recipe(place / "tripod.toml").digest,
        "checksums: all good",
    ):
        assert part in result.stdout
    assert result.stderr == ""
    assert "checksums" not in good("info", place / "tripod.h5").stdout


def test_info_as_json_holds_the_ranges_of_the_stored_values(place: Path) -> None:
    report = data("info", place / "tripod.h5", "--verify")
    stability_map = lutgen.load_map(place / "tripod.h5")
    assert report["verified"] is True
    assert report["robot"] == "tripod"
    channels = {entry["name"]: entry for entry in report["channels"]}  # type: ignore[attr-defined]
    assert list(channels) == list(ALL_CHANNELS)
    words = channels.pop("status")
    assert (words["min"], words["max"], words["unit"]) == ("stands", "tips", "")
    assert report["definition"] == 3
    for name, entry in channels.items():
        values = stability_map.channel(name)
        scale = 180.0 / math.pi if name == "tip_angle" else 1.0
        finite = values[np.isfinite(values)]
        assert entry["min"] == pytest.approx(float(finite.min()) * scale, rel=1e-12)
        assert entry["max"] == pytest.approx(float(finite.max()) * scale, rel=1e-12)
    assert {name: entry["unit"] for name, entry in channels.items()} == {
        **dict.fromkeys(("sdg", "height", "margin", "energy_margin"), "m"),
        "tip_angle": "deg",
        "facet": "1",
    }
    assert 0.0 < float(report["share_that_tips"]) < 1.0  # type: ignore[arg-type]


def test_info_of_a_damaged_map_fails_only_where_it_looks(place: Path) -> None:
    result = run("info", place / "damaged.h5", "--verify")
    assert result.exit_code == 1
    assert "channel margin" in result.stderr
    assert result.stdout == ""


# eval


def paper_rows() -> Iterator[dict[str, str]]:
    """Yield the published values of the paper's robot."""
    lines = (VECTORS / "paper_sdg.csv").read_text(encoding="utf-8").splitlines()
    yield from csv.DictReader(line for line in lines if not line.startswith("#"))


def test_eval_of_the_papers_robot_equals_its_table_in_both_conventions(tmp_path: Path) -> None:
    wide = tmp_path / "wide.toml"
    # Some rows are beyond the limits of the recipe.
    text = (MAPS / "paper_two.toml").read_text(encoding="utf-8")
    wide.write_text(text.replace("max = 50.0", "max = 90.0"))
    recipe = lutgen.load_recipe(wide)
    rows = list(paper_rows())
    assert {row["convention"] for row in rows} == {"P", "F"}
    for row in rows:
        alpha, gamma = (
            A0 if row[key] == "A0" else float(row[key]) for key in ("alpha_deg", "gamma_deg")
        )
        gravity = "0,0,-1"
        if row["convention"] == "P":
            (p1, p2, p3), *_ = lutgen.postures(recipe, np.radians([[alpha, gamma]]))[0]
            up = np.cross(p2 - p1, p3 - p1)
            gravity = ",".join(repr(float(-x)) for x in up)
        point = ("-p", f"alpha={alpha!r}", "-p", f"gamma={gamma!r}", "-g", gravity)
        report = data("eval", wide, *point)
        # Half of the last printed digit, which for most rows is far below 1e-6.
        assert report["sdg"] == pytest.approx(
            float(row["sdg"]), abs=0.51 * float(row["unit_of_last_digit"])
        ), row


def test_eval_of_a_recipe_prints_every_channel_the_axis_and_the_forces(place: Path) -> None:
    result = good("eval", place / "tripod.toml", *POINT, "-g", "0.1,0.05,-1")
    for part in (
        "tripod (exact): stands",
        *("sdg ", "height ", "tip_angle ", " deg", "margin ", "energy_margin ", "facet "),
        *("slope ", "slides first", "least stable", "normal forces", "Eq 12"),
    ):
        assert part in result.stdout
    assert result.stderr == ""
    tips = run("eval", place / "tripod.toml", *POINT, "-g", "-1,0,-0.1")
    assert tips.exit_code == 3
    assert "tips over" in tips.stdout
    assert "normal forces" not in tips.stdout
    assert "nan" not in tips.stdout


def test_eval_as_json_agrees_with_evaluate(place: Path) -> None:
    recipe = lutgen.load_recipe(place / "tripod.toml")
    report = data("eval", place / "tripod.toml", *POINT, "-g", "0.1,0.05,-1")
    want = lutgen.evaluate(recipe, [[0.3, math.radians(10.0)]], [[0.1, 0.05, -1]], ALL_CHANNELS)
    for name in ("sdg", "height", "margin", "energy_margin", "facet"):
        assert report[name] == pytest.approx(want[name][0, 0], rel=1e-9)
    assert report["tip_angle_deg"] == pytest.approx(math.degrees(want["tip_angle"][0, 0]), rel=1e-9)
    assert sum(report["normal_forces"].values()) == pytest.approx(1.0, abs=1e-12)  # type: ignore[attr-defined]
    assert report["standing"] is True
    assert report["status"] == "stands"
    least = report["least_stable_axis"]
    assert report["axes"][least["index"]] == least  # type: ignore[index]


def test_eval_of_a_map_agrees_with_read_and_with_the_recipe(place: Path) -> None:
    exact = data("eval", place / "tripod.toml", *POINT)
    report = data("eval", place / "tripod.h5", *POINT)
    read = lutgen.load_map(place / "tripod.h5").read([[0.3, math.radians(10.0)]], [[0, 0, -1]])
    assert report["source"] == "interpolated"
    assert report["on_chart"] is True
    assert report["sdg"] == pytest.approx(read["sdg"][0], rel=1e-12)
    assert report["tip_angle_deg"] == pytest.approx(math.degrees(read["tip_angle"][0]), rel=1e-12)
    # Cells of 0.2 m and 45 deg: the same verdict and the same size of angle.
    assert report["standing"] is exact["standing"]
    assert report["tip_angle_deg"] == pytest.approx(float(exact["tip_angle_deg"]), abs=10.0)  # type: ignore[arg-type]


def test_eval_off_the_maps_chart_knows_nothing(place: Path) -> None:
    report = data("eval", place / "tripod.h5", *POINT, "-g", "0,0,1", code=3)
    assert report["on_chart"] is False
    assert report["standing"] is None
    assert report["sdg"] is report["tip_angle_deg"] is None
    text = run("eval", place / "tripod.h5", *POINT, "-g", "0,0,1").stdout
    assert "unknown" in text


def keys(value: object) -> Iterator[str]:
    """Yield every key of a JSON value."""
    if isinstance(value, dict):
        for key, inside in value.items():
            yield key
            yield from keys(inside)
    elif isinstance(value, list):
        for inside in value:
            yield from keys(inside)


def test_angles_in_json_carry_their_unit_in_the_key(place: Path) -> None:
    seen = set()
    for source in ("tripod.toml", "tripod.h5"):
        seen |= set(keys(data("eval", place / source, *POINT)))
    angles = {key for key in seen if any(word in key for word in ("angle", "slope", "tilt"))}
    assert angles >= {"tip_angle_deg", "slope_deg"}
    assert all(key.endswith(("_deg", "_rad")) for key in angles)


def test_a_direction_may_begin_with_a_minus_sign(place: Path) -> None:
    short = data("eval", place / "tripod.toml", *POINT, "-g", "-0.1,0,-1")
    long = data("eval", place / "tripod.toml", *POINT, "--gravity=-1,0,-10")
    assert short["tip_angle_deg"] == pytest.approx(long["tip_angle_deg"], rel=1e-12)


def test_a_parameter_beyond_its_limits_is_refused_of_a_recipe_and_of_its_map(place: Path) -> None:
    for source in ("tripod.h5", "tripod.toml"):
        result = run("eval", place / source, "-p", "reach=0.9", "-p", "swing=10")
        assert result.exit_code == 2
        assert "parameter reach must lie in 0 to 0.6 m (got -p reach=0.9)" in result.stderr


# Every bad input is one sentence on stderr, nothing on stdout, and exit code 2 (bad input or
# usage) or 1 (the task failed).  Of `plot` this is all that is tested here.

BAD: dict[str, tuple[int, tuple[str, ...], str]] = {
    "no such command": (2, ("bake",), "bake"),
    "no such option": (2, ("check", "tripod.toml", "--fast"), "--fast"),
    "check without a recipe": (2, ("check",), "RECIPE"),
    "check a missing recipe": (2, ("check", "none.toml"), "none.toml"),
    "check a folder": (2, ("check", "folder.toml"), "folder.toml"),
    "check a bad recipe": (2, ("check", "bad.toml"), "contcat"),
    "check a robot that never stands": (2, ("check", "above.toml"), "stands in none"),
    "check code": (2, ("check", "code.toml"), "--allow-python"),
    "check code that returns no postures": (
        2,
        ("check", "code.toml", "--allow-python"),
        "got 'str'",
    ),
    "check a text called a map": (2, ("check", "text.h5"), "is no HDF5 file"),
    "check what the gallery lacks": (2, ("check", "recipe:tripod"), "recipe:tripod"),
    "recipes of no such name": (2, ("recipes", "tripod"), "choose from: absolem"),
    "sweep without an output": (2, ("sweep", "tripod.toml"), "--output"),
    "sweep a bad recipe": (2, ("sweep", "bad.toml", "-o", "x.h5"), "contcat"),
    "sweep into no folder": (2, ("sweep", "tripod.toml", "-o", "none/x.h5"), "none/x.h5"),
    "sweep into a file": (2, ("sweep", "tripod.toml", "-o", "text.h5/x.h5"), "text.h5/x.h5"),
    "sweep onto a folder": (2, ("sweep", "tripod.toml", "-o", "folder.toml"), "folder"),
    "sweep onto nothing": (2, ("sweep", "tripod.toml", "-o", ""), "names nothing"),
    "sweep with no thread": (
        2,
        ("sweep", "tripod.toml", "-o", "x.h5", "--threads", "0"),
        "threads",
    ),
    "sweep with two and a half": (
        2,
        ("sweep", "tripod.toml", "-o", "x.h5", "--threads", "2.5"),
        "2.5",
    ),
    "sweep with another engine": (
        2,
        ("sweep", "tripod.toml", "-o", "x.h5", "--engine", "gpu"),
        "gpu",
    ),
    "info of nothing": (2, ("info", "none.h5"), "none.h5"),
    "info of a text file": (2, ("info", "text.h5"), "text.h5"),
    "info of a folder": (2, ("info", "folder.toml"), "is a folder"),
    "info of a recipe": (2, ("info", "tripod.toml"), "tripod.toml"),
    "verify damage": (1, ("info", "damaged.h5", "--verify"), "damaged"),
    "info of damage": (2, ("info", "damaged.h5"), "damaged"),
    "eval of nothing": (2, ("eval", "none.h5", *POINT), "none.h5"),
    "eval of damage": (2, ("eval", "damaged.h5", *POINT), "damaged"),
    "eval of a text file": (2, ("eval", "text.h5", *POINT), "text.h5"),
    "eval with an unknown one": (2, ("eval", "tripod.h5", *POINT, "-p", "beta=1"), "beta"),
    "eval with one twice": (2, ("eval", "tripod.h5", *POINT, "-p", "reach=1"), "twice"),
    "eval with no number": (2, ("eval", "tripod.h5", "-p", "reach=far"), "reach=far"),
    "eval with nan": (2, ("eval", "tripod.h5", "-p", "reach=nan"), "reach=nan"),
    "eval with no name": (2, ("eval", "tripod.h5", "-p", "=1"), "=1"),
    "eval with no equals": (2, ("eval", "tripod.h5", "-p", "reach"), "reach"),
    "eval with no gravity": (2, ("eval", "tripod.h5", *POINT, "-g", "0,0,0"), "0,0,0"),
    "eval with flat gravity": (2, ("eval", "tripod.h5", *POINT, "-g", "0,-1"), "0,-1"),
    "eval with nan gravity": (2, ("eval", "tripod.h5", *POINT, "-g", "0,0,nan"), "nan"),
    "eval with gravity in words": (2, ("eval", "tripod.h5", *POINT, "-g", "down"), "down"),
    "plot without a kind": (2, ("plot", "tripod.h5", "-o", "x.png"), "--kind"),
    "plot an unknown kind": (2, ("plot", "tripod.h5", "-o", "x.png", "--kind", "pie"), "pie"),
    "plot without an output": (2, ("plot", "tripod.h5", "--kind", "polar"), "--output"),
    "plot nothing": (2, ("plot", "none.h5", "-o", "x.png", "--kind", "contour"), "none.h5"),
    "plot an unknown axis": (
        2,
        ("plot", "tripod.h5", "-o", "x.png", "--kind", "contour", "--axes", "reach,beta"),
        "beta",
    ),
    "plot an unknown channel": (
        2,
        ("plot", "tripod.h5", "-o", "x.png", "--kind", "contour", "--channel", "tilt"),
        "tilt",
    ),
    "plot an unknown parameter": (
        2,
        ("plot", "tripod.h5", "-o", "x.png", "--kind", "robot", "-p", "beta=1"),
        "beta",
    ),
    "plot an unknown format": (2, ("plot", "tripod.h5", "-o", "x.bmp", "--kind", "contour"), "bmp"),
}


@pytest.mark.parametrize(("code", "arguments", "part"), BAD.values(), ids=BAD)
def test_bad_input_is_one_sentence_and_an_exit_code(
    code: int,
    arguments: tuple[str, ...],
    part: str,
    place: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    folder = Path(shutil.copytree(place, tmp_path / "here"))
    monkeypatch.chdir(folder)
    # Python keeps what it compiled of a recipe's code, if it may.
    shutil.rmtree(folder / "__pycache__", ignore_errors=True)
    monkeypatch.setattr("sys.dont_write_bytecode", True)
    before = sorted(p.name for p in folder.iterdir())
    result = run(*arguments)
    assert result.exit_code == code, result.output
    assert result.stdout == ""
    assert part in result.stderr
    assert "Traceback" not in result.stderr
    sentences = [line for line in result.stderr.splitlines() if line.startswith("Error: ")]
    assert len(sentences) == 1
    # Nothing is left behind either.
    assert sorted(p.name for p in folder.iterdir()) == before


def test_resuming_with_another_recipe_is_bad_input(place: Path, tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    (tmp_path / "a.h5.part").write_bytes((place / "tripod.h5").read_bytes())
    other = tmp_path / "other.toml"
    other.write_text((place / "tripod.toml").read_text().replace("nodes = 7", "nodes = 9"))
    result = run("sweep", other, "-o", path, "--resume")
    assert result.exit_code == 2
    assert "another recipe" in result.stderr


# help and start-up


@pytest.mark.parametrize(
    "command", [[], ["check"], ["sweep"], ["info"], ["eval"], ["plot"], ["export"]]
)
def test_help_is_printed_for_both_spellings(command: list[str]) -> None:
    short, long = good(*command, "-h"), good(*command, "--help")
    assert short.stdout == long.stdout
    assert short.stdout.startswith("Usage: main " + " ".join(command))


def test_version_is_that_of_the_package() -> None:
    assert good("--version").stdout == f"lutgen, version {lutgen.__version__}\n"


@pytest.fixture
def python() -> Callable[..., subprocess.CompletedProcess[str]]:
    """Return a function that runs this interpreter in a process of its own."""

    def start(*arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([sys.executable, *arguments], capture_output=True, text=True)

    return start


@pytest.mark.parametrize(
    "arguments", [["--help"], ["eval", "--help"], ["export", "--help"], ["--version"]]
)
def test_help_imports_nothing_heavy(
    arguments: list[str], python: Callable[..., subprocess.CompletedProcess[str]]
) -> None:
    code = (
        "import sys\nfrom lutgen.cli import main\n"
        f"try:\n    main({arguments!r})\nexcept SystemExit as end:\n    assert end.code == 0\n"
        "heavy = {'numpy', 'numba', 'matplotlib', 'pydantic', 'scipy'} & set(sys.modules)\n"
        "print('heavy:', *sorted(heavy))\n"
    )
    done = python("-c", code)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1].strip() == "heavy:"
    assert len(done.stdout.splitlines()) > 1


def test_a_recipe_is_evaluated_without_what_only_maps_figures_and_compiling_need(
    place: Path, python: Callable[..., subprocess.CompletedProcess[str]]
) -> None:
    point = ["eval", str(place / "tripod.toml"), *POINT]
    code = (
        "import sys\nfrom lutgen.cli import main\n"
        f"try:\n    main({point!r})\nexcept SystemExit as end:\n    assert not end.code\n"
        "heavy = {'h5py', 'matplotlib', 'lutgen.urdf', 'scipy.linalg'} & set(sys.modules)\n"
        "print('heavy:', *sorted(heavy))\n"
    )
    # The first may have to compile.
    for _ in range(2):
        done = python("-c", code)
        assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1].strip() == "heavy:"


def test_the_command_offers_the_kinds_of_figures_that_there_are() -> None:
    offered = next(p.type for p in main.commands["plot"].params if p.name == "kind")
    assert isinstance(offered, click.Choice)
    assert set(offered.choices) == set(KINDS)


def test_the_command_in_a_process_of_its_own_keeps_stdout_for_results(
    place: Path, python: Callable[..., subprocess.CompletedProcess[str]]
) -> None:
    start = "import sys; from lutgen.cli import main; main(sys.argv[1:])"
    done = python(
        "-c", start, "eval", str(place / "tripod.h5"), "-p", "reach=0.3", "-p", "swing=0", "--json"
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["standing"] is True
    failed = python("-c", start, "info", str(place / "text.h5"))
    assert failed.returncode == 2
    assert failed.stdout == ""
    assert failed.stderr.startswith("Error: ")
    assert "Traceback" not in failed.stderr


def test_a_console_without_a_character_shows_its_number(
    place: Path,
    python: Callable[..., subprocess.CompletedProcess[str]],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("PYTHONIOENCODING", "cp1252")
    text = (place / "tripod.toml").read_text(encoding="utf-8")
    (place / "arrow.toml").write_text(text.replace('"tripod"', '"a \u2192 b"'), encoding="utf-8")
    done = python("-m", "lutgen", "check", str(place / "arrow.toml"))
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("a \\u2192 b: ")

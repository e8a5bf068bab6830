"""`lutgen recipes`, `new`, `schema`, `check`, `sweep` and `info`, and what they replace."""

import json
import math
import shutil
from pathlib import Path

import numpy as np
import pytest

import lutgen
from lutgen.files import is_ours
from lutgen.mapping.compute import Computer
from lutgen.quantities import CHANNELS
from lutgen.recipe import recipe_schema, start_recipes
from tests.fixtures.commands import broken_off, data, good, run, stdout
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import tripod

KINDS = list(start_recipes())
MINE = b"my thesis"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "r.toml").write_text(tripod("reach = 2, swing = 2", nodes=3))


@pytest.mark.parametrize("kind", KINDS)
def test_a_recipe_to_start_from_stands_as_it_is_and_explains_its_tables(kind):
    assert data("new", kind, "-o", "robot.toml") == {"kind": kind, "recipe": "robot.toml"}
    report = data("check", "robot.toml")
    assert len(report["contacts"]) >= 4
    assert len(report["parameters"]) >= 1
    # A map of it takes no more than some megabytes and a few seconds.
    assert report["file_bytes"] < 2**24
    # It does not fall over when somebody pushes it.
    assert all(row["tilt_deg"] > 10.0 for row in data("limits", "robot.toml")["limits"])
    text = Path("robot.toml").read_text(encoding="utf-8")
    assert text.startswith(f"# {start_recipes()[kind]}\n")
    for table in ("parameter", "link", "contact"):
        before = text.partition(f"[[robot.{table}]]")[0]
        assert before.rstrip().splitlines()[-1].startswith("#"), table
    assert max(map(len, text.splitlines())) <= 100
    # A file that was edited stays, unless it is forced.
    Path("robot.toml").write_text("mine")
    assert run("new", kind, "-o", "robot.toml").exit_code == 2
    assert Path("robot.toml").read_text(encoding="utf-8") == "mine"
    good("new", "wheels", "-o", "robot.toml", "--force")
    assert lutgen.load_recipe("robot.toml").name == "rover"


def test_the_schema_is_printed_as_it_is():
    assert json.loads(stdout("schema")) == recipe_schema()


def test_every_recipe_of_the_gallery_is_listed_with_what_it_is():
    entries = {entry["name"]: entry for entry in data("recipes")["recipes"]}
    assert list(entries) == sorted(path.stem for path in MAPS.glob("*.toml"))
    for name, entry in entries.items():
        recipe = lutgen.load_recipe(MAPS / f"{name}.toml")
        assert entry["source"] == f"recipe:{name}"
        assert entry["digest"] == recipe.digest
        assert entry["contacts"] == list(recipe.contact_names)
        assert entry["nodes"] == data("check", f"recipe:{name}")["nodes"]
        # One sentence, whole: it begins like the file and ends with its first full stop.
        assert entry["description"].endswith(".")
        assert recipe.text.startswith(f"# {entry['description'][:40]}")
    text = stdout("recipes")
    assert all(f"recipe:{name} " in text for name in entries)


@pytest.mark.parametrize("name", ["absolem", "recipe:absolem"])
def test_one_recipe_is_printed_as_it_is_written(name):
    text = (MAPS / "absolem.toml").read_text(encoding="utf-8")
    assert stdout("recipes", name) == text
    assert data("recipes", name)["text"] == text


def test_a_sweep_prints_nothing_on_stdout_and_goes_on_after_an_interruption(monkeypatch):
    result = good("sweep", "r.toml", "-o", "a.h5", "--threads", 1)
    assert (result.stdout, "a.h5" in result.stderr) == ("", True)
    assert good("-q", "sweep", "r.toml", "-o", "a.h5").output == ""

    def interrupt(self, block):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(Computer, "compute", interrupt)
        result = run("sweep", "r.toml", "-o", "b.h5")
    assert (result.exit_code, "--resume" in result.stderr) == (1, True)
    assert sorted(path.name for path in Path().iterdir()) == ["a.h5", "b.h5.part", "r.toml"]
    good("sweep", "r.toml", "-o", "b.h5", "--resume")
    assert Path("a.h5").read_bytes() == Path("b.h5").read_bytes()


def test_check_foresees_the_size_of_a_map_and_info_tells_its_ranges_and_provenance():
    Path("tripod.toml").write_text(tripod(channels=CHANNELS, max_tilt=60.0))
    foreseen = data("check", "tripod.toml")
    assert foreseen["nodes"] == 4 * 3 * 7 * 7
    # Seven channels of float32 and one of bytes; the rest of the file is some 50 kB of names.
    assert foreseen["file_bytes"] == (7 * 4 + 1) * 588
    good("sweep", "tripod.toml", "-o", "tripod.h5")
    assert 0 < Path("tripod.h5").stat().st_size - foreseen["file_bytes"] < 60_000
    assert "checksums: all good" in good("info", "tripod.h5", "--verify").stdout
    assert "checksums" not in good("info", "tripod.h5").stdout
    report = data("info", "tripod.h5", "--verify")
    stability_map = lutgen.load_map("tripod.h5")
    assert (report["verified"], report["robot"], report["definition"]) == (True, "tripod", 3)
    channels = {entry["name"]: entry for entry in report["channels"]}
    assert list(channels) == list(CHANNELS)
    words = channels.pop("status")
    assert (words["min"], words["max"], words["unit"]) == ("stands", "tips", "")
    for name, entry in channels.items():
        values = stability_map.channel(name)
        scale = 180.0 / math.pi if name == "tip_angle" else 1.0
        finite = values[np.isfinite(values)]
        assert entry["min"] == pytest.approx(float(finite.min()) * scale, rel=1e-12)
        assert entry["max"] == pytest.approx(float(finite.max()) * scale, rel=1e-12)
    assert {name: entry["unit"] for name, entry in channels.items()} == {
        **dict.fromkeys(("sdg", "height", "margin", "energy_margin"), "m"),
        "tip_angle": "deg",
        "least_share": "1",
        "facet": "1",
    }
    assert 0.0 < report["share_that_tips"] < 1.0


def refused(name, *arguments):
    """Run a command that must refuse to replace a file, and leave it as it is."""
    before, names = Path(name).read_bytes(), sorted(path.name for path in Path().iterdir())
    result = run(*arguments)
    assert result.exit_code == 2, result.stderr
    assert name in result.stderr
    assert Path(name).read_bytes() == before
    assert sorted(path.name for path in Path().iterdir()) == names


def test_a_sweep_replaces_maps_and_nothing_else():
    Path("thesis.txt").write_bytes(MINE)
    refused("thesis.txt", "sweep", "r.toml", "-o", "thesis.txt")
    for _ in range(2):
        good("sweep", "r.toml", "-o", "a.h5")
    good("sweep", "r.toml", "-o", "thesis.txt", "--force")
    assert is_ours("thesis.txt")
    Path("link.h5").symlink_to("r.toml")
    refused("link.h5", "sweep", "r.toml", "-o", "link.h5", "--force")


def test_unfinished_work_is_neither_thrown_away_without_a_word_nor_followed():
    good("sweep", "r.toml", "-o", "a.h5")
    older = Path("a.h5").read_bytes()
    broken_off(lutgen.load_recipe("r.toml"), "a.h5")
    assert Path("a.h5").read_bytes() == older
    refused("a.h5.part", "sweep", "r.toml", "-o", "a.h5")
    shutil.copy("a.h5.part", "b.h5.part")
    good("sweep", "r.toml", "-o", "a.h5", "--resume")
    good("sweep", "r.toml", "-o", "b.h5", "--force")
    assert Path("a.h5").read_bytes() == Path("b.h5").read_bytes()
    # A file of somebody else, and a link.
    Path("c.h5.part").write_bytes(MINE)
    Path("d.h5.part").symlink_to("r.toml")
    for name, more in (("c", ()), ("c", ("--resume",)), ("d", ("--resume",)), ("d", ("--force",))):
        refused(f"{name}.h5.part", "sweep", "r.toml", "-o", f"{name}.h5", *more)
    good("sweep", "r.toml", "-o", "c.h5", "--force")
    assert not Path("c.h5.part").exists()

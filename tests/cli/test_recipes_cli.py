"""`lutgen recipes`, `new`, `schema` and `check`."""

import json
from pathlib import Path

import pytest

import lutgen
from lutgen.recipe import recipe_schema, start_recipes
from tests.fixtures.commands import data, good, run, stdout
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import ALL_CHANNELS, tripod

KINDS = list(start_recipes())


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


# new


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


# schema


def test_the_schema_is_printed_as_it_is():
    assert json.loads(stdout("schema")) == recipe_schema()


# recipes


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


# check


def test_check_foresees_the_size_of_the_map():
    Path("tripod.toml").write_text(tripod(channels=ALL_CHANNELS, max_tilt=60.0))
    report = data("check", "tripod.toml")
    assert report["nodes"] == 4 * 3 * 7 * 7
    # Seven channels of float32 and one of bytes; the rest of the file is some 50 kB of names.
    assert report["file_bytes"] == (7 * 4 + 1) * 588
    good("sweep", "tripod.toml", "-o", "tripod.h5")
    assert 0 < Path("tripod.h5").stat().st_size - report["file_bytes"] < 60_000

"""`lutgen new` and `lutgen schema`: recipes to start from, and what editors check them by."""

import json
import re
import tomllib
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

import lutgen
from lutgen.recipe import start_recipes
from tests.fixtures.commands import data, good, run, stdout
from tests.fixtures.documents import blocks

PAGE = "docs/guide/recipe.md"
KINDS = list(start_recipes())


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Make an empty folder the working one."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("kind", KINDS)
def test_a_recipe_to_start_from_is_checked_and_stands_as_it_is(kind: str) -> None:
    good("new", kind, "-o", "robot.toml")
    report = data("check", "robot.toml")
    assert len(report["contacts"]) >= 4
    assert len(report["parameters"]) >= 1
    # A map of it takes no more than some megabytes and a few seconds.
    assert report["file_bytes"] < 2**24
    limits = data("limits", "robot.toml")
    # It does not fall over when somebody pushes it.
    assert all(row["tilt_deg"] > 10.0 for row in limits["limits"])


@pytest.mark.parametrize("kind", KINDS)
def test_a_recipe_to_start_from_explains_its_tables(kind: str) -> None:
    good("new", kind, "-o", "robot.toml")
    text = Path("robot.toml").read_text(encoding="utf-8")
    assert text.startswith(f"# {start_recipes()[kind]}\n")
    for table in ("parameter", "link", "contact"):
        before = text.partition(f"[[robot.{table}]]")[0]
        assert before.rstrip().splitlines()[-1].startswith("#"), table
    assert max(map(len, text.splitlines())) <= 100


def test_the_list_has_every_kind_with_a_sentence() -> None:
    lines = stdout("new", "--list").splitlines()
    assert [line.split()[0] for line in lines] == ["wheels", "tracks", "legs", "arm"]
    assert all(line.endswith(".") for line in lines)
    assert list(data("new", "--list")["kinds"]) == KINDS


def test_a_file_that_is_there_stays_unless_it_is_forced() -> None:
    Path("robot.toml").write_text("mine")
    result = run("new", "wheels", "-o", "robot.toml")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "robot.toml: is there already, without a mark" in result.stderr
    assert Path("robot.toml").read_text() == "mine"
    report = data("new", "wheels", "-o", "robot.toml", "--force")
    assert report == {"kind": "wheels", "recipe": "robot.toml"}
    assert lutgen.load_recipe("robot.toml").name == "rover"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("track", "-o", "a.toml"), "(got 'track'); did you mean 'tracks'"),
        (("boat", "-o", "a.toml"), "use one of: wheels, tracks, legs, arm"),
        (("wheels",), "needs a file to write (got none)"),
        ((), "needs a kind (got none)"),
        (("wheels", "-o", "none/a.toml"), "choose a folder that exists"),
    ],
)
def test_what_is_wrong_with_the_command_is_one_sentence(
    arguments: tuple[str, ...], said: str, folder: Path
) -> None:
    result = run("new", *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert said in result.stderr
    assert result.stderr.count("\n") == 1
    assert list(folder.iterdir()) == []


def test_the_schema_that_is_printed_is_one_and_tells_recipes_from_others() -> None:
    schema = json.loads(stdout("schema"))
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    Draft202012Validator.check_schema(schema)
    good("new", "legs", "-o", "robot.toml")
    values = tomllib.loads(Path("robot.toml").read_text(encoding="utf-8"))
    assert Draft202012Validator(schema).is_valid(values)
    values["robot"]["contact"][0]["radios"] = 0.1
    assert not Draft202012Validator(schema).is_valid(values)


def changed(text: str) -> str:
    """Return a recipe with what the page says to write instead of other lines."""
    (edits,) = blocks(PAGE, "diff")
    for old, new in re.findall(r"^-(.*)\n\+(.*)$", edits, re.MULTILINE):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def timeless(text: str) -> str:
    """Return what a command prints without the time that computing takes here."""
    return re.sub(r"about [\d.]+ s", "about - s", text)


def test_everything_in_the_guide_to_recipes_runs_and_prints_what_it_shows() -> None:
    shown = iter(blocks(PAGE, "text"))
    robot = Path("robot.toml")
    edits = 0
    for block in blocks(PAGE, "sh"):
        for line in block.splitlines():
            command, _, target = line.partition(" > ")
            program, *arguments = command.split()
            assert program == "lutgen"
            if arguments[0] == "eval" and not edits:
                robot.write_text(changed(robot.read_text(encoding="utf-8")))
                edits += 1
            printed = stdout(*arguments)
            if target:
                Path(target).write_text(printed)
            else:
                assert timeless(printed) == timeless(next(shown)), line
    assert next(shown, None) is None
    assert edits == 1
    # The file that editors are pointed to is the one that was written.
    (first,) = blocks(PAGE, "toml")
    assert Path(first.removeprefix("#:schema ").strip()).is_file()

"""What commands take to work on: a file, `recipe:NAME`, or a map with its recipe inside."""

import shutil
from pathlib import Path

import pytest

import lutgen
from lutgen.errors import RecipeError
from lutgen.recipe import gallery_names, gallery_text
from tests.fixtures.commands import data, good, run, stdout
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import rigid, tripod

AT = ("-p", "reach=0.3", "-p", "swing=10")
WHEEL = '[[robot.wheel]]\ncontact = "front"\naxis = [0, 1, 0]\nradius = 0.1\n'
# Every command that wants a recipe, and what it is asked; a figure or a map has its file's name.
ASKED: dict[str, tuple[object, ...]] = {
    "check": (),
    "sweep": ("-o",),
    "limits": AT,
    "metrics": (*AT, "--headings", 4),
    "optimum": ("--method", "map"),
    "wheels": AT,
    "path": (*AT, "--points", 4, "--no-control"),
}


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a recipe, its map, and the map under a name without an ending."""
    folder = tmp_path_factory.mktemp("sources")
    text = tripod().replace("[sweep]", f"{WHEEL}\n[sweep]", 1)
    (folder / "tripod.toml").write_text(text)
    lutgen.sweep(lutgen.parse_recipe(text), folder / "tripod.h5")
    shutil.copy(folder / "tripod.h5", folder / "tripod")
    return folder


@pytest.mark.parametrize("command", ASKED)
@pytest.mark.parametrize("name", ["tripod.h5", "tripod"])
def test_a_map_given_for_a_recipe_answers_as_the_recipe_inside_it(
    command: str, name: str, place: Path, tmp_path: Path
) -> None:
    answers = []
    for source in ("tripod.toml", name):
        arguments = [place / source, *ASKED[command]]
        if command == "sweep":
            target = tmp_path / f"{source}.h5"
            good(command, *arguments, target)
            answers.append(target.read_bytes())
        else:
            result = run(command, *arguments)
            answers.append(f"{result.exit_code} {result.output}".encode())
    assert answers[0] == answers[1]
    assert b"Error" not in answers[0]


def test_a_map_swept_again_is_the_same_file(place: Path, tmp_path: Path) -> None:
    good("sweep", place / "tripod.h5", "-o", tmp_path / "again.h5")
    assert (tmp_path / "again.h5").read_bytes() == (place / "tripod.h5").read_bytes()


def test_a_map_given_to_python_for_a_recipe_is_told_from_a_text(place: Path) -> None:
    with pytest.raises(RecipeError, match=r"got HDF5, as maps are.*load_map\(path\).recipe"):
        lutgen.load_recipe(place / "tripod.h5")
    assert lutgen.load_map(place / "tripod.h5").recipe.name == "tripod"


def test_the_code_of_a_recipe_inside_a_map_runs_only_where_it_is_allowed(tmp_path: Path) -> None:
    code = (
        "import numpy as np\n"
        "FEET = np.array([[1.0, 1, -1], [-1, 1, -1], [-1, -1, -1], [1, -1, -1]])\n"
        "def postures(q):\n"
        "    return np.repeat(FEET[None], len(q), 0), np.zeros((len(q), 3))\n"
    )
    (tmp_path / "sources_plugin.py").write_text(code)
    (tmp_path / "code.toml").write_text(rigid("", head='python = "sources_plugin:postures"'))
    recipe = lutgen.load_recipe(tmp_path / "code.toml", allow_python=True)
    lutgen.sweep(recipe, tmp_path / "code.h5")
    refused = run("limits", tmp_path / "code.h5")
    assert refused.exit_code == 2
    assert "--allow-python" in refused.stderr
    allowed = [
        stdout("limits", tmp_path / name, "--allow-python") for name in ("code.toml", "code.h5")
    ]
    assert allowed[0] == allowed[1]


# recipe:NAME


def test_every_recipe_of_the_gallery_is_listed_with_what_it_is() -> None:
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
def test_one_recipe_is_printed_as_it_is_written(name: str) -> None:
    text = (MAPS / "absolem.toml").read_text(encoding="utf-8")
    assert stdout("recipes", name) == text
    assert data("recipes", name)["text"] == text


@pytest.mark.parametrize(
    ("command", "asked"),
    [
        ("check", ()),
        ("eval", ("-p", "alpha=31")),
        ("limits", ()),
        ("metrics", ("-p", "alpha=31", "--headings", 4)),
        ("optimum", ("--method", "map")),
    ],
)
def test_a_recipe_of_the_gallery_answers_like_its_file(
    command: str, asked: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = stdout(command, MAPS / "paper_one.toml", *asked)
    # Wherever the user is.
    monkeypatch.chdir(tmp_path)
    assert stdout(command, "recipe:paper_one", *asked) == expected


def test_a_map_and_a_figure_are_made_of_a_recipe_of_the_gallery(tmp_path: Path) -> None:
    made, expected = tmp_path / "one.h5", tmp_path / "expected.h5"
    good("sweep", "recipe:paper_one", "-o", made)
    lutgen.sweep(lutgen.load_recipe(MAPS / "paper_one.toml"), expected)
    assert made.read_bytes() == expected.read_bytes()
    good("plot", "recipe:paper_one", "-o", tmp_path / "one.png", "--kind", "robot")
    assert (tmp_path / "one.png").read_bytes().startswith(b"\x89PNG")


def test_a_name_that_the_gallery_lacks_is_answered_with_one_that_it_has() -> None:
    for arguments in (("check", "recipe:absolme"), ("recipes", "absolme")):
        result = run(*arguments)
        assert result.exit_code == 2
        assert result.stdout == ""
        assert "recipe:absolme" in result.stderr
        assert "did you mean 'absolem'" in result.stderr
    with pytest.raises(RecipeError, match="choose from: absolem, articulated"):
        gallery_text("recipe:../tests/zzz")


def test_the_gallery_needs_no_other_file() -> None:
    # In a wheel nothing stands beside them but each other.
    for name in gallery_names():
        recipe = lutgen.parse_recipe(gallery_text(name), inert=True)
        assert (recipe.python, recipe.urdf) == (None, None)

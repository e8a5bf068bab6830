"""`lutgen explore`: a page is made of what there is, whole, small and the same every time."""

import json
import re
from pathlib import Path

import pytest
from click.testing import CliRunner

import lutgen
from firmware_export.codecs import codec
from firmware_export.emit import write
from firmware_export.explore import answers_of_recipe, page_text, scene_of
from firmware_export.protocol import Export
from firmware_export.truth import Model
from lutgen.cli import main
from lutgen.files import is_ours
from tests.fixtures.places import MAPS

MOST_BYTES = 1_500_000
WIND = """[[robot.force]]
name = "wind"
link = "body"
position = [0, 0, 0]
force = [1, 0, 0]

"""
GALLERY = sorted(path.stem for path in MAPS.glob("*.toml"))


def explored(*arguments: object) -> tuple[int, str]:
    result = CliRunner().invoke(main, ["explore", *map(str, arguments)])
    return result.exit_code, result.output


@pytest.fixture(scope="module")
def page() -> str:
    recipe = lutgen.load_recipe("recipe:paper_two")
    return page_text(recipe, answers_of_recipe(recipe))


def data_of(page: str) -> dict:
    return json.loads(re.search(r'id="data">(.*?)</script>', page, re.DOTALL)[1])


def test_a_page_is_one_file_that_asks_nothing_of_anybody(page: str) -> None:
    shell = re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)
    assert not re.search(r"""(?:src|href)\s*=\s*["'](?!data:)""", shell)
    assert "@import" not in shell
    assert "url(" not in shell
    # Names of namespaces and messages of three.js are addresses; nothing fetches one.
    assert not re.search(r"fetch\(\s*[\"'`]|importScripts|new WebSocket", page)


def test_a_page_has_at_most_a_megabyte_and_a_half(page: str) -> None:
    assert len(page.encode()) <= MOST_BYTES


def test_a_page_is_a_pure_function_of_its_recipe(page: str) -> None:
    recipe = lutgen.load_recipe("recipe:paper_two")
    assert page_text(recipe, answers_of_recipe(recipe)) == page


def test_no_name_of_a_robot_ends_a_script() -> None:
    text = (MAPS / "paper_one.toml").read_text().replace("P1", "</script><b>")
    recipe = lutgen.parse_recipe(text, "r.toml")
    page = page_text(recipe, answers_of_recipe(recipe))
    assert "</script><b>" not in page
    assert data_of(page)["scene"]["contacts"][0]["name"] == "</script><b>"


def test_the_licences_are_in_the_page(page: str) -> None:
    assert "three.js authors" in page


@pytest.mark.parametrize("name", GALLERY)
def test_a_scene_has_every_part_of_a_robot(name: str) -> None:
    recipe = lutgen.load_recipe(f"recipe:{name}")
    scene = scene_of(recipe)
    assert {one["name"] for one in scene["links"]} == {link.name for link in recipe.links}
    assert all(link["parent"] < at for at, link in enumerate(scene["links"]))
    assert [one["name"] for one in scene["contacts"]] == list(recipe.contact_names)
    assert [one["home"] for one in scene["parameters"]] == list(recipe.home_params)


def test_a_folder_is_asked_with_its_own_tables(tmp_path: Path) -> None:
    recipe, info = lutgen.load_recipe("recipe:paper_one"), codec("contacts")
    model = Model(recipe)
    spec = info.sizes(model, ("tip_angle",), "float")[0]
    tables = info.encode(model, ("tip_angle",), spec)
    export = Export("mine", recipe, model, "contacts", "float", ("tip_angle",), tables)
    held = write(export, tmp_path / "firmware")["tables"]["blob"]
    code, output = explored(tmp_path / "firmware", "-o", tmp_path / "page.html")
    assert code == 0, output
    assert data_of((tmp_path / "page.html").read_text())["map"]["blob"] == held
    other = explored(
        *(tmp_path / "firmware", "-o", tmp_path / "p.html", "--recipe", "recipe:paper_two")
    )
    assert other[0] == 2
    assert "was exported from another recipe" in other[1]


def test_a_page_carries_the_mark_and_nothing_else_is_replaced(tmp_path: Path) -> None:
    path, asked = tmp_path / "page.html", ("recipe:paper_one", "-o", tmp_path / "page.html")
    assert explored(*asked)[0] == explored(*asked)[0] == 0
    path.write_text("mine")
    assert explored(*asked)[0] == 2
    assert path.read_text() == "mine"
    assert explored(*asked, "--force")[0] == 0
    assert is_ours(path)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("[sweep]", f"{WIND}[sweep]"), "under forces"),
        (None, "is no name of a page"),
    ],
)
def test_what_no_page_can_show_is_refused_in_a_sentence(
    change: tuple[str, str] | None, words: str, tmp_path: Path
) -> None:
    text = (MAPS / "absolem.toml").read_text()
    path = tmp_path / "robot.toml"
    path.write_text(text.replace(*change, 1) if change else text)
    code, output = explored(path, "-o", tmp_path / ("page.html" if change else "page.pdf"))
    assert (code, words in output) == (2, True), output
    assert "Traceback" not in output

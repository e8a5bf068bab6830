"""`lutgen explore`: a page is made of what there is, whole, small and the same every time."""

import base64
import hashlib
import json
import re

import pytest

import lutgen
from firmware_export import exporter
from firmware_export.explore import answers_of_recipe, page_text, scene_of
from lutgen.files import is_ours
from tests.fixtures.commands import run
from tests.fixtures.fits import untried
from tests.fixtures.places import MAPS
from tools.engine import MODULE, build, clang_version

MOST_BYTES = 1_500_000
WIND = """[[robot.force]]
name = "wind"
link = "body"
position = [0, 0, 0]
force = [1, 0, 0]

"""


def explored(*arguments):
    result = run("explore", *arguments)
    return result.exit_code, result.output


@pytest.fixture(scope="module")
def page():
    recipe = lutgen.load_recipe("recipe:paper_two")
    return page_text(recipe, answers_of_recipe(recipe))


def data_of(page):
    return json.loads(re.search(r'id="data">(.*?)</script>', page, re.DOTALL)[1])


def test_a_page_is_one_file_that_may_load_nothing_and_the_same_every_time(page):
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', page)[1]
    rules = dict(rule.split(" ", 1) for rule in policy.split("; "))
    assert rules["default-src"] == "'none'"
    assert rules.keys() == {"default-src", "img-src", "style-src", "script-src"}
    for kind, rule in (("script", "script-src"), ("style", "style-src")):
        pattern = rf"<{kind}(?: type=.module.)?>(.*?)</{kind}>"
        found = re.findall(pattern, page, re.DOTALL)
        digests = [base64.b64encode(hashlib.sha256(one.encode()).digest()) for one in found]
        allowed = re.findall(r"'sha256-(.*?)'", rules[rule])
        assert [one.decode() for one in digests] == allowed
    shell = re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)
    assert not re.search(r"""(?:src|href)\s*=\s*["'](?!data:)|\son\w+=|style=|url\(""", shell)
    assert "three.js authors" in page
    assert len(page.encode()) <= MOST_BYTES
    recipe = lutgen.load_recipe("recipe:paper_two")
    assert page_text(recipe, answers_of_recipe(recipe)) == page


def test_no_name_of_a_robot_ends_a_script():
    text = (MAPS / "paper_one.toml").read_text().replace("P1", "</script><b>")
    recipe = lutgen.parse_recipe(text, "r.toml")
    page = page_text(recipe, answers_of_recipe(recipe))
    assert "</script><b>" not in page
    assert data_of(page)["scene"]["contacts"][0]["name"] == "</script><b>"


def test_a_scene_has_every_part_of_a_robot():
    for path in MAPS.glob("*.toml"):
        recipe = lutgen.load_recipe(path)
        scene, known = scene_of(recipe), {None}
        for link in scene["links"]:
            assert link["parent"] in known, path  # links are drawn in this order
            known.add(link["name"])
        assert len(known) == len(recipe.links) + 1
        assert [one["name"] for one in scene["contacts"]] == list(recipe.contact_names)
        home = [one["home"] * one["unit"] for one in scene["parameters"]]
        assert home == pytest.approx(list(recipe.home_params), rel=1e-11), path


def test_a_folder_is_asked_and_the_head_tells_its_certificate(tmp_path):
    folder, page = tmp_path / "firmware", tmp_path / "page.html"
    with untried():
        report = exporter.export(
            lutgen.load_recipe("recipe:paper_one"), folder, codec="contacts", points=2000
        )
    code, output = explored(folder, "-o", page)
    assert code == 0, output
    text = page.read_text()
    assert data_of(text)["answers"]["blob"] == report["tables"]["blob"]
    head = re.search(r"<header>.*?<p>(.*?)</p>", text, re.DOTALL)[1]
    assert "export paper_one" in head
    assert head.count("certified on 2,000 points: 0 falsely safe") == 1
    (told,) = folder.glob("*_report.json")
    told.write_text(told.read_text().replace('"false_safe": 0', '"false_safe": 7'))
    assert explored(folder, "-o", page)[0] == 0
    assert is_ours(page)
    assert "certified on 2,000 points: 7 falsely safe" in page.read_text()


def test_what_no_page_can_show_is_refused_in_a_sentence(tmp_path):
    one = lutgen.load_recipe("recipe:paper_one")
    with untried():
        exporter.export(one, tmp_path / "whole", arithmetic="integer", points=1000)
    path = tmp_path / "robot.toml"
    path.write_text((MAPS / "absolem.toml").read_text().replace("[sweep]", f"{WIND}[sweep]", 1))
    for asked, words in (
        ((path, "-o", tmp_path / "page.html"), "under forces"),
        ((tmp_path / "whole", "-o", tmp_path / "page.html"), "without floats"),
    ):
        code, output = explored(*asked)
        assert (code, words in output) == (2, True), output


@pytest.mark.needs("clang", "wasm-ld")
def test_the_webassembly_is_what_the_sources_give(tmp_path):
    held = MODULE.read_bytes()
    if clang_version().encode() not in held:
        pytest.skip(f"{clang_version()} is not what the module says that it was made by")
    build(tmp_path / "made.wasm")
    assert (tmp_path / "made.wasm").read_bytes() == held, "run make engine"

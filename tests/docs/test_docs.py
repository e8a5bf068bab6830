"""What the README and the documents show is run here, and what they list is compared."""

import pkgutil
import re
import shutil
import tomllib
from functools import partial
from pathlib import Path

import pytest
from click.testing import CliRunner

import lutgen
from firmware_export import exporter
from lutgen.channels import acceptance_of
from lutgen.cli import main
from lutgen.recipe import robot_size_of
from tests.cli.test_alike import VERDICTS
from tests.fixtures.commands import stdout
from tests.fixtures.compiled import compile_c, run
from tests.fixtures.places import DOCUMENTS, MAPS, ROOT, SOURCES, blocks
from tests.fixtures.recipes import rocker
from tools.recipe_page import SCHEMA, TABLES, TARGET
from tools.recipe_page import page as rewritten

PAPER = "docs/guide/paper.md"
RECIPES = TARGET.read_text(encoding="utf-8")


def test_the_papers_numbers_in_the_guide_are_those_of_its_commands(monkeypatch):
    monkeypatch.chdir(ROOT)
    (shell,) = blocks(PAPER, "sh")
    printed = {}
    for line in shell.splitlines():
        _, *arguments = line.split()
        # The whole report has tests of its own.
        if arguments[0] != "paper":
            result = CliRunner().invoke(main, arguments)
            # Over the paper's terrain the robot tips, with a shape that adapts too.
            code = 3 if arguments[0] == "path" else 0
            assert result.exit_code == code, f"{line}: {result.output}"
            printed[arguments[0]] = result.stdout
    assert "30.9568" in printed["optimum"]
    assert "150" in printed["optimum"]
    counts = tuple(re.findall(r"tips over at (\d+)", printed["path"]))
    page = (ROOT / PAPER).read_text(encoding="utf-8")
    said = re.search(r"at (\d+) of 100 points with .*? at (\d+)\s+when", page, re.DOTALL)
    assert counts == said.groups()
    assert len(printed) == 3


def test_everything_in_the_firmware_guide_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    # `make maps` certifies on half a million points; that both guards hold is seen on fewer.
    monkeypatch.setattr(exporter, "export", partial(exporter.export, points=5_000))

    def printed_by(line):
        program, *arguments = line.split()
        return stdout(*arguments) if program == "lutgen" else run(tmp_path, "sh", "-c", line)

    Path("slider.toml").write_text(*blocks("docs/guide/firmware.md", "toml"))
    Path("slider.py").write_text(*blocks("docs/guide/firmware.md", "python"))
    printed = [
        printed_by(line)
        for block in blocks("docs/guide/firmware.md", "sh")
        for line in block.splitlines()
    ]
    export, exact, compiled, _, reading, _, by_code = printed
    heights = [
        float(re.search(r"^height +([\d.]+)", text, re.MULTILINE)[1])
        for text in (exact, compiled, reading)
    ]
    # All three answer for the same posture; 0.5 % was demanded.
    assert max(heights) - min(heights) < 0.005 * heights[0]
    (shown,) = blocks("docs/guide/firmware.md", "text")
    assert export.splitlines()[:2] == shown.splitlines()[:2]
    assert "0 points said to stand that tip" in export
    assert "0 points said to stand that tip" in by_code
    assert "contacts 1e-05" in by_code
    folders = ("paper_firmware", "paper_firmware", "paper_integer")
    codes = blocks("docs/guide/firmware.md", "c")
    for folder, code in zip(folders, codes, strict=True):
        Path("use.c").write_text(code)
        flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", f"-I{folder}", "-fPIC", "-shared"]
        compile_c([*flags, "use.c", f"{folder}/paper_two.c", "-o", "use.so"], tmp_path)


def test_the_readme_is_short_and_names_the_python_that_the_project_requires():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 120
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert f"Python {project['requires-python'].replace('>=', '>= ')}" in text


@pytest.mark.needs("cmake")
def test_cmake_makes_the_folder_again_when_the_recipe_changes(tmp_path, monkeypatch):
    (function,) = blocks("docs/guide/firmware.md", "cmake")
    recipe = tmp_path / "one.toml"
    shutil.copyfile(MAPS / "paper_one.toml", recipe)
    (tmp_path / "main.c").write_text(
        '#include "one.h"\nint main(void) { return smap_check(&one); }'
    )
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.18)\nproject(app C)\n" + function + "\n"
        "lutgen_export(one one.toml --flash 4KiB)\n"
        "add_executable(app main.c)\ntarget_link_libraries(app PRIVATE one)\n"
    )
    # It stands for lutgen: what it is asked for is made here, once, and copied.
    made, asked, tool = tmp_path / "made", tmp_path / "asked", tmp_path / "lutgen"
    tool.write_text(f'#!/bin/sh\necho "$@" >> {asked}\nmkdir -p "$4"\ncp {made}/*.[ch] "$4"\n')
    tool.chmod(0o755)
    exporter.export(recipe, made, name="one", points=2000)
    headers = []
    for edit in ("", "", "\n# edited\n"):
        if edit:
            recipe.write_text(recipe.read_text() + edit)
        run(tmp_path, "cmake", "-S", ".", "-B", "b", f"-DLUTGEN={tool}")
        run(tmp_path, "cmake", "--build", "b")
        run(tmp_path, "b/app")
        headers.append((tmp_path / "b" / "one" / "one.h").stat().st_mtime_ns)
    assert headers[0] == headers[1] < headers[2]
    first, second = asked.read_text().splitlines()
    assert first == second
    monkeypatch.setattr(exporter, "export", partial(exporter.export, points=2000))
    stdout(*first.split())


def test_the_citation_has_what_its_format_asks_for_and_the_version_of_the_package():
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    keys = dict(re.findall(r"^([a-z-]+):[ ]*(.*)$", citation, re.MULTILINE))
    assert {"cff-version", "message", "title", "authors"} <= set(keys)
    assert keys["cff-version"] == "1.2.0"
    assert keys["version"] == lutgen.__version__
    assert f'license = "{keys["license"]}"' in (ROOT / "pyproject.toml").read_text()
    assert "- name: The lutgen developers" in citation
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    newest = re.search(r"^## (.*\d)$", changes, re.MULTILINE)  # not one that is unreleased
    assert newest[1] == f"{lutgen.__version__}, {keys['date-released']}"


def test_the_page_has_every_table_of_a_recipe_once_as_the_script_writes_it():
    marked = re.findall(r"^<!-- keys of (\S+) -->$", RECIPES, re.MULTILINE)
    # The row of `drive` says which keys its joints may have.
    assert sorted([*marked, "Step"]) == sorted(TABLES)
    assert rewritten(RECIPES) == RECIPES
    changed = RECIPES.replace("| `80.0` |", "| `90.0` |")
    assert changed != RECIPES
    assert rewritten(changed) == RECIPES


@pytest.mark.parametrize("name", ["rest_width", "contact_tolerance"])
def test_the_defaults_that_are_shares_of_the_size_are_those_that_a_recipe_gets(name):
    said = SCHEMA["$defs"]["Robot"]["properties"][name]["description"]
    share, percent = re.search(r"by default (\S+) (%?) ?of the size", said).groups()
    recipe = lutgen.parse_recipe(rocker())
    size = robot_size_of(recipe)
    # The far side of the front and rear wheels: sqrt(0.5^2 + 0.3^2 + 0.3^2) + 0.1.
    assert size == pytest.approx(0.43**0.5 + 0.1)
    wanted = float(share) / (100 if percent else 1) * size
    assert getattr(acceptance_of(recipe), name) == pytest.approx(wanted)


# `search/driving` is a source, too.
ENDS = ("", ".py")
NAME = re.compile(r"(?<![\w/.-])((?:lutgen|firmware_export)(?:\.[a-zA-Z_]\w*)+)")
# A name that ends like this is that of a file.
FILES = {"c", "csv", "gif", "h", "h5", "json", "md", "png", "svg", "toml", "urdf"}


def prose(page):
    return re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)


def test_links_lead_to_files_and_every_page_can_be_reached_from_the_readme():
    seen, waiting, missing = set(), [ROOT / "README.md"], []
    while waiting:
        page = waiting.pop()
        seen.add(page)
        for target in re.findall(r"\]\(([^)#\s]+)", re.sub(r"`[^`\n]*`", "", prose(page))):
            end = (page.parent / target).resolve()
            if "://" not in target and not end.exists():
                missing.append(f"{page.name}: {target}")
            elif end.suffix == ".md" and end not in seen:
                waiting.append(end)
    assert missing == []
    assert set(DOCUMENTS) - seen == set()


def test_every_source_that_a_document_names_with_its_folder_is_there():
    missing = []
    for page in DOCUMENTS:
        for name in re.findall(r"`((?:[a-z_]+/)+[a-z_]*(?:\.(?:py|[ch]))?)`", prose(page)):
            # In full, or from a package on, as in `search/driving`.
            folders = [ROOT / folder for folder in ("", "lutgen", "firmware_export")]
            known = any((folder / name.split("/")[0]).is_dir() for folder in folders)
            there = any((folder / f"{name}{end}").exists() for folder in folders for end in ENDS)
            if known and not there and not name.startswith("build/"):
                missing.append(f"{page.name}: {name}")
    assert missing == []


@pytest.mark.parametrize("pages", [DOCUMENTS, SOURCES], ids=["documents", "sources"])
def test_every_dotted_name_and_every_file_of_the_runtime_is_there(pages):
    gone, runtime = [], ROOT / "firmware_export" / "runtime"
    # The changelog says what names were before.
    for page in (page for page in pages if page.name != "CHANGELOG.md"):
        text = page.read_text(encoding="utf-8")
        parts = re.findall(r"\bruntime/(\w+\.[ch])\b", text)
        gone += [f"{page.name}: {part}" for part in parts if not (runtime / part).exists()]
        for name in NAME.findall(text):
            if name.rpartition(".")[2] not in FILES:
                try:
                    pkgutil.resolve_name(name)
                except (ImportError, AttributeError):
                    gone.append(f"{page.name}: {name}")
    assert gone == []


COMMANDS = (ROOT / "docs/guide/commands.md").read_text(encoding="utf-8")
# Shells of the table, and the line that it gives each.
LINES = dict(re.findall(r"^\| (\w+)[^|]* \| `~[^`]+` \| `(.+)` \|$", COMMANDS, re.MULTILINE))


def test_the_table_of_verdicts_names_the_commands_that_have_one():
    listed = re.findall(r"^\| `(\w+)` \|", COMMANDS, re.MULTILINE)
    assert listed == sorted(VERDICTS)
    # What the help of a command says of its own exit code.
    says = {name for name, one in main.commands.items() if "code 3" in " ".join(one.help.split())}
    assert says == set(listed)


def completions(words, incomplete):
    """Return what lutgen answers the function of bash, which asks through the environment."""
    asked = {
        "_LUTGEN_COMPLETE": "bash_complete",
        "COMP_WORDS": f"{words} {incomplete}",
        "COMP_CWORD": str(len(words.split())),
    }
    lines = CliRunner().invoke(main, [], prog_name="lutgen", env=asked).stdout.splitlines()
    return [line.split(",", 1)[1] for line in lines]


def test_commands_options_kinds_and_recipes_are_completed():
    assert completions("lutgen", "lim") == ["limits"]
    assert completions("lutgen plot map.h5 --kind", "s") == ["surface", "sphere"]
    assert completions("lutgen recipes", "ab") == ["absolem"]
    assert "--json" in completions("lutgen sweep", "--")
    assert {f"_LUTGEN_COMPLETE={shell}_source" in line for shell, line in LINES.items()} == {True}
    assert len(LINES) == 3

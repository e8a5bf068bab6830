"""The guides of commands: every command runs, and prints what its page shows."""

import contextlib
import io
import re
import shlex
import shutil
from pathlib import Path

import pytest

from tests.fixtures.commands import run, stdout
from tests.fixtures.documents import blocks
from tests.fixtures.places import MAPS, VECTORS

# The language of the files that a page shows, their names, and the exit code of each command.
PAGES: dict[str, tuple[str, tuple[str, ...], tuple[int, ...]]] = {
    "limits": ("toml", (), (0, 0)),
    "load": ("toml", ("tractor.toml",), (0, 0)),
    "path": ("csv", ("hill.csv",), (3, 3, 0)),
    "stance": ("toml", ("stair.toml", "ditch.toml"), (0, 3, 0)),
    "urdf": ("toml", ("named.toml",), (0, 0, 0, 0)),
    "wheels": ("toml", ("buggy.toml",), (0, 1)),
}
# What they write beside that.
WRITTEN = {
    "limits": ("limits.png", "feet.png"),
    "path": ("drive.csv", "drive.png", "hill.gif"),
    "stance": ("stair.png",),
}


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder with the gallery and robot descriptions, made the working folder."""
    (tmp_path / "maps").symlink_to(MAPS)
    for name in ("quadruped.urdf", "quadruped.srdf"):
        shutil.copy(VECTORS / name, tmp_path)
    shutil.copy(VECTORS / "rover.urdf", tmp_path / "robot.urdf")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", PAGES)
def test_everything_on_the_page_runs_and_prints_what_it_shows(name: str) -> None:
    page = f"docs/guide/{name}.md"
    language, files, codes = PAGES[name]
    for file, text in zip(files, blocks(page, language), strict=True):
        Path(file).write_text(text, encoding="utf-8")
    commands, shown = blocks(page, "sh"), blocks(page, "text")
    assert len(commands) == len(shown) > 0
    for command, text, code in zip(commands, shown, codes, strict=True):
        program, *arguments = shlex.split(command.replace("\\\n", " "))
        assert program == "lutgen"
        result = run(*arguments)
        assert (result.stdout, result.exit_code) == (text, code)
    for file in WRITTEN.get(name, ()):
        assert Path(file).stat().st_size > 0


@pytest.mark.parametrize("name", ["limits", "path", "search", "stance", "wheels"])
def test_the_python_of_the_page_prints_what_its_comments_say(name: str) -> None:
    page = f"docs/guide/{name}.md"
    language, files, _ = PAGES.get(name, ("toml", (), ()))
    for file, text in zip(files, blocks(page, language), strict=True):
        Path(file).write_text(text, encoding="utf-8")
    (code,) = blocks(page, "python")
    said = re.findall(r"^print\(.*\)  # (.*)$", code, re.MULTILINE)
    assert len(said) == code.count("print(") > 0
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(code, page, "exec"), {})
    assert printed.getvalue().splitlines() == said


def test_the_commands_of_the_guide_to_searches_run() -> None:
    (shell,) = blocks("docs/guide/search.md", "sh")
    for line in shell.splitlines():
        program, *arguments = shlex.split(line)
        assert program == "lutgen"
        assert run(*arguments).exit_code == 0, line


def timeless(text: str) -> str:
    """Return what a command prints without the time that computing takes here."""
    return re.sub(r"about [\d.]+ s", "about - s", text)


def test_everything_in_the_guide_to_recipes_runs_and_prints_what_it_shows() -> None:
    page, robot = "docs/guide/recipe.md", Path("robot.toml")
    shown = iter(blocks(page, "text"))
    (edits,) = blocks(page, "diff")
    changes = re.findall(r"^-(.*)\n\+(.*)$", edits, re.MULTILINE)
    for block in blocks(page, "sh"):
        for line in block.splitlines():
            command, _, target = line.partition(" > ")
            program, *arguments = command.split()
            assert program == "lutgen"
            if arguments[0] == "eval":
                # Edited once, as the page says.
                while changes:
                    old, new = changes.pop()
                    text = robot.read_text(encoding="utf-8")
                    assert text.count(old) == 1, old
                    robot.write_text(text.replace(old, new))
            printed = stdout(*arguments)
            if target:
                Path(target).write_text(printed)
            else:
                assert timeless(printed) == timeless(next(shown)), line
    assert next(shown, None) is None
    # The file that editors are pointed to is the one that was written.
    (first,) = blocks(page, "toml")
    assert Path(first.removeprefix("#:schema ").strip()).is_file()

"""The tutorial, from its first page to its last in one folder: its commands, its C, its answers."""

import fnmatch
import subprocess
from functools import partial
from pathlib import Path

import pytest
from click.testing import CliRunner

from firmware_export import control, exporter
from firmware_export.control import objective
from lutgen.cli import main
from tests.fixtures.documents import blocks, mixed

PAGES = ("docs/tutorial/1-map.md", "docs/tutorial/2-board.md", "docs/tutorial/3-control.md")


def printed(line: str) -> str:
    """Run a line of a page and return what it printed."""
    program, *arguments = line.split()
    if program == "lutgen":
        result = CliRunner().invoke(main, arguments)
        assert result.exit_code == 0, f"{line}: {result.output}"
        return result.stdout
    done = subprocess.run(line, shell=True, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{line}: {done.stderr}"
    return done.stdout


def missing(shown: str, said: str) -> list[str]:
    """Return the lines of a page that were not printed, in the order in which it shows them.

    ``...`` stands for any lines, and * within a line for any text.
    """
    lines, wrong = iter(said.splitlines()), []
    for line in shown.splitlines():
        if line != "..." and not any(fnmatch.fnmatchcase(one, line) for one in lines):
            wrong.append(line)
    return wrong


def test_the_tutorial_runs_from_nothing_to_control_and_prints_what_it_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    # What is certified on half a million points, and chosen of 600 postures, is seen on fewer.
    monkeypatch.setattr(exporter, "export", partial(exporter.export, points=20_000))
    monkeypatch.setattr(control, "policy", partial(control.policy, points=20_000))
    monkeypatch.setattr(objective, "POSTURES", 40)
    for page in PAGES:
        said, shown = "", 0
        for language, text in mixed(page):
            if language == "sh":
                said = "".join(map(printed, text.splitlines()))
            elif language == "text":
                assert missing(text, said) == [], page
                shown += 1
        assert shown >= 2
    for page, folder in zip(PAGES[1:], ("rover_firmware", "rover_control"), strict=True):
        Path("use.c").write_text(*blocks(page, "c"))
        printed(f"cc -std=c99 -Wall -Wextra -Werror -I{folder} -fPIC -c use.c")
        printed(f"cc -std=c99 -I{folder} {folder}/rover.c use.o -shared -fPIC -o use.so")


def test_a_line_that_was_not_printed_is_found() -> None:
    said = "one 1.25 m\ntwo\nthree\n"
    assert missing("...\nthree\n", said) == []
    assert missing("one 1.2* m\n...\nthree\n", said) == []
    assert missing("three\ntwo\n", said) == ["two"]
    assert missing("one 1.3 m\n", said) == ["one 1.3 m"]

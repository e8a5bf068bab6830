"""Pages with commands: in the order of a page all of them run, and print what it shows."""

import contextlib
import fnmatch
import io
import json
import re
import shlex
import shutil
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import pytest

from firmware_export import control, exporter
from firmware_export.control import maker
from tests.fixtures.commands import run
from tests.fixtures.fits import untried
from tests.fixtures.places import MAPS, ROOT, VECTORS, blocks, mixed

# The program `lutgen` of this environment and these sources, for lines that need a shell.
LUTGEN = f'lutgen() {{ "{sys.executable}" -m lutgen "$@"; }}\n'


class Page(NamedTuple):
    """How pages that share a folder are run.

    `files` are the names of their blocks of TOML, CSV and C, and `made` those of what they write;
    `codes` the exit codes of their blocks of commands, 0 unless given.  What they show is all that
    was printed, or, if not `whole`, lines of it in their order: ``...`` stands for any lines, and *
    for any text.
    """

    names: tuple[str, ...]
    files: tuple[str, ...] = ()
    codes: tuple[int, ...] = ()
    made: tuple[str, ...] = ()
    whole: bool = True


PAGES = {
    "README": Page(("README.md",), ("main.c",), made=("absolem.h5", "absolem.png"), whole=False),
    "tutorial": Page(
        tuple(f"docs/tutorial/{name}.md" for name in ("1-map", "2-board", "3-control")),
        ("map.c", "control.c"),
        whole=False,
    ),
}
PAGES |= {
    page.names[0]: page._replace(names=(f"docs/guide/{page.names[0]}.md",))
    for page in (
        Page(("commands",), made=("mine.toml",)),
        Page(("limits",), made=("limits.png", "feet.png"), whole=False),
        Page(("load",), ("tractor.toml",), whole=False),
        Page(("metrics",), ("trolley.toml",), made=("limits.png",), whole=False),
        Page(("path",), ("hill.csv",), (3, 3), ("drive.csv", "drive.png", "hill.gif")),
        Page(("recipe",), ("schema",), made=("recipe.schema.json",), whole=False),
        Page(("search",)),
        Page(("stance",), ("stair.toml", "ditch.toml"), (0, 3), ("stair.png",)),
        Page(("trust",)),
        Page(("urdf",), ("named.toml",), whole=False),
        Page(("weigh",), ("scales.csv",), made=("weighed.toml",), whole=False),
        Page(("wheels",), codes=(0, 0, 1), whole=False),
    )
}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    (tmp_path / "maps").symlink_to(MAPS)
    for name in ("quadruped.urdf", "quadruped.srdf"):
        shutil.copy(VECTORS / name, tmp_path)
    shutil.copy(VECTORS / "rover.urdf", tmp_path / "robot.urdf")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    # What is certified on half a million points, and chosen of 4,200 postures, is seen on fewer.
    monkeypatch.setattr(exporter, "export", partial(exporter.export, points=5_000))
    monkeypatch.setattr(control, "policy", partial(control.policy, points=5_000))
    monkeypatch.setattr(maker, "POSTURES", 40)
    with untried():
        yield tmp_path


def printed(line, code=0):
    """Run a line of a page, in this process if it can be; return what it printed on stdout."""
    command, _, target = line.partition(" > ")
    if command.startswith("lutgen ") and not re.search("[|;&]", line):
        result = run(*shlex.split(command)[1:])
        ended, said, error = result.exit_code, result.stdout, result.stderr
        if target:
            Path(target).write_text(said)
            said = ""
    else:
        done = subprocess.run(["bash", "-uc", LUTGEN + line], capture_output=True, text=True)
        ended, said, error = done.returncode, done.stdout, done.stderr
    assert ended == code, f"{line}: {error}"
    return said


def missing(shown, said):
    """Return the lines of a page that were not printed, in the order in which it shows them."""
    lines, wrong = iter(said.splitlines()), []
    for line in shown.splitlines():
        words = line.replace("[", "[[]")
        if line != "..." and not any(fnmatch.fnmatchcase(one, words) for one in lines):
            wrong.append(line)
    return wrong


def timeless(text):
    """Return what a command prints without the time that computing takes here."""
    return re.sub(r"about [\d.]+ s", "about - s", text)


def edited(edits, path):
    text = path.read_text(encoding="utf-8")
    for old, new in re.findall(r"^-(.*)\n\+(.*)$", edits, re.MULTILINE):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")


@pytest.mark.parametrize("name", PAGES)
def test_everything_on_the_page_runs_and_prints_what_it_shows(name):
    page = PAGES[name]
    files, codes = iter(page.files), [*page.codes, *[0] * 20][::-1]
    said = shown = ""
    for language, text in [block for one in page.names for block in (*mixed(one), ("sh", ""))]:
        if language in ("toml", "csv", "c"):
            Path(next(files)).write_text(text, encoding="utf-8")
        elif language == "diff":
            edited(text, Path("robot.toml"))
        elif language == "text":
            shown += text
        elif language == "sh" and not text.startswith("make "):
            if page.whole:
                assert timeless(shown) in ("", timeless(said)), name
            assert missing(timeless(shown), timeless(said)) == [], name
            *lines, last = text.replace("\\\n", " ").splitlines() or [":"]
            said = "".join(map(printed, lines)) + printed(last, codes.pop() if text else 0)
            shown = ""
    assert next(files, None) is None
    for file in page.made:
        assert Path(file).stat().st_size > 0
    for source, place in (("map", "rover_firmware"), ("control", "rover_control")):
        if name == "tutorial":
            strict = "-std=c99 -Wall -Wextra -Werror -fPIC -shared"
            printed(f"cc {strict} -I{place} {source}.c {place}/rover.c -o {source}.so")


@pytest.mark.parametrize("name", ["limits", "path", "python", "search", "stance", "wheels"])
def test_the_python_of_the_page_prints_what_its_comments_say(name):
    page = f"docs/guide/{name}.md"
    files = PAGES[name].files if name in PAGES else ()
    for file, text in zip(files, blocks(page, "toml") + blocks(page, "csv"), strict=True):
        Path(file).write_text(text, encoding="utf-8")
    for line in "".join(blocks(page, "sh")).splitlines():
        if line.startswith("lutgen new"):
            printed(line)
    (code,) = blocks(page, "python")
    # A colon begins what the number means.
    said = re.findall(r"^print\(.*\)  # (.*?)(?:: .*)?$", code, re.MULTILINE)
    assert len(said) == code.count("print(") > 0
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(code, page, "exec"), {})
    assert out.getvalue().splitlines() == said


@pytest.mark.parametrize("name", ["first_map", "second_look"])
def test_a_notebook_runs_and_is_kept_without_outputs(name):
    cells = json.loads((ROOT / f"docs/notebooks/{name}.ipynb").read_text("utf-8"))["cells"]
    codes = [cell for cell in cells if cell["cell_type"] == "code"]
    assert not any(cell["outputs"] for cell in codes)
    text = "\n".join("".join(cell["source"]) for cell in codes)
    exec(compile(re.sub("^%.*", "", text, flags=re.MULTILINE), name, "exec"), {})
    plt.close("all")

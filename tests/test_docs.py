"""What the README and the documents show is run here, and what they list is compared."""

import contextlib
import io
import re
import shutil
import sys
from pathlib import Path

import h5py
import pytest
from click.testing import CliRunner

import lutgen
from lutgen.cli import main

ROOT = Path(__file__).resolve().parent.parent


def blocks(name: str, language: str) -> list[str]:
    """Return the fenced code of one language in a document."""
    text = (ROOT / name).read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


@pytest.fixture
def clone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a folder with the recipes in it, made the working folder."""
    shutil.copytree(ROOT / "maps", tmp_path / "maps")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_shell_commands_of_the_readme_run_and_write_their_files(clone: Path) -> None:
    (shell,) = blocks("README.md", "sh")
    lines = shell.splitlines()
    # CI runs `make venv` itself before it can run any test.
    assert lines[0] == "make venv"
    for line in lines[1:]:
        program, *arguments = line.split()
        assert program == ".venv/bin/lutgen"
        result = CliRunner().invoke(main, arguments)
        assert result.exit_code == 0, f"{line}: {result.output}"
        if arguments[0] == "eval":
            assert re.search(r"^sdg +0\.00253160\d*$", result.stdout, re.MULTILINE)
    assert h5py.is_hdf5("paper_two.h5")
    assert (clone / "paper_two.png").read_bytes().startswith(b"\x89PNG")


def test_the_python_of_the_readme_prints_what_its_comments_say(clone: Path) -> None:
    (code,) = blocks("README.md", "python")
    said = re.findall(r"^print\(.*\)  # (\[\[.*\]\]|\(.*\))", code, re.MULTILINE)
    assert len(said) == code.count("print(")
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(code, "README.md", "exec"), {})
    assert printed.getvalue().splitlines() == said


def test_the_format_document_lists_every_attribute_of_a_map(clone: Path) -> None:
    text = (ROOT / "docs/format.md").read_text(encoding="utf-8")
    listed = set(re.findall(r"^\| `(\w+)` \|", text, re.MULTILINE))
    lutgen.sweep(lutgen.load_recipe("maps/paper_one.toml"), "one.h5")
    with h5py.File("one.h5") as file:
        assert set(file.attrs) == listed - {"blocks_done"}


def test_every_relative_link_and_picture_of_the_documents_exists() -> None:
    documents = [ROOT / "README.md", ROOT / "maps/README.md", *(ROOT / "docs").glob("*.md")]
    missing = [
        f"{document.name}: {target}"
        for document in documents
        for target in re.findall(r"\]\(([^)#]+)\)", document.read_text(encoding="utf-8"))
        if "://" not in target and not (document.parent / target).exists()
    ]
    assert missing == []


def test_the_readme_names_the_python_that_the_project_requires() -> None:
    assert "Python >= 3.11" in (ROOT / "README.md").read_text(encoding="utf-8")
    assert sys.version_info >= (3, 11)

"""The page on trust: its commands, and what it says that commands replace."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.fixtures.documents import blocks
from tests.fixtures.places import ROOT

PAGE = "docs/guide/trust.md"
# The program `lutgen` of this environment and these sources, wherever they are.
LUTGEN = f'lutgen() {{ "{sys.executable}" -m lutgen "$@"; }}\n'


def test_the_commands_of_the_page_run_and_print_what_it_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    printed = ""
    for block in blocks(PAGE, "sh"):
        done = subprocess.run(
            ["bash", "-euc", LUTGEN + block], capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        printed = done.stdout
    assert [printed] == blocks(PAGE, "text")

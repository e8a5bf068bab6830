"""The page on trust: its commands, and what it says that commands replace."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.fixtures.commands import stdout
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
    for line in "".join(blocks(PAGE, "sh")).splitlines():
        if line.startswith("lutgen") and "||" not in line:
            stdout(*line.split()[1:])
        else:
            done = subprocess.run(
                ["bash", "-euc", LUTGEN + line], capture_output=True, text=True, check=False
            )
            assert done.returncode == 0, done.stderr
    assert [done.stdout] == blocks(PAGE, "text")

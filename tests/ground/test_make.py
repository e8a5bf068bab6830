"""The commands of the Makefile."""

import shlex
import subprocess
import sys

from tests.fixtures.places import ROOT


def test_the_tests_can_be_run_again_beside_the_list_that_the_last_run_left(tmp_path):
    left = tmp_path / "skipped.txt"
    left.write_text("")
    lines = (ROOT / "Makefile").read_text().splitlines()
    command = next(line for line in lines if "--skipped-to" in line)
    assert "build/skipped.txt" in command
    command = command.replace("$(BIN)/python", sys.executable)
    command = command.replace("build/skipped.txt", str(left))
    # A file that is there is taken for one of tests, and the options of tests/conftest.py are lost.
    done = subprocess.run(
        [*shlex.split(command), "--markers"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr

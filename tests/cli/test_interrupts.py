"""Ctrl-C at any moment of a command ends it, soon and without a traceback."""

import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest

from tests.fixtures.length import part
from tests.fixtures.places import MAPS, ROOT

# Python itself has to start before anything of ours can answer.
STARTED = 0.1


def interrupted(after: float, answer: signal.Handlers = signal.SIG_DFL) -> tuple[int, str]:
    """Interrupt `lutgen check` after some seconds; return its status and what it said."""
    command = [sys.executable, "-m", "lutgen", "check", str(MAPS / "absolem.toml")]
    process = subprocess.Popen(
        command,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
        # Whoever runs the tests in the background of a shell ignores Ctrl-C, and so would it.
        preexec_fn=partial(signal.signal, signal.SIGINT, answer),
    )
    time.sleep(after)
    process.send_signal(signal.SIGINT)
    try:
        said = process.communicate(timeout=60.0)[1]
    finally:
        process.kill()
    return process.returncode, said


def test_a_command_that_is_interrupted_ends_without_a_traceback() -> None:
    ends = set()
    for step in range(part(40)):
        status, said = interrupted(STARTED + 1.4 * step / part(40))
        assert "Traceback" not in said, said
        # Killed by the signal, aborted, or done before it came.
        assert status in (-signal.SIGINT, 1, 0), said
        ends.add(status)
    assert ends != {0}


def test_an_interrupted_compiler_is_not_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    begin = time.monotonic()
    status, said = interrupted(4.0)
    assert status in (-signal.SIGINT, 1)
    assert "Traceback" not in said
    # An empty cache takes half a minute and more to fill.
    assert time.monotonic() - begin < 20.0


@pytest.mark.parametrize("after", [0.3, 1.0])
def test_in_the_background_of_a_shell_ctrl_c_is_nobody_s(after: float) -> None:
    status, said = interrupted(after, signal.SIG_IGN)
    assert status == 0, said

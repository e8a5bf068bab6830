"""A fault that nobody foresaw ends in a sentence, and an interruption soon."""

import os
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest
from click.testing import CliRunner

from lutgen.cli import group, main
from lutgen.cli.recipes import check
from lutgen.errors import one_line, readable
from tests.fixtures.commands import run
from tests.fixtures.length import part
from tests.fixtures.places import MAPS, ROOT
from tests.fixtures.recipes import tripod


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "r.toml").write_text(tripod("reach = 2, swing = 2", nodes=3))
    return tmp_path


def failing(monkeypatch, error):

    def fail(*_, **__):
        raise error

    monkeypatch.setattr(check, "callback", fail)


def test_a_fault_of_lutgen_is_a_sentence_and_a_traceback_with_v(monkeypatch):
    failing(monkeypatch, ZeroDivisionError("by\nzero"))
    result = CliRunner().invoke(main, ["check", "r.toml"])
    assert result.exit_code == group.FAILED
    assert result.stderr.count("\n") == 1
    assert f"{group.UNFORESEEN} (got ZeroDivisionError: by zero in test_faults" in result.stderr
    assert "lutgen -v" in result.stderr
    said = subprocess.run(
        [sys.executable, "-c", PROGRAM, "-v"], capture_output=True, text=True, check=False
    )
    assert said.returncode == group.FAILED
    assert "Traceback" in said.stderr
    assert group.UNFORESEEN in said.stderr


# As the command line, with one that fails.
PROGRAM = """
import sys
from lutgen.cli.group import main
@main.command("fail")
def fail(): 1 / 0
main([*sys.argv[1:], "fail"])
"""


def test_too_little_memory_is_a_sentence(monkeypatch):
    failing(monkeypatch, MemoryError("Unable to allocate 80 GiB"))
    result = CliRunner().invoke(main, ["check", "r.toml"])
    assert result.exit_code == group.FAILED
    assert "the memory is not enough (got Unable to allocate 80 GiB)" in result.stderr


def test_a_setting_that_numba_would_trip_over_is_refused(monkeypatch):
    for threads in ("0", "-1", "many", ""):
        monkeypatch.setenv("NUMBA_NUM_THREADS", threads)
        assert "NUMBA_NUM_THREADS: must be a whole number above 0" in run("schema").stderr


@pytest.mark.parametrize("arguments", [["schema"], ["--help"]])
def test_a_full_disk_or_a_reader_that_has_gone_ends_with_a_status(arguments):
    command = [sys.executable, "-m", "lutgen", *arguments]
    with Path("/dev/full").open("w") as full:
        said = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert said.returncode == 1
    assert said.stderr == "Error: the output cannot be written (got No space left on device).\n"
    reader, writer = os.pipe()
    os.close(reader)
    said = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, text=True, check=False)
    os.close(writer)
    assert (said.returncode, said.stderr) == (1, "")


def test_a_message_is_readable_and_a_line_is_one_line():
    plain = "r.toml: robot.größe is unknown (got 3);\n\tdid you mean 'name'"
    assert readable(plain) == plain
    assert one_line(plain) == plain.replace("\n\t", "\\n\\t")
    for received, shown in (("\x1b[31m", "\\x1b[31m"), ("\u202e", "\\u202e"), ("\x9b", "\\x9b")):
        assert readable(f"a{received}b") == one_line(f"a{received}b") == f"a{shown}b"
    # A long one keeps its beginning and its way out.
    shown = readable(f"r.toml: robot.name is wrong (got '{'a' * 10_000}'); write a name")
    assert len(shown) < 2100
    assert shown.startswith("r.toml: robot.name is wrong")
    assert shown.endswith("'); write a name")


def interrupted(after, answer=signal.SIG_DFL):
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


def test_a_command_that_is_interrupted_ends_without_a_traceback():
    # Python itself has to start before anything of ours can answer.
    begin = time.monotonic()
    subprocess.run([sys.executable, "-c", "import lutgen"], check=True, cwd=ROOT)
    started = 1.5 * (time.monotonic() - begin)
    ends = set()
    for step in range(part(40, 13)):
        status, said = interrupted(started + 1.4 * step / part(40, 13))
        if "Fatal Python error: init" in said or "in _get_module_details" in said:
            continue  # The signal came before Python had started.
        assert "Traceback" not in said, said
        # Killed by the signal, aborted, or done before it came.
        assert status in (-signal.SIGINT, 1, 0), said
        ends.add(status)
    assert ends != {0}


def test_an_interrupted_compiler_is_not_waited_for(tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    begin = time.monotonic()
    status, said = interrupted(4.0)
    assert status in (-signal.SIGINT, 1)
    assert "Traceback" not in said
    # An empty cache takes half a minute and more to fill.
    assert time.monotonic() - begin < 20.0


def test_in_the_background_of_a_shell_ctrl_c_is_nobody_s():
    status, said = interrupted(1.0, signal.SIG_IGN)
    assert status == 0, said

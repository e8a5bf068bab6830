"""Compile and run what was written, on this machine, if it has a compiler."""

import os
import shlex
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path

from lutgen.errors import ExportError, reject

# Not optimised, which takes half as long.
FLAGS = ("-std=c99", "-O0", "-ffp-contract=off", "-I.")
PATIENCE = 300.0
EXAMPLES = ("read", "alarm", "control")
# It links if the C library has the name: a map would take the place of what a library calls.
PROBE = "void {0}(void);\nvoid (*volatile f)(void);\nint main(void) {{ f = {0}; return 0; }}\n"


def compiler() -> list[str] | None:
    """Return the words that call the C compiler of this machine, or None."""
    chosen = shlex.split(os.environ.get("CC", ""))
    names = [chosen] if chosen else [["cc"], ["gcc"], ["clang"]]
    return next((words for words in names if shutil.which(words[0])), None)


def try_out(files: Mapping[str, bytes], name: str) -> str:
    """Compile and run the files of an export; return a sentence for people.

    ExportError is raised if it does not compile, its examples do not run, or there is no room.
    """
    words = compiler()
    if words is None:
        return "not compiled: there is no C compiler here"
    with tempfile.TemporaryDirectory(prefix="lutgen-") as place:
        folder = Path(place)
        sources = {file: text for file, text in files.items() if file.endswith((".c", ".h"))}
        try:
            for file, text in (sources | {"_probe.c": PROBE.format(name).encode()}).items():
                (folder / file).parent.mkdir(parents=True, exist_ok=True)
                (folder / file).write_bytes(text)
        except OSError as error:
            got = f"{error.strerror or error} in {folder.parent}"
            way_out = "make room there, or set TMPDIR to a folder that has"
            reject(name, "what was written cannot be tried", got, way_out, ExportError)
        probe = ["-w", "-fno-builtin", "_probe.c", "-lm", "-o", "_probe"]
        if _run([*words, *probe], folder, name).returncode == 0:
            what = "the C library of this machine has a function of this name"
            way_out = f"give another, such as --name {name}_map"
            reject(name, what, repr(name), way_out, ExportError)
        _demand([*words, *FLAGS, "-c", f"{name}.c", "-o", "map.o"], folder, name)
        for example in (one for one in EXAMPLES if f"examples/{one}.c" in files):
            program = str(folder / f"{example}.run")
            _demand([*words, *FLAGS, "map.o", f"examples/{example}.c", "-o", program], folder, name)
            _demand([program], folder, name)
    return f"compiled and run with {' '.join(words)}"


def _demand(arguments: list[str], folder: Path, name: str) -> None:
    """Run a program; refuse the export if it does not end well."""
    done = _run(arguments, folder, name)
    if done.returncode:
        lines = done.stderr.splitlines()
        said = next((line for line in lines if "error" in line), next(iter(lines), "nothing"))
        what, got = "what was written does not compile or run", Path(arguments[0]).name
        way_out = "give another --name, or report this"
        reject(name, what, f"{said.strip()!r} of {got}", way_out, ExportError)


def _run(arguments: list[str], folder: Path, name: str) -> subprocess.CompletedProcess[str]:
    try:
        return subprocess.run(
            arguments, cwd=folder, capture_output=True, text=True, timeout=PATIENCE, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        what, way_out = "what was written cannot be tried", "set CC to a C compiler that works"
        reject(name, what, f"{type(error).__name__} of {arguments[0]}", way_out, ExportError)

"""What was written is compiled and run, where there is a compiler.

Owns the trial: the map with warnings as errors, and both examples, on this machine.
"""

import os
import shlex
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from lutgen.errors import ExportError

# Not optimised: what is asked is whether it compiles and runs, and that takes half as long.  Plain
# for a compiler that knows other warnings than those that the runtime is written for.
PLAIN = ("-std=c99", "-O0", "-ffp-contract=off")
FLAGS = (*PLAIN, "-Wall", "-Wextra", "-Wpedantic", "-Werror")
PATIENCE = 300.0
EXAMPLES = ("read", "alarm", "control")


def compiler() -> list[str] | None:
    """Return the words that call the C compiler of this machine, None where there is none."""
    asked = shlex.split(os.environ.get("CC", ""))
    names = [asked] if asked else [["cc"], ["gcc"], ["clang"]]
    return next((words for words in names if shutil.which(words[0])), None)


def try_out(files: Mapping[str, bytes], name: str) -> str:
    """Compile and run an export; return a sentence for people.

    Parameters
    ----------
    files : mapping
        The files of the folder by name.
    name : str
        Of the export.

    Raises
    ------
    ExportError
        If it does not compile, or its example does not run; where there is no room to try it.
    """
    words = compiler()
    if words is None:
        return "not compiled: there is no C compiler here"
    with tempfile.TemporaryDirectory(prefix="lutgen-") as place:
        folder = Path(place)
        _fill(folder, files, name)
        examples = [one for one in EXAMPLES if f"examples/{one}.c" in files]

        def compiled(source: str) -> str:
            made = str(Path(source).with_suffix(".o"))
            _compiled(words, folder, name, ["-c", source, "-o", made])
            return made

        def tried(example: str) -> None:
            _run([*words, f"{name}.o", f"examples/{example}.o", "-o", example], folder, name)
            _run([str(folder / example)], folder, name)

        if examples:
            sources = [f"{name}.c", *(f"examples/{one}.c" for one in examples)]
            with ThreadPoolExecutor() as pool:
                list(pool.map(compiled, sources))
                list(pool.map(tried, examples))
    return f"compiled and run with {' '.join(words)}"


def _fill(folder: Path, files: Mapping[str, bytes], name: str) -> None:
    """Write the C of an export where it is tried."""
    try:
        for file, content in files.items():
            if file.endswith((".c", ".h")):
                (folder / file).parent.mkdir(parents=True, exist_ok=True)
                (folder / file).write_bytes(content)
    except OSError as error:
        raise ExportError(
            f"{name}: what was written cannot be tried (got {error.strerror or error} in "
            f"{folder.parent}); make room there, or set TMPDIR to a folder that has."
        ) from error


def _compiled(words: list[str], folder: Path, name: str, sources: list[str]) -> None:
    """Compile the map or an example: without warnings, or at least so that it runs."""
    try:
        _run([*words, *FLAGS, "-I.", *sources], folder, name)
    except ExportError:
        _run([*words, *PLAIN, "-I.", *sources], folder, name)


def _run(arguments: list[str], folder: Path, name: str) -> None:
    try:
        done = subprocess.run(
            arguments, cwd=folder, capture_output=True, text=True, timeout=PATIENCE, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise ExportError(
            f"{name}: what was written cannot be tried (got {type(error).__name__} of "
            f"{arguments[0]}); set CC to a C compiler that works."
        ) from error
    if done.returncode:
        lines = done.stderr.splitlines()
        said = next((line for line in lines if "error" in line), next(iter(lines), "nothing"))
        raise ExportError(
            f"{name}: what was written does not compile or run (got {said.strip()!r} of "
            f"{Path(arguments[0]).name}); give another --name, or report this."
        )

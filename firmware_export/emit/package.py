"""Write the folder of an export, compiled and run first, whole or not at all; read its report.

NAME_report.json marks the folder of an export, and lists its files.
"""

import json
import os
import shlex
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NoReturn

from firmware_export.emit.facts import FORMAT, MARKER, report
from firmware_export.emit.names import check_name
from firmware_export.emit.render import texts
from firmware_export.emit.runtime import runtime_file
from firmware_export.protocol import Export, describe, stored
from lutgen import bounds
from lutgen.errors import ExportError, InputError, reject
from lutgen.files import digest as file_digest

SUFFIX = "_report.json"
# The key of the report under which each other file has its SHA-256.
DIGESTS = "sha256"
# What to do about a folder that holds something else.
BESIDE = "name an empty folder, remove it, or pass --force to write beside it"
OVER = "name another folder, or pass --force to write over it"


def load_report(directory: Path) -> dict[str, Any]:
    """Return the report of an export folder; refuse any other folder, and a damaged report."""
    found = sorted(path for path in directory.glob(f"*{SUFFIX}") if path.is_file())
    if len(found) != 1:
        got, way_out = f"{len(found)} files *{SUFFIX}", "name the folder that was given to -o"
        reject(directory, "is no folder of `lutgen export`", got, way_out, InputError)
    path = found[0]
    raw = bounds.read(str(path), bounds.REPORT_BYTES, InputError)
    try:
        content: dict[str, Any] = json.loads(raw.decode("utf-8"))
        version = content[MARKER]
        known = {"name", "robot", "length_unit", "arithmetic", "channels", "files"} <= set(content)
        names = {str(parameter["name"]) for parameter in content["parameters"]}
        if version == FORMAT and not (known and len(names) == len(content["parameters"])):
            raise ValueError("keys are missing")
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        got = f"{type(error).__name__}: {error}"
        reject(path, "the report is damaged", got, "export again", InputError)
    if version != FORMAT:
        got = f"{version!r}, this lutgen knows {FORMAT}"
        reject(path, "is of another format", got, "export again", InputError)
    return content


def contents(export: Export) -> tuple[dict[str, bytes], dict[str, Any]]:
    """Return the files of an export folder by name, and the content of its report.

    The report also holds the tables, so that they can be read, and the digest of each file.
    """
    name = check_name(export.name)
    content = report(export)
    written = dict(texts(export, content))
    for own in ("smap.h", "LICENSE", *(["smap_control.h"] if export.policy else [])):
        written[own] = runtime_file(own)
    files = {key: text.encode("utf-8") for key, text in written.items()}
    last = f"{name}{SUFFIX}"
    digests = {key: file_digest(files[key]) for key in sorted(files)}
    content |= {
        "files": [*files, last],
        "tables": {"source_sha256": digests[f"{name}.c"], **stored(describe(export))},
        DIGESTS: digests,
    }
    text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    return files | {last: text.encode("utf-8")}, content


def _listed(directory: Path) -> tuple[dict[str, str | None], list[str]]:
    """Return what earlier exports left in a folder, of any format, and their robots.

    That is the names of their files, with the digest of each if it is known.
    """
    names: dict[str, str | None] = {}
    robots = []
    for path in sorted(directory.glob(f"*{SUFFIX}")):
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError, RecursionError):
            continue
        if isinstance(content, dict) and MARKER in content:
            files, known = content.get("files"), content.get(DIGESTS)
            for name in files if isinstance(files, list) else ():
                names[str(name)] = known.get(str(name)) if isinstance(known, dict) else None
            names[path.name] = None
            robots += [content["robot"]] if "robot" in content else []
    return names, robots


def _held(directory: Path) -> list[str]:
    """Return the files in a folder and below, links, and folders without any, by their names."""
    return sorted(
        path.relative_to(directory).as_posix()
        for path in directory.rglob("*")
        if path.is_symlink() or not path.is_dir() or not any(path.iterdir())
    )


def check_directory(
    directory: str | os.PathLike[str], force: bool = False, robot: str | None = None
) -> Path:
    """Return the folder that an export may be written to; refuse a file or foreign content.

    A folder that does not exist, is empty or holds an earlier export and nothing else will do.
    With `force` a folder may hold other files, which stay unless a new one has their name, and an
    export that was edited or is of another than the named robot.  A link is never followed.
    """
    path = Path(directory)
    try:
        if path.is_symlink():
            way_out = "name the folder that it leads to"
            reject(path, "is a link", f"one to {path.readlink()}", way_out, InputError)
        if not path.exists():
            above = path.absolute().parent
            if not above.is_dir():
                what = "its folder does not exist"
                reject(path, what, repr(above.name), "make it first", InputError)
            return path
        if not path.is_dir():
            reject(path, "is no folder", "a file", "name a folder for the export", InputError)
        listed, robots = _listed(path)
        for name in _held(path):
            if (path / name).is_symlink():
                what = "holds a link, which is not of an export"
                reject(path, what, repr(name), "remove it", InputError)
            if not force and name not in listed:
                what = "holds a file that is not of an export"
                reject(path, what, repr(name), BESIDE, InputError)
            known = listed.get(name)
            if not force and known and file_digest((path / name).read_bytes()) != known:
                what = "holds a file that was edited since it was exported"
                reject(path, what, repr(name), OVER, InputError)
    except OSError as error:
        _refuse_to_write(path, error)
    for other in robots:
        if robot not in (None, other) and not force:
            reject(path, f"holds an export of the robot {other!r}", repr(robot), OVER, InputError)
    return path


def write(
    export: Export,
    directory: str | os.PathLike[str],
    progress: Callable[[str], None] | None = None,
    force: bool = False,
) -> dict[str, Any]:
    """Write an export folder, after an earlier one there; return the content of NAME_report.json.

    With `progress` what is written is first compiled and run, and `progress` gets what came of it.
    Refused are folders as by `check_directory`, those of another robot's export unless `force`,
    and, with an ExportError, what does not compile or run, or cannot be written.
    """
    path = check_directory(directory, force, export.recipe.name)
    files, content = contents(export)
    if progress is not None:
        progress(try_out(files, export.name))
    try:
        # It is gone afterwards, unless it was renamed.
        place = path if path.is_dir() else path.absolute().parent
        made = tempfile.TemporaryDirectory(
            prefix=".lutgen-export-", dir=place, ignore_cleanup_errors=True
        )
        with made as unfinished:
            stage = Path(unfinished)
            for name, data in files.items():
                (stage / name).parent.mkdir(parents=True, exist_ok=True)
                (stage / name).write_bytes(data)
            if path.is_dir():
                _replace(path, stage, files)
            else:
                shutil.copymode(stage / "examples", stage)
                stage.rename(path)
    except OSError as error:
        _refuse_to_write(path, error)
    return content


def _refuse_to_write(path: Path, error: OSError) -> NoReturn:
    what, way_out = "the export cannot be written", "make room, or name a folder that is writable"
    reject(path, what, error.strerror or error, way_out, ExportError)


def _replace(path: Path, stage: Path, files: dict[str, bytes]) -> None:
    """Move all files of a stage into a folder that exists, and remove what an export left there."""
    old = set(_listed(path)[0]) & set(_held(path)) - set(files)
    # The report first: it names the others, so that the folder is known as an export's.
    for name in sorted(files, key=lambda name: not name.endswith(SUFFIX)):
        (path / name).parent.mkdir(parents=True, exist_ok=True)
        (stage / name).replace(path / name)
    for name in old:
        (path / name).unlink()
        for parent in (path / name).parents:
            if parent == path or any(parent.iterdir()):
                break
            parent.rmdir()


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

"""Write the folder of an export, whole or not at all, and read its report back.

NAME_report.json marks the folder of an export, and lists its files.
"""

import json
import os
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from firmware_export.emit.facts import FORMAT, MARKER, report
from firmware_export.emit.names import check_name
from firmware_export.emit.render import texts
from firmware_export.emit.runtime import runtime_file
from firmware_export.emit.trial import try_out
from firmware_export.protocol import Export, describe, stored
from lutgen import bounds
from lutgen.errors import ExportError, InputError
from lutgen.files import digest as file_digest

SUFFIX = "_report.json"
# The key of the report under which each other file has its SHA-256.
DIGESTS = "sha256"


def load_report(directory: Path) -> dict[str, Any]:
    """Return the report of an export folder; refuse any other folder, and a damaged report."""
    found = sorted(path for path in directory.glob(f"*{SUFFIX}") if path.is_file())
    if len(found) != 1:
        raise InputError(
            f"{directory}: is no folder of `lutgen export` (got {len(found)} files "
            f"*{SUFFIX}); name the folder that was given to -o."
        )
    path = found[0]
    try:
        with path.open("rb") as file:
            raw = file.read(bounds.REPORT_BYTES.most + 1)
        bounds.check(len(raw), bounds.REPORT_BYTES, str(path), "export again")
        content: dict[str, Any] = json.loads(raw.decode("utf-8"))
        version = content[MARKER]
        known = {"name", "robot", "length_unit", "arithmetic", "channels", "files"} <= set(content)
        names = {str(parameter["name"]) for parameter in content["parameters"]}
        if version == FORMAT and not (known and len(names) == len(content["parameters"])):
            raise ValueError("keys are missing")
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"{path}: the report is damaged (got {type(error).__name__}: {error}); export again."
        ) from error
    if version != FORMAT:
        raise InputError(
            f"{path}: is of another format (got {version!r}, this lutgen knows {FORMAT}); "
            "export again."
        )
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
            raise InputError(
                f"{path}: is a link (got one to {path.readlink()}); name the folder that it "
                "leads to."
            )
        if not path.exists():
            if not path.absolute().parent.is_dir():
                raise InputError(
                    f"{path}: its folder does not exist (got {path.absolute().parent.name!r}); "
                    "make it first."
                )
            return path
        if not path.is_dir():
            raise InputError(f"{path}: is no folder (got a file); name a folder for the export.")
        listed, robots = _listed(path)
        for name in _held(path):
            if (path / name).is_symlink():
                raise InputError(
                    f"{path}: holds a link, which is not of an export (got {name!r}); remove it."
                )
            if not force and name not in listed:
                raise InputError(
                    f"{path}: holds a file that is not of an export (got {name!r}); "
                    "name an empty folder, remove it, or pass --force to write beside it."
                )
            known = listed.get(name)
            if not force and known and file_digest((path / name).read_bytes()) != known:
                raise InputError(
                    f"{path}: holds a file that was edited since it was exported (got {name!r}); "
                    "name another folder, or pass --force to write over it."
                )
    except OSError as error:
        raise _unwritable(path, error) from error
    for other in robots:
        if robot not in (None, other) and not force:
            raise InputError(
                f"{path}: holds an export of the robot {other!r} (got {robot!r}); "
                "name another folder, or pass --force to write over it."
            )
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
        raise _unwritable(path, error) from error
    return content


def _unwritable(path: Path, error: OSError) -> ExportError:
    return ExportError(
        f"{path}: the export cannot be written (got {error.strerror or error}); "
        "make room, or name a folder that is writable."
    )


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

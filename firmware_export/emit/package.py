"""The export folder: all its files, written whole or not at all.

Owns what a folder holds and when it may be replaced; the contents come from the emitters.
"""

import json
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from firmware_export.emit import report as reports
from firmware_export.emit.facts import MARKER, report
from firmware_export.emit.names import check_name
from firmware_export.emit.render import texts
from firmware_export.emit.runtime import runtime_file
from firmware_export.emit.trial import try_out
from firmware_export.protocol import Export, describe, stored
from lutgen.errors import ExportError, InputError
from lutgen.files import digest as file_digest

# The key of the report under which each other file has its SHA-256.
DIGESTS = "sha256"
# Names of our own unfinished work, which a power cut may leave behind.
_STAGE = ".lutgen-export-"


def contents(export: Export) -> tuple[dict[str, bytes], dict[str, Any]]:
    """Return the files of an export folder by name, and the content of its report.

    The report also holds the tables, so that they can be asked, and the digest of NAME.c.
    """
    name = check_name(export.name)
    content = report(export)
    written = {**dict(texts(export, content)), "smap.h": runtime_file("smap.h")}
    written["LICENSE"] = runtime_file("LICENSE")
    if export.policy is not None:
        written["smap_control.h"] = runtime_file("smap_control.h")
    files = {key: text.encode("utf-8") for key, text in written.items()}
    last = f"{name}{reports.SUFFIX}"
    content["files"] = [*files, last]
    digest = file_digest(files[f"{name}.c"])
    content["tables"] = {"source_sha256": digest, **stored(describe(export))}
    content[DIGESTS] = {key: file_digest(files[key]) for key in sorted(files)}
    files[last] = reports.json_text(content).encode("utf-8")
    return files, content


def _reports(directory: Path) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the name and the content of each report in a folder, of any format; {} if damaged."""
    for path in reports.find(directory):
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
            yield path.name, content if isinstance(content, dict) and MARKER in content else {}
        except (OSError, ValueError, RecursionError):
            continue


def _ours(directory: Path) -> dict[str, str | None]:
    """Return the names that an earlier export into a folder left there.

    With them stands the digest of each, None where the report does not know it.
    """
    names: dict[str, str | None] = {}
    for report_name, content in _reports(directory):
        files, known = content.get("files"), content.get(DIGESTS)
        for name in files if isinstance(files, list) else ():
            names[str(name)] = known.get(str(name)) if isinstance(known, dict) else None
        names[report_name] = None
    return names


def _staged(name: str) -> bool:
    """Return whether a name is that of our own unfinished work."""
    return name.startswith(_STAGE)


def _held(directory: Path) -> list[str]:
    """Return the files in a folder and below, links, and folders without any, by their names."""
    found = []
    for root, folders, names in os.walk(directory):
        place = Path(root).relative_to(directory)
        links = [name for name in folders if (Path(root) / name).is_symlink()]
        found += [(place / name).as_posix() for name in [*names, *links]]
        if not folders and not names and place != Path():
            found.append(place.as_posix())
    return sorted(found)


def check_directory(directory: str | os.PathLike[str], force: bool = False) -> Path:
    """Return the folder that an export may be written to; refuse a file or foreign content.

    A folder that does not exist, is empty or holds an earlier export and nothing else will do.
    With `force` so does one that holds other files, which stay unless they have the name of a new
    one, and an export that was edited.  A link is never followed.
    """
    path = Path(directory)
    try:
        if not path.exists() and not path.is_symlink():
            if not path.absolute().parent.is_dir():
                raise InputError(
                    f"{path}: its folder does not exist (got {path.absolute().parent.name!r}); "
                    "make it first."
                )
            return path
        if path.is_symlink():
            raise InputError(
                f"{path}: is a link (got one to {path.readlink()}); name the folder that it "
                "leads to."
            )
        if not path.is_dir():
            raise InputError(f"{path}: is no folder (got a file); name a folder for the export.")
        held = _held(path)
        ours = _ours(path)
        # Work that a power cut stopped half-way has files of two exports.
        whole = not any(_staged(name) for name in held)
        for name in held:
            if (path / name).is_symlink():
                raise InputError(
                    f"{path}: holds a link, which is not of an export (got {name!r}); remove it."
                )
            if force or _staged(name):
                continue
            if name not in ours:
                raise InputError(
                    f"{path}: holds a file that is not of an export (got {name!r}); "
                    "name an empty folder, remove it, or pass --force to write beside it."
                )
            known = ours[name]
            if whole and known is not None and file_digest((path / name).read_bytes()) != known:
                raise InputError(
                    f"{path}: holds a file that was edited since it was exported (got {name!r}); "
                    "name another folder, or pass --force to write over it."
                )
    except OSError as error:
        raise _unwritable(path, error) from error
    return path


def write(
    export: Export,
    directory: str | os.PathLike[str],
    tell: Callable[[str], None] | None = None,
    force: bool = False,
) -> dict[str, Any]:
    """Write an export folder; an earlier export there is replaced.

    Parameters
    ----------
    export : Export
        What to write.
    directory : path
        See `check_directory`.
    tell : callable, optional
        What is written is first compiled and run, and this is called with what came of it.
    force : bool
        Whether files that lutgen did not make, or that were edited, may be replaced.

    Returns
    -------
    dict
        The content of NAME_report.json.

    Raises
    ------
    InputError
        For a folder that `check_directory` refuses, or that holds another robot's export.
    ExportError
        If it does not compile or run, or cannot be written.
    """
    path = check_directory(directory, force)
    if not force:
        _refuse_another_robot(path, export.recipe.name)
    files, content = contents(export)
    if tell is not None:
        tell(try_out(files, export.name))
    try:
        if path.is_dir():
            _replace(path, files, f"{export.name}{reports.SUFFIX}")
        else:
            with _stage(path.absolute().parent) as stage:
                _fill(stage, files)
                stage.chmod(0o777 & ~_umask())
                stage.rename(path)
    except OSError as error:
        raise _unwritable(path, error) from error
    return content


def _refuse_another_robot(path: Path, robot: str) -> None:
    """Refuse to replace the export of a robot by that of another."""
    for _, content in _reports(path):
        found = content.get("robot", robot)
        if found != robot:
            raise InputError(
                f"{path}: holds an export of the robot {found!r} (got {robot!r}); name another "
                "folder, or pass --force to write over it."
            )


def _unwritable(path: Path, error: OSError) -> ExportError:
    return ExportError(
        f"{path}: the export cannot be written (got {error.strerror or error}); "
        "make room, or name a folder that is writable."
    )


def _umask() -> int:
    """Return the process's file mode mask, which can only be read by setting it."""
    mask = os.umask(0)
    os.umask(mask)
    return mask


@contextmanager
def _stage(parent: Path) -> Iterator[Path]:
    """Make a folder for unfinished files, which is gone afterwards unless it was renamed."""
    stage = Path(tempfile.mkdtemp(prefix=_STAGE, dir=parent))
    try:
        yield stage
    finally:
        shutil.rmtree(stage, ignore_errors=True)


def _fill(stage: Path, files: dict[str, bytes]) -> None:
    for name, content in files.items():
        (stage / name).parent.mkdir(parents=True, exist_ok=True)
        (stage / name).write_bytes(content)


def _replace(path: Path, files: dict[str, bytes], first: str) -> None:
    """Move all files into a folder that exists, once they are all on its disk."""
    ours = _ours(path)
    old = {name for name in _held(path) if name not in files and (name in ours or _staged(name))}
    with _stage(path) as stage:
        _fill(stage, files)
        # The report first: it names the others, so that even a power cut between two moves leaves
        # a folder that is known as an export's.
        for name in sorted(files, key=lambda name: name != first):
            (path / name).parent.mkdir(parents=True, exist_ok=True)
            (stage / name).replace(path / name)
    # Their own report last, for the same reason.
    for name in sorted(old, key=lambda name: name.endswith(reports.SUFFIX)):
        if _staged(name):
            shutil.rmtree(path / name.split("/")[0], ignore_errors=True)
        elif (path / name).is_dir():
            (path / name).rmdir()
        else:
            (path / name).unlink(missing_ok=True)
            parent = (path / name).parent
            while parent != path and not any(parent.iterdir()):
                parent.rmdir()
                parent = parent.parent

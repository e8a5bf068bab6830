"""Write files that are either whole or not there, and replace only what lutgen has made.

A file is written under a temporary name and renamed.  A full disk and a bad path are one sentence.
"""

import csv
import hashlib
import io
import math
import os
import secrets
import stat
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from lutgen.errors import InputError

__all__ = [
    "check_kind",
    "check_target",
    "csv_text",
    "digest",
    "is_ours",
    "plain",
    "write_bytes",
    "write_text",
]

# How the kinds of files begin that can say who made them, and what lutgen's say.  Texts have no
# place for a mark that no reader stumbles over, and recipes are for hands: both have none.
_MARKS: tuple[tuple[int, bytes, tuple[bytes, ...]], ...] = (
    (0, b"\x89PNG\r\n\x1a\n", (b"tEXtSoftware\0lutgen",)),
    (0, b"%PDF-", (b"/Creator (lutgen)",)),
    (0, b"<?xml", (b"<dc:title>lutgen</dc:title>",)),
    (0, b"<!DOCTYPE html>", (b'<meta name="generator" content="lutgen">',)),
    (0, b"GIF8", (b"\x21\xfe\x06lutgen\0",)),
    (4, b"ftyp", (b"\0lutgen",)),
    (0, b"\x89HDF\r\n\x1a\n", (b"lutgen-digest-", b"lutgen_format")),
)
# They stand within so many bytes of either end.
_NEAR = 1 << 16
# No link is followed.  Windows knows links by other means, and has a flag for bytes instead.
_FLAGS = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)


def is_ours(path: str | os.PathLike[str]) -> bool:
    """Return whether a file carries the mark of those that lutgen makes; OSError may be raised."""
    handle = os.open(path, os.O_RDONLY | _FLAGS | getattr(os, "O_NONBLOCK", 0))
    with os.fdopen(handle, "rb") as file:
        if not stat.S_ISREG(os.fstat(handle).st_mode):
            return False
        ends = file.read(_NEAR)
        file.seek(max(file.tell(), file.seek(0, io.SEEK_END) - _NEAR))
        ends += file.read()
    return any(
        ends.startswith(kind, at) and any(mark in ends for mark in marks)
        for at, kind, marks in _MARKS
    )


def check_kind(path: str | os.PathLike[str]) -> None:
    """Refuse, with an InputError, to write to a link, a device or a pipe; nothing else is said."""
    try:
        kind = os.lstat(path).st_mode
        leads = Path(path).readlink() if stat.S_ISLNK(kind) else None
    except OSError:
        return
    if leads is not None:
        raise InputError(
            f"{path}: is a link (got one to {leads}); name the file that it leads to, or remove it."
        )
    if not (stat.S_ISREG(kind) or stat.S_ISDIR(kind)):
        raise InputError(f"{path}: is no file (got a device, pipe or socket); name a file.")


def check_target(
    path: str | os.PathLike[str],
    force: bool = False,
    content: bytes | None = None,
    way_out: str = "choose another name, or pass --force to replace it",
) -> None:
    """Refuse to write where something stands that lutgen did not make.

    Parameters
    ----------
    path : path
        Where a file is to be written.
    force : bool
        Whether a file of somebody else may be replaced.
    content : bytes, optional
        What is to be written: a file that holds just that may be replaced.
    way_out : str
        How the message ends.

    Raises
    ------
    InputError
        For a file without lutgen's mark, unless `force`; for a link or a device always.  A folder
        is left to whoever writes.
    """
    check_kind(path)
    try:
        found = os.lstat(path)
        if force or stat.S_ISDIR(found.st_mode) or is_ours(path):
            return
        if content is not None and found.st_size == len(content):
            handle = os.open(path, os.O_RDONLY | _FLAGS)
            with os.fdopen(handle, "rb") as file:
                if file.read(len(content) + 1) == content:
                    return
    except OSError:
        # Nothing there, or the writing says what is wrong.
        if not os.path.lexists(path):
            return
    raise InputError(
        f"{path}: is there already, without a mark that lutgen made it (got no --force); {way_out}."
    )


def write_text(path: str | os.PathLike[str], text: str, force: bool = False) -> None:
    """Write a UTF-8 file under a temporary name and rename it; see `write_bytes`."""
    write_bytes(path, text.encode("utf-8"), force=force)


def write_bytes(
    path: str | os.PathLike[str],
    content: bytes,
    failed: str = "cannot be written",
    force: bool = False,
) -> None:
    """Write a file under a temporary name and rename it.

    The temporary name cannot be foreseen, and the file behind it is opened only if it is new.

    Raises
    ------
    InputError
        As `check_target`; where the file cannot be written, in the words of `failed`: what was
        there before is untouched.
    """
    check_target(path, force, content)
    target = Path(path)
    if not target.name:
        raise InputError(f"{path}: {failed} (got the path of a folder); add a file's name.")
    partial = target.with_name(f".lutgen-{secrets.token_hex(8)}")
    try:
        handle = os.open(partial, os.O_WRONLY | os.O_CREAT | os.O_EXCL | _FLAGS, 0o666)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(content)
            _put(partial, target, force, content)
        finally:
            partial.unlink(missing_ok=True)
    except OSError as error:
        raise InputError(
            f"{target}: {failed} (got {error.strerror or error}); "
            "choose a folder that exists and is writable."
        ) from error


def _put(partial: Path, target: Path, force: bool, content: bytes) -> None:
    """Give a finished file its name; one that somebody else has taken meanwhile is left alone."""
    if not force:
        try:
            os.link(partial, target)
            return
        except FileExistsError:
            check_target(target, force, content)
        except OSError:
            # A file system without links.
            pass
    partial.replace(target)


def digest(content: bytes) -> str:
    """Return the SHA-256 of bytes, in hex."""
    return hashlib.sha256(content).hexdigest()


def plain(value: Any) -> Any:
    """Return a value as JSON has it: arrays as lists, null where a number is not finite."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: plain(part) for key, part in value.items()}
    return [plain(part) for part in value] if isinstance(value, list | tuple) else value


def csv_text(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    r"""Return a table as CSV with one header line.

    Floats are written so that they read back as the same number; NaN as an empty cell.

    Examples
    --------
    >>> csv_text(["x", "what"], [[0.1, "a,b"], [float("nan"), True]])
    'x,what\n0.1,"a,b"\n,1\n'
    """
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(head)
    writer.writerows([_cell(value) for value in row] for row in rows)
    return out.getvalue()


def _cell(value: object) -> object:
    """Return a value as CSV has it."""
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, float):
        # NaN differs from itself; float() drops NumPy's own way of printing.
        return repr(float(value)) if value == value else ""
    return value

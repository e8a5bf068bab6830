"""Write files that are either whole or not there, and replace only what lutgen has made."""

import contextlib
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

from lutgen.errors import InputError, reject

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
    """Return True if a file carries the mark of those that lutgen makes; OSError may be raised."""
    with Path(path).open("rb") as file:
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
        what, way_out = "is a link", "name the file that it leads to, or remove it"
        reject(path, what, f"one to {leads}", way_out, InputError)
    if not (stat.S_ISREG(kind) or stat.S_ISDIR(kind)):
        raise InputError(f"{path}: is no file (got a device, pipe or socket); name a file.")


def check_target(
    path: str | os.PathLike[str], force: bool = False, content: bytes | None = None
) -> None:
    """Refuse to write where something stands that lutgen did not make.

    InputError is raised for a file without lutgen's mark, unless `force` or it holds the `content`
    that is to be written; for a link or a device always.  A folder is left to the caller.
    """
    check_kind(path)
    if force or not os.path.lexists(path) or Path(path).is_dir():
        return
    # A file that cannot be read is not ours.
    with contextlib.suppress(OSError):
        same = content is not None and Path(path).stat().st_size == len(content)
        if is_ours(path) or (same and Path(path).read_bytes() == content):
            return
    what = "is there already, without a mark that lutgen made it"
    way_out = "choose another name, or pass --force to replace it"
    reject(path, what, "no --force", way_out, InputError)


def write_text(path: str | os.PathLike[str], text: str, force: bool = False) -> None:
    """Write a UTF-8 file under a temporary name and rename it; see `write_bytes`."""
    write_bytes(path, text.encode("utf-8"), force=force)


def write_bytes(
    path: str | os.PathLike[str],
    content: bytes,
    failed: str = "cannot be written",
    force: bool = False,
) -> None:
    """Write a file under a temporary name, which cannot be foreseen, and rename it.

    InputError, in the words of `failed`, leaves untouched what was there before.
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
            # Another process may have taken the name meanwhile.
            check_target(target, force, content)
            partial.replace(target)
        finally:
            partial.unlink(missing_ok=True)
    except OSError as error:
        what, way_out = failed, "choose a folder that exists and is writable"
        reject(target, what, error.strerror or error, way_out, InputError)


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
    for row in rows:
        # NaN differs from itself.
        cells = ["" if one != one else one for one in row]
        writer.writerow([int(one) if isinstance(one, bool) else one for one in cells])
    return out.getvalue()

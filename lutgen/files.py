"""Files that are either whole or not there.

Owns the temporary name, the rename, and the error messages for a full disk and a bad path.
"""

import csv
import io
import os
from collections.abc import Iterable, Sequence
from pathlib import Path

from lutgen.errors import InputError

__all__ = ["csv_text", "write_bytes", "write_text"]


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a UTF-8 file under a temporary name and rename it; see `write_bytes`."""
    write_bytes(path, text.encode("utf-8"))


def write_bytes(
    path: str | os.PathLike[str], content: bytes, failed: str = "cannot be written"
) -> None:
    """Write a file under a temporary name and rename it.

    Raises
    ------
    InputError
        Where the file cannot be written, in the words of `failed`; what was there before is
        untouched.
    """
    target = Path(path)
    partial = target.with_name(f".{target.name}.{os.getpid()}")
    try:
        partial.write_bytes(content)
        partial.replace(target)
    except OSError as error:
        raise InputError(
            f"{target}: {failed} (got {error.strerror or error}); "
            "choose a folder that exists and is writable."
        ) from error
    finally:
        partial.unlink(missing_ok=True)


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

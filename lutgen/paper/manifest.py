"""The list of the files of a report: by it the next report knows which it may replace.

Owns `manifest.json`, the digest of each file, and what is refused.
"""

import json
from collections.abc import Iterable
from pathlib import Path

from lutgen.errors import InputError
from lutgen.files import digest, is_ours

NAME = "manifest.json"
_MAKER, _FILES = "lutgen_paper", "sha256"
_MOST = 1 << 20


def text(folder: Path, names: Iterable[str]) -> str:
    """Return the list of these files of a folder."""
    files = {name: digest((folder / name).read_bytes()) for name in names}
    return json.dumps({_MAKER: 1, _FILES: files}, indent=2) + "\n"


def check(folder: Path, names: Iterable[str]) -> None:
    """Refuse to replace files of a folder that no report left there as they are.

    Parameters
    ----------
    folder : pathlib.Path
        Of the report; it need not exist.
    names : iterable of str
        Files that are to be written beside those that the list names.

    Raises
    ------
    InputError
        For a file that is there, and is neither as the list says nor carries lutgen's mark, and for
        a link or a device.
    """
    known = _listed(folder)
    for name in sorted({*names, *known, NAME}):
        path = folder / name
        try:
            if not (path.is_symlink() or path.exists()):
                continue
            if path.is_file() and not path.is_symlink():
                if name == NAME and known:
                    continue
                if is_ours(path) or digest(path.read_bytes()) == known.get(name):
                    continue
        except OSError as error:
            raise InputError(
                f"{path}: cannot be read (got {error.strerror or error}); choose another folder."
            ) from error
        raise InputError(
            f"{path}: is not as a report of lutgen left it (got no --force); choose another "
            "folder, or pass --force to replace it."
        )


def _listed(folder: Path) -> dict[str, str]:
    """Return name and digest of each file of the list; none where there is no list."""
    try:
        with (folder / NAME).open("rb") as file:
            content = json.loads(file.read(_MOST))
        if _MAKER not in content:
            return {}
        return {Path(name).name: str(known) for name, known in content[_FILES].items()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return {}

"""The folder and the entries of the cache of machine code, which is run as it is found.

Owns who may have written there: the user alone, in a folder of mode 0700.  And what was written:
every entry carries a digest of itself and of its name, and one that does not match counts as none,
so damage costs a compilation.  It knows nothing of kernels.
"""

import io
import os
import pickle
import stat
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from blake3 import blake3
from numba.core.caching import IndexDataCacheFile

__all__ = ["Entries", "cache_root", "usable"]

_DIGEST = 32
# Folders of which was said that they are not used: once is enough.
_said: set[Path] = set()


def cache_root() -> Path:
    """Return the folder that holds one folder per state of the sources."""
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    if chosen:
        return Path(chosen)
    user = os.environ.get("XDG_CACHE_HOME")
    try:
        return (Path(user) if user else Path.home() / ".cache") / "lutgen"
    except RuntimeError:  # no home folder is known
        return Path(tempfile.gettempdir()) / f"lutgen-{os.geteuid()}"


def usable(folder: Path) -> bool:
    """Make a folder of this user alone, or return that it cannot be one.

    What is said of a folder that somebody else may have filled is one sentence on stderr; a folder
    that cannot be written costs time and nothing else.
    """
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        folder.mkdir(mode=0o700, exist_ok=True)
        doubt = _doubt(folder.absolute())
        if doubt is None:
            if folder.stat().st_mode & 0o077:
                # Others could read it so far, and not write.
                folder.chmod(0o700)
            with tempfile.TemporaryFile(dir=folder):
                pass
            return True
    except OSError:
        return False
    if folder.parent not in _said:
        _said.add(folder.parent)
        print(
            f"lutgen: {folder}: somebody else can write there (got {doubt}), so machine code is "
            "not kept and every start compiles anew; remove that folder, or name another one of "
            "your own in NUMBA_CACHE_DIR",
            file=sys.stderr,
        )
    return False


def _doubt(folder: Path) -> str | None:
    """Return why somebody else may have written to a folder, None where nobody can have."""
    own = os.geteuid()
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode):
        return "a link" if stat.S_ISLNK(found.st_mode) else "no folder"
    if found.st_uid != own:
        return f"the owner {found.st_uid}"
    if found.st_mode & 0o022:
        return f"the mode {stat.S_IMODE(found.st_mode):04o}"
    for above in (folder, *folder.parents):
        found = above.lstat()
        if found.st_uid not in (own, 0):
            return f"the owner {found.st_uid} of {above}"
        if stat.S_ISLNK(found.st_mode):
            # Its owner is trusted; where it leads has to be looked at in the same way.
            return _doubt(folder.resolve())
        if found.st_mode & stat.S_IWOTH and not found.st_mode & stat.S_ISVTX:
            return f"the mode {stat.S_IMODE(found.st_mode):04o} of {above}"
    return None


class Entries(IndexDataCacheFile):  # type: ignore[misc]
    """The files of one kernel: an index, and one for each form that was compiled of it."""

    def save(self, key: Any, data: Any) -> None:
        """Keep one compiled form; the key is kept with it, since the index is a file apart."""
        super().save(key, (key, data))

    def load(self, key: Any) -> Any:
        """Return a compiled form, or None where there is none that is whole."""
        found = super().load(key)
        return found[1] if found is not None and found[0] == key else None

    def _load_index(self) -> dict[Any, str]:
        try:
            stream = io.BytesIO(self._whole(self._index_path))
        except OSError:
            return {}
        if pickle.load(stream) != self._version:
            return {}
        stamp, forms = pickle.loads(stream.read())
        return dict(forms) if stamp == self._source_stamp else {}

    def _load_data(self, name: str) -> Any:
        return pickle.loads(self._whole(self._data_path(name)))

    @contextmanager
    def _open_for_write(self, filepath: str) -> Iterator[io.BytesIO]:
        """Give a file in memory; it is written with its digest."""
        content = io.BytesIO()
        yield content
        data = content.getvalue()
        with super()._open_for_write(filepath) as file:
            file.write(_digest(filepath, data) + data)

    def _whole(self, path: str) -> bytes:
        """Return what an entry holds; OSError is raised for one that is damaged."""
        content = Path(path).read_bytes()
        if content[:_DIGEST] != _digest(path, content[_DIGEST:]):
            raise OSError(f"{path}: is damaged (got another digest); it is compiled anew")
        return content[_DIGEST:]


def _digest(path: str, data: bytes) -> bytes:
    """Return the digest of an entry: of what it holds, and of its name and its two folders'."""
    name = "/".join(Path(path).parts[-3:])
    return (
        blake3(len(name).to_bytes(4, "little") + name.encode("utf-8", "surrogateescape"))
        .update(data)
        .digest()
    )

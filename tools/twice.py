"""Build the wheel and the sdist twice, in two folders, and compare them byte by byte.

python -m tools.twice [FOLDER]

Also builds a wheel from what the sdist holds: that has to be the same once more.  The archives are
left in FOLDER, build/dist by default.  Exits with 1 where any two differ.
"""

import hashlib
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

__all__ = ["archives", "main"]

ROOT = Path(__file__).resolve().parent.parent
# What a build reads, and what earlier ones left in it.
PARTS = (
    *("pyproject.toml", "setup.py", "README.md", "LICENSE"),
    *("lutgen", "firmware_export", "maps"),
)
LEFT = shutil.ignore_patterns("__pycache__", "*.so", "*.nb?", "*.egg-info", "*.png")
BUILD = (
    "import os, setuptools.build_meta as build\n"
    "build.build_wheel('dist')\n"
    "build.build_sdist('dist')\n"
)


def built(source: Path, umask: int) -> list[Path]:
    """Build both archives of a folder of sources, and return them."""
    kept = {key: value for key, value in os.environ.items() if key != "SOURCE_DATE_EPOCH"}
    command = [sys.executable, "-c", f"import os; os.umask({umask})\n{BUILD}"]
    done = subprocess.run(
        command, cwd=source, env=kept, capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise SystemExit(f"the build failed:\n{done.stdout[-1000:]}{done.stderr[-2000:]}")
    return sorted((source / "dist").iterdir())


def copied(place: Path) -> Path:
    """Copy the sources to a place, and return it."""
    place.mkdir(parents=True)
    for name in PARTS:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, place / name, ignore=LEFT)
        else:
            shutil.copy(ROOT / name, place)
    return place


def unpacked(archive: Path, place: Path) -> Path:
    """Unpack an sdist, and return the folder in it."""
    with tarfile.open(archive) as tar:
        tar.extractall(place, filter="data")
    (folder,) = place.iterdir()
    return folder


def archives(work: Path) -> dict[str, set[str]]:
    """Build in folders below `work` and return the digests of each archive by its name."""
    # Their names have other lengths, and what they write has other rights.
    one = built(copied(work / "one"), 0o022)
    two = built(copied(work / "another" / "deeper"), 0o077)
    (sdist,) = [path for path in one if path.name.endswith(".gz")]
    third = built(unpacked(sdist, work / "from sdist"), 0o022)
    # Its own sdist lists one file more: the setup.cfg that every sdist is given.
    third = [path for path in third if path.suffix == ".whl"]
    found: dict[str, set[str]] = {}
    for path in (*one, *two, *third):
        found.setdefault(path.name, set()).add(hashlib.sha256(path.read_bytes()).hexdigest())
    return found


def main() -> int:
    """Build, compare and keep what was built."""
    target = Path(sys.argv[1] if len(sys.argv) > 1 else "build/dist")
    with tempfile.TemporaryDirectory() as folder:
        found = archives(Path(folder))
        shutil.rmtree(target, ignore_errors=True)
        shutil.copytree(Path(folder) / "one" / "dist", target)
    for name, digests in found.items():
        print(*sorted(digests), name, "" if len(digests) == 1 else "  not the same each time")
    return int(any(len(digests) > 1 for digests in found.values()))


if __name__ == "__main__":
    sys.exit(main())

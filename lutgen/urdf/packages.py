"""Find the folders of ROS packages that a robot description refers to by name.

Owns where they are looked for; what is read in them is not known here.  Nothing of ROS has to be
installed: its environment variables are used where they are set.
"""

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from lutgen.errors import RecipeError
from lutgen.urdf.xml import parse_xml

# A folder of ROS_PACKAGE_PATH holds packages, or repositories of packages.
DEPTH = 3
# A package.xml is a page of text.
MAX_BYTES = 2**20


@dataclass(frozen=True)
class Packages:
    """Where packages are: folders given by name, the environment, and around the description.

    `start` is the folder of the description.
    """

    start: Path
    named: Mapping[str, Path] = field(default_factory=dict)

    def find(self, name: str) -> Path | None:
        """Return the folder of a package, None where there is none.

        In this order: the folder that is given for the name, the folders of ROS_PACKAGE_PATH and up
        to 3 levels below, ``share/NAME`` in the prefixes of AMENT_PREFIX_PATH, then from `start`
        upwards each folder that is the package, or that holds it.  A folder is the package if it
        has a package.xml of that name; above `start` also if it is called so.
        """
        if name in self.named:
            return self.named[name]
        if not name or Path(name).name != name:
            return None
        return next(self._candidates(name), None)

    def _candidates(self, name: str) -> Iterator[Path]:
        """Yield the folders that are the package, the likeliest first."""
        for entry in _entries("ROS_PACKAGE_PATH"):
            for folder in _down(entry, DEPTH):
                if _is_package(folder, name):
                    yield folder
        for prefix in _entries("AMENT_PREFIX_PATH"):
            if (prefix / "share" / name).is_dir():
                yield prefix / "share" / name
        start = self.start.resolve()
        for folder in (start, *start.parents):
            if folder.name == name or _is_package(folder, name):
                yield folder
            if _is_package(folder / name, name):
                yield folder / name


def _entries(variable: str) -> list[Path]:
    """Return the folders of an environment variable."""
    return [Path(entry) for entry in os.environ.get(variable, "").split(os.pathsep) if entry]


def _down(folder: Path, levels: int) -> Iterator[Path]:
    """Yield a folder and those below it, nearest first; none inside of a package."""
    row = [folder]
    for _ in range(levels + 1):
        yield from row
        row = [
            below
            for above in row
            if not (above / "package.xml").exists()
            for below in _folders(above)
        ]


def _folders(folder: Path) -> list[Path]:
    """Return the folders in a folder in order of their names; none where it cannot be read."""
    try:
        return sorted(
            below for below in folder.iterdir() if below.is_dir() and below.name[0] != "."
        )
    except OSError:
        return []


def _is_package(folder: Path, name: str) -> bool:
    """Return whether a folder has a package.xml of that name; one that is no XML has none."""
    file = folder / "package.xml"
    try:
        if not file.is_file():
            return False
        with file.open("rb") as opened:
            root = parse_xml(opened.read(MAX_BYTES), str(file))
    except (OSError, RecipeError):
        return False
    return (root.findtext("name") or "").strip() == name

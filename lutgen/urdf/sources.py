"""Find the files that a description names, and expand the macros of xacro.

Nothing of ROS has to be installed: its environment variables are used where they are set.
Expansion evaluates expressions of the file and reads what it includes, so it happens only where
the caller requests it.
"""

import os
import re
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import unquote

from lutgen import bounds
from lutgen.errors import InputError, RecipeError, optional, reject
from lutgen.urdf.description import UrdfRobot
from lutgen.urdf.read import parse_urdf
from lutgen.urdf.xml import parse_xml

# A folder of ROS_PACKAGE_PATH holds packages, or repositories of packages.
DEPTH = 3
# Characters that a message quotes of a failure elsewhere.
LONGEST = 300


@dataclass(frozen=True)
class Sources:
    """Places of files: packages given by name, the environment, and around the description.

    `start` is the folder of the description.
    """

    start: Path
    named: Mapping[str, Path] = field(default_factory=dict)

    def file(self, name: str) -> Path:
        """Return the file of a path, ``file://``, ``package://`` or ``model://``.

        As it is written, or with percent signs decoded, or / for each backslash.  InputError is
        raised if it is missing, and names one that differs in case alone.
        """
        kind, mark, rest = name.partition("://")
        base, inside = self.start, rest if mark else name
        if kind in ("package", "model") and mark:
            package, _, inside = rest.partition("/")
            found = self.package(package)
            if found is None:
                raise InputError(f"package {package!r} was not found; give --package {package}=DIR")
            base = found
        elif mark and kind != "file":
            raise InputError(f"{name}: is neither a path nor file:// nor package://")
        slashed = inside.replace("\\", "/")
        for way in (inside, unquote(inside), slashed, unquote(slashed)):
            if (base / way).is_file():
                return base / way
        near = _other_case(base / unquote(slashed))
        beside = f", but {near.name!r}, which differs in case" if near else ""
        raise InputError(f"{name}: there is no such file{beside}")

    def package(self, name: str) -> Path | None:
        """Return the folder of a package, or None.

        It is the one that is given, or found by ROS's variables, or from `start` upwards.
        """
        if name in self.named:
            return self.named[name]
        if not name or Path(name).name != name:
            return None
        return next(self._candidates(name), None)

    def _candidates(self, name: str) -> Iterator[Path]:
        for entry in _entries("ROS_PACKAGE_PATH"):
            for depth in range(DEPTH + 1):
                files = sorted(entry.glob("*/" * depth + "package.xml"))
                yield from (file.parent for file in files if _is_package(file.parent, name))
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
    return [Path(entry) for entry in os.environ.get(variable, "").split(os.pathsep) if entry]


def _is_package(folder: Path, name: str) -> bool:
    """Return True if a folder has a package.xml of that name, as XML."""
    file = str(folder / "package.xml")
    try:
        root = parse_xml(bounds.read(file, bounds.URDF_BYTES), file)
    except RecipeError:
        return False
    return (root.findtext("name") or "").strip() == name


def _other_case(path: Path) -> Path | None:
    """Return the file whose path is the same but for upper and lower case."""
    if path.exists():
        return path
    if path.parent == path or (parent := _other_case(path.parent)) is None:
        return None
    wanted = path.name.casefold()
    return next((one for one in sorted(parent.glob("*")) if one.name.casefold() == wanted), None)


def load_xacro(
    path: str | os.PathLike[str],
    packages: Mapping[str, Path] | None = None,
    arguments: Mapping[str, str] | None = None,
) -> UrdfRobot:
    """Expand a xacro file and check the description that comes out.

    `packages` has folders by name, before those that `Sources.package` finds, and `arguments`
    values of ``<xacro:arg>``.
    """
    source = os.fspath(path)
    text = bounds.read(source, bounds.URDF_BYTES).decode("utf-8-sig", errors="replace")
    other = re.search(r"""xmlns:(?!xacro=)([\w.-]+)=["'][^"']*\bxacro["']""", text)
    if other:
        what = "binds xacro to another prefix"
        reject(source, what, f"{other[1]!r}", "write xmlns:xacro, and xacro: before its elements")
    xacro, xacrodoc, finder = (
        optional(source, name, "lutgen[xacro]", "expand the file with xacro")
        for name in ("xacro", "xacrodoc", "xacrodoc.packages")
    )
    known = Sources(Path(source).parent, packages or {})

    def find(package: str) -> str:
        folder = known.package(package)
        if folder is None:
            raise RecipeError(
                f"{source}: package {package!r} was not found (looked in ROS_PACKAGE_PATH, "
                "AMENT_PREFIX_PATH and the folders above the file); say where it is with "
                f"--package {package}=FOLDER."
            )
        return str(folder.resolve())

    # The library looks in what is installed of ROS alone.
    finder.get_path = find
    try:
        # Includes are relative to the file that has them.
        xacro.init_stacks(str(Path(source).absolute()))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            document = xacrodoc.XacroDoc.from_string(
                text,
                subargs=dict(arguments or {}),
                resolve_packages=False,
                rootdir=Path(source).parent,
            )
            # Names of meshes keep what they begin with: no package of theirs is needed.
            expanded = document.to_urdf_string(use_protocols=True)
    except Exception as error:
        # The expressions of a file can fail in any way that Python can.
        cause: BaseException | None = error
        while cause is not None and not isinstance(cause, RecipeError):
            cause = cause.__context__
        if cause is not None:
            raise cause from None
        reject(source, "cannot be expanded", quoted(error), "correct the macros")
    return parse_urdf(expanded, source)


def quoted(error: Exception) -> str:
    """Return what a failure elsewhere says, as one line of at most 300 characters."""
    said = " ".join(str(error).split()) or type(error).__name__
    return said if len(said) <= LONGEST else said[: LONGEST - 3] + "..."

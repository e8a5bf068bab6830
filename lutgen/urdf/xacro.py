"""Expand xacro, the macro language of robot descriptions, through an optional package.

Expansion evaluates expressions of the file and reads the files that it includes, so it happens
only where the caller asks for it.  The meshes that it names are not looked for.
"""

import os
import warnings
from collections.abc import Mapping
from pathlib import Path

from lutgen.errors import InputError, RecipeError
from lutgen.urdf.description import UrdfRobot
from lutgen.urdf.packages import Packages
from lutgen.urdf.read import parse_urdf

# Characters that a message quotes of a macro's failure.
LONGEST = 300


def load_xacro(
    path: str | os.PathLike[str],
    packages: Mapping[str, Path] | None = None,
    arguments: Mapping[str, str] | None = None,
) -> UrdfRobot:
    """Expand a xacro file and check the description that comes out.

    Parameters
    ----------
    path : path
        The file.
    packages : mapping of str to Path, optional
        Folders of packages by name; others are looked for as `Packages.find` says.
    arguments : mapping of str to str, optional
        Values of the file's ``<xacro:arg>``, instead of their defaults.

    Returns
    -------
    UrdfRobot
        Checked.

    Raises
    ------
    InputError
        Where the package xacrodoc is not installed.
    RecipeError
        Where a package is not found, the file cannot be expanded, or describes no robot.
    """
    source = os.fspath(path)
    found: dict[str, Path] = dict(packages or {})
    known = Packages(Path(source).parent, packages or {})
    # Which packages are needed shows while the file is expanded: once more for each.
    while True:
        missing, text = _expanded(source, found, arguments or {})
        if missing is None:
            return parse_urdf(text, source)
        folder = known.find(missing) if missing not in found else None
        if folder is None:
            raise RecipeError(
                f"{source}: package {missing!r} was not found (looked in ROS_PACKAGE_PATH, "
                "AMENT_PREFIX_PATH and the folders above the file); say where it is with "
                f"--package {missing}=FOLDER."
            )
        found[missing] = folder


def _expanded(
    source: str, folders: Mapping[str, Path], arguments: Mapping[str, str]
) -> tuple[str | None, str]:
    """Return None and the expanded text, or the name of a package that is missing."""
    try:
        from xacrodoc import XacroDoc, packages
    except ImportError:
        raise InputError(
            f"{source}: needs the package xacrodoc to be expanded (got no such package); "
            "install it with `pip install lutgen[xacro]`, or expand the file with xacro."
        ) from None
    try:
        # What an earlier file found is forgotten.
        packages.reset()
        packages.update_package_cache(folders)
        # Whatever the macros warn of is their author's affair.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            document = XacroDoc.from_file(
                source, walk_up=False, resolve_packages=False, subargs=dict(arguments)
            )
            # Names of meshes keep what they begin with: no package of theirs is needed.
            return None, document.to_urdf_string(use_protocols=True)
    except Exception as error:
        # The expressions of a file can fail in any way that Python can.
        cause: BaseException | None = error
        while cause is not None:
            if isinstance(cause, packages.PackageNotFoundError):
                return str(cause.args[0]), ""
            cause = cause.__context__
        said = " ".join(str(error).split()) or type(error).__name__
        said = said if len(said) <= LONGEST else said[: LONGEST - 3] + "..."
        raise RecipeError(
            f"{source}: cannot be expanded (got {said}); correct the macros."
        ) from None

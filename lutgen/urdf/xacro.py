"""Expand xacro, the macro language of robot descriptions, through an optional package.

Expansion evaluates expressions of the file and reads the files that it includes, so it happens
only where the caller asks for it.
"""

import os
import warnings

from lutgen.errors import InputError, RecipeError
from lutgen.urdf.read import UrdfRobot, parse_urdf


def load_xacro(path: str | os.PathLike[str]) -> UrdfRobot:
    """Expand a xacro file and check the description that comes out.

    Raises
    ------
    InputError
        Where the package xacrodoc is not installed.
    RecipeError
        Where the file cannot be expanded, or describes no robot.
    """
    source = os.fspath(path)
    try:
        from xacrodoc import XacroDoc
    except ImportError:
        raise InputError(
            f"{source}: needs the package xacrodoc to be expanded (got no such package); "
            "install it with `pip install lutgen[xacro]`, or expand the file with xacro."
        ) from None
    try:
        # Whatever the macros warn of is their author's affair.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            document = XacroDoc.from_file(source, resolve_packages=False)
            text = document.to_urdf_string(use_protocols=False)
    except Exception as error:
        # The expressions of a file can fail in any way that Python can.
        first = (str(error).splitlines() or [""])[0] or type(error).__name__
        raise RecipeError(
            f"{source}: cannot be expanded (got {first}); correct the macros."
        ) from None
    return parse_urdf(text, source)

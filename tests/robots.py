"""Small robot descriptions (URDF) that several test files share, and where real ones are."""

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
# Descriptions of real robots are other people's files and not part of this repository.
FOLDER = Path(os.environ.get("LUTGEN_ROBOTS", ROOT.parent / "shared" / "robots"))


def real(name: str) -> Path:
    """Return the path of a real description; skip the test where it is absent."""
    path = FOLDER / f"{name}.urdf"
    if not path.is_file():
        pytest.skip(f"{path} is not there; set LUTGEN_ROBOTS to the folder that holds it")
    return path


def link(name: str, mass: float = 0.0, com: str = "0 0 0", inside: str = "") -> str:
    """Return a <link>; without mass it has no inertial."""
    inertial = f'<inertial><origin xyz="{com}"/><mass value="{mass!r}"/></inertial>' if mass else ""
    return f'<link name="{name}">{inertial}{inside}</link>'


def collision(shape: str, xyz: str = "0 0 0", rpy: str = "0 0 0") -> str:
    """Return a <collision> of a shape such as ``sphere radius="0.1"``."""
    place = f'<origin xyz="{xyz}" rpy="{rpy}"/>'
    return f"<collision>{place}<geometry><{shape}/></geometry></collision>"


def joint(
    name: str,
    kind: str,
    parent: str,
    child: str,
    inside: str = "",
    xyz: str = "0 0 0",
    rpy: str = "0 0 0",
) -> str:
    """Return a <joint>."""
    ends = f'<parent link="{parent}"/><child link="{child}"/><origin xyz="{xyz}" rpy="{rpy}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}{inside}</joint>'


def robot(*parts: str, name: str = "little") -> str:
    """Return a whole description."""
    return f'<?xml version="1.0"?>\n<robot name="{name}">{"".join(parts)}</robot>'

"""Sound files to start from: recipes, a description with its mesh and postures, a terrain.

Each is small, so that a run takes milliseconds; what is wrong with a case was put there.
"""

import functools
import struct
import tempfile
from collections.abc import Mapping
from pathlib import Path

from tests.fixtures.recipes import rover, tripod

__all__ = ["DESCRIPTIONS", "MESH", "POSTURES", "SPY", "STANCE", "TERRAIN", "recipes", "swept"]

ROOT = Path(__file__).resolve().parent.parent.parent
# Code that nobody asked for must not run: this would leave a file behind.
SPY = b'open("it ran", "w").close()\ndef contacts(p):\n    return {}\n'

STANCE = """title = "stair"
length_unit = "m"
com = [0, 0, 0.5]
friction = 0.6
gravity = [0.05, 0, -1]
[[foot]]
name = "front"
position = [0.3, 0, 0.1]
normal = [0.1, 0, 1]
[[foot]]
position = [-0.2, 0.2, 0]
friction = 0.4
[[foot]]
position = [-0.2, -0.2, 0]
"""

TERRAIN = """x,y,z,heading,nx,ny,nz
0,0,0,0,0,0,1
0.1,0,0.01,1,0.1,0,1
0.2,0.01,0.02,2,0.1,0.1,1
0.3,0.01,0.01,3,0,0.1,1
0.4,0.02,0.04,4,-0.1,0,1
"""

# A tetrahedron as binary STL.
_CORNERS = ((0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, 0.0, 0.4))
_FACES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
MESH = (bytes(80) + struct.pack("<I", len(_FACES))) + b"".join(
    struct.pack("<12fH", 0, 0, 0, *(x for corner in face for x in _CORNERS[corner]), 0)
    for face in _FACES
)

_ARM = """<?xml version="1.0"?>
<robot name="crane">
  <link name="base">
    <inertial><origin xyz="0 0 0.1" rpy="0 0 0"/><mass value="20"/></inertial>
    <collision><origin xyz="0 0 0.05"/><geometry><box size="0.6 0.4 0.1"/></geometry></collision>
    <collision><origin xyz="0.3 0.2 -0.1"/><geometry><sphere radius="0.05"/></geometry>
    </collision>
    <collision><origin xyz="0.3 -0.2 -0.1"/><geometry><sphere radius="0.05"/></geometry>
    </collision>
    <collision><origin xyz="-0.3 0.2 -0.1"/><geometry><sphere radius="0.05"/></geometry>
    </collision>
    <collision><origin xyz="-0.3 -0.2 -0.1"/><geometry><sphere radius="0.05"/></geometry>
    </collision>
  </link>
  <link name="tower">
    <inertial><origin xyz="0 0 0.2"/><mass value="2"/></inertial>
    <collision><geometry><mesh filename="mast.stl" scale="1 1 1"/></geometry></collision>
  </link>
  <link name="boom">
    <inertial><origin xyz="0.3 0 0"/><mass value="1.5"/></inertial>
    <collision><geometry><cylinder radius="0.03" length="0.5"/></geometry></collision>
  </link>
  <link name="hook"><inertial><mass value="0.5"/></inertial>
    <collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <joint name="turn" type="continuous">
    <parent link="base"/><child link="tower"/><origin xyz="0 0 0.1"/><axis xyz="0 0 1"/>
  </joint>
  <joint name="lift" type="revolute">
    <parent link="tower"/><child link="boom"/><origin xyz="0 0 0.4" rpy="0 0.1 0"/>
    <axis xyz="0 1 0"/><limit lower="-0.8" upper="0.3" effort="10" velocity="1"/>
  </joint>
  <joint name="trolley" type="prismatic">
    <parent link="boom"/><child link="hook"/><origin xyz="0.2 0 0"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.3" effort="10" velocity="1"/><mimic joint="lift" multiplier="0.1"/>
  </joint>
</robot>
"""
POSTURES = b"""<robot name="crane">
  <group_state name="stand" group="all"><joint name="lift" value="-0.2"/></group_state>
</robot>
"""


@functools.cache
def _descriptions() -> Mapping[str, str]:
    vectors = ROOT / "tests" / "vectors"
    own = {f"{name}.urdf": (vectors / f"{name}.urdf").read_text("utf-8") for name in ("quadruped",)}
    return {"crane.urdf": _ARM, **own}


DESCRIPTIONS = _descriptions()


@functools.cache
def recipes() -> Mapping[str, str]:
    """Return recipes by name: two of the proofs, those to start from, and the paper's."""
    starts = {path.stem: path for path in (ROOT / "lutgen" / "recipe" / "starts").glob("*.toml")}
    files = {**starts, "paper_two": ROOT / "maps" / "paper_two.toml"}
    texts = {name: path.read_text("utf-8") for name, path in sorted(files.items())}
    return {"tripod": tripod(nodes=5), "rover": rover(nodes=5), **texts}


@functools.cache
def swept(name: str = "tripod") -> bytes:
    """Return the map of a recipe of these as the bytes of its file."""
    from lutgen.mapping import sweep
    from lutgen.recipe import parse_recipe

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "map.h5"
        sweep(parse_recipe(recipes()[name], f"{name}.toml"), file, threads=1)
        return file.read_bytes()

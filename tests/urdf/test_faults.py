"""Files with faults, a thousand of SRDF and xacro: a sentence or an answer, nothing else."""

import random
from pathlib import Path

import pytest

from lutgen.errors import LutgenError
from lutgen.propose import import_urdf
from lutgen.urdf.read import parse_urdf
from lutgen.urdf.sources import load_xacro
from lutgen.urdf.srdf import load_srdf
from tests.fixtures.places import VECTORS
from tests.fixtures.robots import broken

XACRO = VECTORS / "xacro"
SRDF = """<?xml version="1.0"?>
<robot name="rover">
  <group name="front"><joint name="arms"/></group>
  <group_state name="standing" group="front">
    <joint name="arms" value="0.2"/><joint name="lift" value="0.3"/>
    <joint name="root_joint" value="0 0 1 0 0 0 1"/>
  </group_state>
  <group_state name="folded" group="front"><joint name="arms" value="-0.7"/></group_state>
  <disable_collisions link1="mast" link2="lens" reason="Never"/>
</robot>"""


def sentence(error: LutgenError) -> None:
    """Check that an error is one sentence that begins with its file."""
    said = str(error)
    assert "\n" not in said
    assert said.endswith(".")
    assert "broken" in said


def test_an_srdf_with_faults_is_read_or_refused_in_a_sentence(tmp_path: Path) -> None:
    robot = parse_urdf((VECTORS / "rover.urdf").read_text(encoding="utf-8"))
    rng = random.Random(1)
    file = tmp_path / "broken.srdf"
    refused = 0
    for _ in range(500):
        file.write_bytes(broken(rng, SRDF))
        try:
            found = load_srdf(file, robot)
            name = found.standing()
            import_urdf(robot, posture=found.posture(name) if name else None)
        except LutgenError as error:
            refused += 1
            sentence(error)
    # Both happen, or the faults are too harsh or too mild to show anything.
    assert 50 < refused < 450


def test_a_xacro_with_faults_is_read_or_refused_in_a_sentence(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    packages = {folder.name: folder for folder in (XACRO / "share").iterdir()}
    sound = (XACRO / "robots" / "crane.xacro").read_text(encoding="utf-8")
    rng = random.Random(1)
    file = tmp_path / "broken.xacro"
    refused = 0
    for _ in range(125):
        file.write_bytes(broken(rng, sound))
        try:
            import_urdf(load_xacro(file, packages))
        except LutgenError as error:
            refused += 1
            sentence(error)
    assert 10 < refused < 125
    assert capfd.readouterr().err == ""

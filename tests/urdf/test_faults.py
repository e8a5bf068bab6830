"""Files with faults, hundreds of URDF, SRDF and xacro: a sentence or an answer, nothing else."""

import random
import re

import pytest

from lutgen.errors import LutgenError
from lutgen.propose import import_urdf
from lutgen.urdf.read import load_urdf
from lutgen.urdf.sources import load_xacro
from lutgen.urdf.srdf import load_srdf
from tests.fixtures.places import VECTORS
from tests.fixtures.robots import broken

XACRO = VECTORS / "xacro"


def stand(file):
    """Import the quadruped as an SRDF file says that it stands."""
    robot = load_urdf(VECTORS / "quadruped.urdf")
    found = load_srdf(file, robot)
    name = found.standing()
    import_urdf(robot, posture=found.posture(name) if name else None)


def expand(file):
    """Import a xacro file."""
    packages = {folder.name: folder for folder in (XACRO / "share").iterdir()}
    import_urdf(load_xacro(file, packages))


@pytest.mark.parametrize(
    ("sound", "read", "count"),
    [
        ((VECTORS / "rover.urdf").read_text(), lambda file: import_urdf(load_urdf(file)), 200),
        ((VECTORS / "quadruped.srdf").read_text(), stand, 100),
        ((XACRO / "robots" / "crane.xacro").read_text(), expand, 60),
    ],
    ids=["urdf", "srdf", "xacro"],
)
def test_a_file_with_faults_is_read_or_refused_in_a_sentence(sound, read, count, tmp_path, capfd):
    rng, file, said = random.Random(1), tmp_path / "broken", []
    for _ in range(count):
        file.write_bytes(broken(rng, sound))
        try:
            read(file)
        except LutgenError as error:
            said.append(str(error))
    # Both happen, or the faults are too harsh or too mild to show anything.
    assert count / 12 < len(said) < count
    assert [words for words in said if not re.fullmatch(r".*broken.*\.", words)] == []
    assert capfd.readouterr().err == ""

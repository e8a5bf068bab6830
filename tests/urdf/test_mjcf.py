"""Robots in MuJoCo's format: masses, places and couplings are those that MuJoCo computes."""

import math
from pathlib import Path

import numpy as np
import pytest

from lutgen.errors import RecipeError
from lutgen.urdf.joints import read_motion
from lutgen.urdf.links import centre_of_mass, places
from lutgen.urdf.mjcf import load_mjcf
from lutgen.vector import rotation

mujoco = pytest.importorskip("mujoco")
# Degrees, defaults, an anchor away from the body's origin, two joints on one body, a reference
# angle, a mesh, a coupling, and a body beside the robot.
TEXT = """
<mujoco>
  <compiler angle="degree" eulerseq="zyx"/>
  <default>
    <geom density="500"/>
    <default class="look"><geom contype="0" conaffinity="0" density="0"/></default>
  </default>
  <asset><mesh name="shoe" vertex="0 0 0  .2 0 0  0 .1 0  0 0 .1  .2 .1 0" scale="2 1 1"/></asset>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="crate" pos="3 0 0"><geom type="box" size=".1 .1 .1"/></body>
    <body name="trunk" pos="0 0 1" euler="10 20 30">
      <freejoint/>
      <geom name="hull" type="box" size=".3 .2 .1"/>
      <geom class="look" type="sphere" size=".5"/>
      <body name="thigh" pos=".2 .1 -.1" euler="5 0 40">
        <joint name="roll" axis="1 0 0" pos="0 .03 0" range="-40 50"/>
        <joint name="pitch" axis="0 1 0" pos=".02 0 .05" range="-60 60" ref="15"/>
        <geom name="bone" type="capsule" fromto="0 0 0 0 0 -.3" size=".03"/>
        <body name="shank" pos="0 0 -.3">
          <joint name="slide" type="slide" axis="0 0 1" range="-.1 .1"/>
          <geom name="foot" type="sphere" pos="0 0 -.2" size=".04"/>
        </body>
      </body>
      <body name="paw" pos="-.2 0 -.1">
        <joint name="follow" axis="0 1 0"/>
        <geom name="sole" type="mesh" mesh="shoe" euler="0 30 0"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor joint="pitch"/></actuator>
  <equality><joint joint1="follow" joint2="pitch" polycoef="0.1 -2 0 0 0"/></equality>
</mujoco>
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "beast.xml"
    path.write_text(TEXT)
    return path


def compiled(file, values):
    """Return MuJoCo's model and state with joints away from the reference by values (rad, m)."""
    model = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(model)
    for name, value in values.items():
        data.joint(name).qpos = model.qpos0[model.joint(name).qposadr[0]] + value
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    return model, data


GEOMS = {"trunk": ["hull"], "thigh": ["bone"], "shank": ["foot"], "paw": ["sole"]}
VALUES = {"roll": 0.4, "pitch": -0.6, "slide": 0.07}


def test_mass_com_and_every_geom_are_where_mujoco_has_them(file):
    got = load_mjcf(file)
    model, data = compiled(file, VALUES | {"follow": 0.1 - 2.0 * VALUES["pitch"]})
    where = places(got.robot, read_motion(got.robot), VALUES)
    turn, origin = data.body("trunk").xmat.reshape(3, 3), data.body("trunk").xpos
    mass = math.fsum(link.mass for link in got.robot.links)
    assert mass == pytest.approx(model.body("trunk").subtreemass[0], rel=1e-12)
    com = turn.T @ (data.subtree_com[model.body("trunk").id] - origin)
    np.testing.assert_allclose(centre_of_mass(got.robot, where), com, atol=1e-9)
    seen = 0
    for link in got.robot.links:
        own, at = where[link.name]
        for shape, name in zip(link.collisions, GEOMS.get(link.name, ()), strict=True):
            geom = data.geom(name)
            np.testing.assert_allclose(
                at + own @ shape.origin, turn.T @ (geom.xpos - origin), atol=1e-9
            )
            np.testing.assert_allclose(
                own @ rotation(shape.rpy), turn.T @ geom.xmat.reshape(3, 3), atol=1e-9
            )
            seen += 1
    assert seen == 4


def test_limits_count_from_the_reference_and_a_coupling_is_followed(file):
    got = load_mjcf(file)
    joints = {joint.name: joint for joint in got.robot.joints}
    assert math.degrees(joints["pitch"].lower) == pytest.approx(-75.0)
    assert (joints["pitch"].effort, joints["roll"].effort) == (None, 0.0)
    assert joints["follow"].mimic is not None
    assert list(read_motion(got.robot).free) == ["roll", "pitch", "slide"]
    assert got.robot.ignored == {"body beside the robot": 1}


def test_sizes_are_whole_lengths_and_looks_touch_nothing(file):
    got = load_mjcf(file)
    links = {link.name: link for link in got.robot.links}
    (hull,) = links["trunk"].collisions
    assert hull.size == pytest.approx((0.6, 0.4, 0.2))
    (thigh,) = links["thigh"].collisions
    assert (thigh.kind, thigh.size) == ("capsule", pytest.approx((0.03, 0.3)))
    (sole,) = links["paw"].collisions
    corners = got.meshes[sole.file] @ rotation(sole.rpy).T + sole.origin
    written = [[0, 0, 0], [0.4, 0, 0], [0, 0.1, 0], [0, 0, 0.1], [0.4, 0.1, 0]]
    want = np.array(written) @ rotation((0.0, math.radians(30.0), 0.0)).T
    apart = np.linalg.norm(corners[:, None] - want, axis=2)
    assert apart.min(axis=0).max() < 1e-6


def test_mujocos_warnings_leave_no_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("old.xml").write_text(TEXT.replace("<compiler ", '<compiler settotalmass="3" '))
    assert math.fsum(link.mass for link in load_mjcf("old.xml").robot.links) < 3.0
    assert [path.name for path in tmp_path.iterdir()] == ["old.xml"]


def test_files_without_a_robot_are_refused_in_a_sentence(tmp_path):
    for text, said in (
        ("<mujoco><worldbody/></mujoco>", "no body has a mass"),
        ("<mujoco><worldbody><body><geom/></body></worldbody></mujoco>", "MuJoCo cannot read it"),
        ("not XML", "MuJoCo cannot read it"),
    ):
        path = tmp_path / "bad.xml"
        path.write_text(text)
        with pytest.raises(RecipeError, match=said):
            load_mjcf(path)

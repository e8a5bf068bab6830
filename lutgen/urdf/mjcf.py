"""Read a robot from MuJoCo's format (MJCF), as MuJoCo itself resolves it.

Defaults, includes, compiler options and mesh frames are MuJoCo's business: what is read here is the
compiled model.  A body is a link; a body with several joints is a chain of links.
"""

import os
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from lutgen import bounds
from lutgen.arrays import Floats
from lutgen.errors import RecipeError, optional, reject
from lutgen.parts import ZERO, three
from lutgen.urdf.description import Collision, Mimic, UrdfJoint, UrdfLink, UrdfRobot
from lutgen.urdf.sources import quoted
from lutgen.urdf.xml import parse_xml
from lutgen.vector import angles, from_quaternion

# Shapes by MuJoCo's numbers of geoms; lengths are halves there.
SHAPES = ("plane", "hfield", "sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh", "sdf")
FREE, BALL, SLIDE, HINGE = range(4)
EQUAL_JOINTS = 2


class Mjcf(NamedTuple):
    """A robot of MuJoCo's format: its description, and the corners (n, 3) of its meshes by name."""

    robot: UrdfRobot
    meshes: dict[str, Floats]


def is_mjcf(path: str | os.PathLike[str]) -> bool:
    """Return True if a file is XML whose root is <mujoco>."""
    source = os.fspath(path)
    try:
        return parse_xml(bounds.read(source, bounds.URDF_BYTES), source).tag == "mujoco"
    except RecipeError:
        return False


def load_mjcf(path: str | os.PathLike[str]) -> Mjcf:
    """Read an MJCF file with the package mujoco, which opens the files that it includes.

    The robot is the free body with most mass, or else the body of the world with most mass; joints
    between it and the world are left out.  Values of joints count from the posture `qpos0`.
    """
    source = os.fspath(path)
    mujoco = optional(source, "mujoco", "lutgen[mjcf]", "write a URDF")
    before = mujoco.get_mju_user_warning()
    # Else warnings go to a file MUJOCO_LOG.TXT where the command runs.
    mujoco.set_mju_user_warning(lambda text: None)
    try:
        model = mujoco.MjModel.from_xml_path(source)
    except (ValueError, mujoco.FatalError) as error:
        reject(source, "MuJoCo cannot read it", quoted(error), "correct the file")
    finally:
        mujoco.set_mju_user_warning(before)
    return _Reader(model, source).read()


class _Reader:
    def __init__(self, model: Any, source: str) -> None:
        self.model, self.source = model, source
        self.left_out: Counter[str] = Counter()
        self.meshes: dict[str, Floats] = {}

    def read(self) -> Mjcf:
        model = self.model
        tops = [b for b in range(1, model.nbody) if model.body_parentid[b] == 0]
        free = [b for b in tops if FREE in self.kinds(b)]
        top = max(free or tops, key=lambda b: model.body_subtreemass[b], default=0)
        if not top or not model.body_subtreemass[top] > 0.0:
            raise RecipeError(
                f"{self.source}: no body has a mass, so there is no robot (got {len(tops)} bodies "
                "in the world); give its bodies geoms or an <inertial>."
            )
        self.left_out["body beside the robot"] = len(tops) - 1
        inside = [b for b in range(1, model.nbody) if model.body_rootid[b] == top]
        links: list[UrdfLink] = []
        joints: list[UrdfJoint] = []
        shift: dict[int, Floats] = {}
        for body in inside:
            chain, shift[body] = ([], np.zeros(3)) if body == top else self.chain(body, shift)
            joints += chain
            links += [UrdfLink(joint.child) for joint in chain[:-1]]
            links.append(self.link(body, shift[body]))
        self.left_out["joint between robot and world"] = model.body_jntnum[top] - len(free)
        self.left_out["tendon"] = model.ntendon
        coupled = self.coupled()
        joints = [replace(one, **coupled.get(one.name, {})) for one in joints]
        robot = UrdfRobot(
            Path(self.source).stem,
            self.source,
            self.name("body", top),
            tuple(links),
            tuple(joints),
            {what: count for what, count in self.left_out.items() if count > 0},
        )
        return Mjcf(robot, self.meshes)

    def name(self, kind: str, index: int) -> str:
        """Return the name of a body, joint, geom or mesh, or its kind and number."""
        return getattr(self.model, kind)(index).name or f"{kind}_{index}"

    def kinds(self, body: int) -> list[int]:
        first = self.model.body_jntadr[body]
        return list(map(int, self.model.jnt_type[first : first + self.model.body_jntnum[body]]))

    def chain(self, body: int, shift: dict[int, Floats]) -> tuple[list[UrdfJoint], Floats]:
        """Return the joints from a body's parent to it, and where its link is in its own frame.

        Each hinge turns about its anchor, where the link that it moves has its origin.
        """
        model, above = self.model, int(self.model.body_parentid[body])
        turn = _turn(model.body_quat[body])
        parent, own = self.name("body", above), self.name("body", body)
        # Anchors are in the body's frame, and the parent's link is not at its body's origin.
        at, rpy = model.body_pos[body] - shift[above], angles(turn)
        first, count = model.body_jntadr[body], model.body_jntnum[body]
        if count == 0:
            joint = UrdfJoint(f"{own}_fixed", "fixed", parent, own, three(at), rpy)
            return [joint], np.zeros(3)
        result, here = [], np.zeros(3)
        for j in range(first, first + count):
            anchor = np.array(model.jnt_pos[j]) if model.jnt_type[j] == HINGE else here
            child = own if j == first + count - 1 else f"{own}_after_{self.name('joint', j)}"
            origin = three(at + turn @ anchor) if j == first else three(anchor - here)
            joint = self.joint(j, parent, child)
            result.append(replace(joint, origin=origin, rpy=rpy if j == first else ZERO))
            parent, here = child, anchor
        return result, here

    def joint(self, j: int, parent: str, child: str) -> UrdfJoint:
        """Return a joint without its place."""
        model, kind = self.model, int(self.model.jnt_type[j])
        if kind not in (SLIDE, HINGE):
            return UrdfJoint(self.name("joint", j), "floating", parent, child)
        limited, (low, high) = bool(model.jnt_limited[j]), model.jnt_range[j].tolist()
        ref = float(model.qpos0[model.jnt_qposadr[j]])
        moves = "prismatic" if kind == SLIDE else "revolute" if limited else "continuous"
        ends = {"lower": low - ref, "upper": high - ref} if limited else {}
        # Tendons and others do not say which joint they drive.
        by_joint = model.nu and (model.actuator_trntype <= 1).all()
        effort = 0.0 if by_joint and j not in model.actuator_trnid[:, 0] else None
        axis = three(model.jnt_axis[j])
        return UrdfJoint(
            self.name("joint", j), moves, parent, child, axis=axis, effort=effort, **ends
        )

    def coupled(self) -> dict[str, dict[str, Any]]:
        """Return what the equalities between joints alter, by the joint's name."""
        model, result = self.model, dict[str, dict[str, Any]]()
        for e in range(model.neq):
            if model.eq_type[e] != EQUAL_JOINTS or not model.eq_active0[e]:
                self.left_out["equality"] += 1
                continue
            offset, scale, *curved = model.eq_data[e][:5].tolist()
            first, second = int(model.eq_obj1id[e]), int(model.eq_obj2id[e])
            if second < 0:
                result[self.name("joint", first)] = {"lower": offset, "upper": offset}
            elif any(curved):
                self.left_out["equality"] += 1
            else:
                mimic = Mimic(self.name("joint", second), scale, offset)
                result[self.name("joint", first)] = {"mimic": mimic, "effort": None}
        return result

    def link(self, body: int, shift: Floats) -> UrdfLink:
        model = self.model
        first = model.body_geomadr[body]
        geoms = range(first, first + model.body_geomnum[body])
        touching = [g for g in geoms if model.geom_contype[g] or model.geom_conaffinity[g]]
        shapes = tuple(self.shape(g, shift) for g in touching)
        looks = () if shapes else tuple(self.shape(g, shift) for g in geoms)
        com = three(model.body_ipos[body] - shift)
        return UrdfLink(self.name("body", body), float(model.body_mass[body]), com, shapes, looks)

    def shape(self, g: int, shift: Floats) -> Collision:
        model, kind = self.model, SHAPES[self.model.geom_type[g]]
        place = three(model.geom_pos[g] - shift), angles(_turn(model.geom_quat[g]))
        a, b, c = model.geom_size[g].tolist()
        sizes: dict[str, tuple[float, ...]] = {
            "sphere": (a,),
            "capsule": (a, 2.0 * b),
            "cylinder": (a, 2.0 * b),
            "box": (2.0 * a, 2.0 * b, 2.0 * c),
        }
        if kind == "mesh":
            mesh = int(model.geom_dataid[g])
            file, first = self.name("mesh", mesh), model.mesh_vertadr[mesh]
            vertices = model.mesh_vert[first : first + model.mesh_vertnum[mesh]]
            self.meshes[file] = np.array(vertices, np.float64)
            return Collision(kind, (), *place, file, (1.0, 1.0, 1.0))
        note = "" if kind in sizes else f"a geom of kind {kind!r} is not understood"
        return Collision(kind, sizes.get(kind, ()), *place, note=note)


def _turn(quaternion: Floats) -> Floats:
    w, x, y, z = quaternion.tolist()
    return from_quaternion(x, y, z, w)

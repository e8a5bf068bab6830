"""A robot description of ROS, read into links, joints and contacts.

In reading order: `xml`, `description`, `printed`, `read`, `motion`, `links`, `contacts`, `groups`,
`posture`, `packages`, `xacro`, `mesh_file`, `reach`, `meshes`, `wheel_shape`, `foot_shape`.
"""

from lutgen.urdf.contacts import TOUCHING, link_contacts, used_shapes
from lutgen.urdf.description import Collision, UrdfJoint, UrdfLink, UrdfRobot
from lutgen.urdf.foot_shape import foot_of
from lutgen.urdf.links import Place, centre_of_mass, downwards, links_of, places
from lutgen.urdf.meshes import Meshes
from lutgen.urdf.motion import TURN, Couple, Motion, read_motion
from lutgen.urdf.packages import Packages
from lutgen.urdf.posture import Srdf, beyond_limits, joint_values, load_srdf, srdf_beside
from lutgen.urdf.read import JOINT_KINDS, MAX_BYTES, load_urdf, parse_urdf
from lutgen.urdf.wheel_shape import wheel_of
from lutgen.urdf.xacro import load_xacro

__all__ = [
    "JOINT_KINDS",
    "MAX_BYTES",
    "TOUCHING",
    "TURN",
    "Collision",
    "Couple",
    "Meshes",
    "Motion",
    "Packages",
    "Place",
    "Srdf",
    "UrdfJoint",
    "UrdfLink",
    "UrdfRobot",
    "beyond_limits",
    "centre_of_mass",
    "downwards",
    "foot_of",
    "joint_values",
    "link_contacts",
    "links_of",
    "load_srdf",
    "load_urdf",
    "load_xacro",
    "parse_urdf",
    "places",
    "read_motion",
    "srdf_beside",
    "used_shapes",
    "wheel_of",
]

"""A robot description of ROS, read into links, joints and shapes.

In reading order: `xml`, `description`, `printed`, `read`, `joints`, `links`, `shapes`, `srdf`,
`sources`; and `meshes` and `feet`, which take longer to import.
"""

from lutgen.urdf.description import Collision, UrdfJoint, UrdfLink, UrdfRobot
from lutgen.urdf.joints import TURN, Couple, Motion, read_motion, soft_limited
from lutgen.urdf.links import Place, carried, centre_of_mass, downwards, links_of, places
from lutgen.urdf.read import JOINT_KINDS, load_urdf, parse_urdf
from lutgen.urdf.shapes import TOUCHING, link_contacts, used_shapes
from lutgen.urdf.sources import Sources, load_xacro
from lutgen.urdf.srdf import Srdf, beyond_limits, joint_values, load_srdf, srdf_beside
from lutgen.urdf.xml import MAX_BYTES

__all__ = [
    "JOINT_KINDS",
    "MAX_BYTES",
    "TOUCHING",
    "TURN",
    "Collision",
    "Couple",
    "Motion",
    "Place",
    "Sources",
    "Srdf",
    "UrdfJoint",
    "UrdfLink",
    "UrdfRobot",
    "beyond_limits",
    "carried",
    "centre_of_mass",
    "downwards",
    "joint_values",
    "link_contacts",
    "links_of",
    "load_srdf",
    "load_urdf",
    "load_xacro",
    "parse_urdf",
    "places",
    "read_motion",
    "soft_limited",
    "srdf_beside",
    "used_shapes",
]

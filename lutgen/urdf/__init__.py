"""A robot description of ROS, read into links, joints and contacts.

In reading order: `xml`, `read`, `motion`, `links`, `contacts`, `groups`, `posture`,
`packages`, `xacro`.
"""

from lutgen.urdf.contacts import ROUND, link_contacts, used_shapes
from lutgen.urdf.links import Place, centre_of_mass, downwards, links_of, places
from lutgen.urdf.motion import TURN, Couple, Motion, read_motion
from lutgen.urdf.posture import Srdf, beyond_limits, joint_values, load_srdf, srdf_beside
from lutgen.urdf.read import MAX_BYTES, UrdfRobot, load_urdf, parse_urdf
from lutgen.urdf.xacro import load_xacro

__all__ = [
    "MAX_BYTES",
    "ROUND",
    "TURN",
    "Couple",
    "Motion",
    "Place",
    "Srdf",
    "UrdfRobot",
    "beyond_limits",
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
    "srdf_beside",
    "used_shapes",
]

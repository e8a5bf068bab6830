"""Read a robot description (URDF): links, inertials, collision shapes and joints.

Only the direct children of <robot> count: simulators nest elements of the same names in blocks of
their own.  Files that the description names, meshes above all, are not opened here.
"""

import math
import os
import re
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from xml.etree.ElementTree import Element

from lutgen import bounds
from lutgen.arrays import Vector
from lutgen.errors import suggestion
from lutgen.parts import ZERO, parents_first
from lutgen.urdf.description import Collision, Mimic, UrdfJoint, UrdfLink, UrdfRobot
from lutgen.urdf.xml import LARGEST, Elements, floats, parse_xml, parts_of_turns
from lutgen.vector import angles, from_quaternion

MAX_LINKS = bounds.LINKS.most
VERSIONS = ("1", "1.0", "1.1", "1.2")
JOINT_KINDS = ("fixed", "revolute", "continuous", "prismatic", "floating", "planar")
# Attributes of each shape, and how many numbers each has.
SHAPES = {
    "sphere": {"radius": 1},
    "cylinder": {"radius": 1, "length": 1},
    "capsule": {"radius": 1, "length": 1},
    "box": {"size": 3},
}
# Attributes and children of each element that are read, or that move neither masses nor contacts.
# Anything else is reported.
FORMAT = {
    "link": "name type inertial visual collision",
    "inertial": "origin mass inertia",
    "mass": "value",
    "origin": "xyz rpy quat_xyzw",
    "collision": "name origin geometry material verbose",
    "visual": "name origin geometry material",
    "geometry": "name sphere cylinder capsule box mesh",
    **{kind: " ".join(keys) for kind, keys in SHAPES.items()},
    "mesh": "filename scale",
    "joint": "name type origin parent child axis limit mimic dynamics calibration "
    "safety_controller",
    "parent": "link",
    "child": "link",
    "axis": "xyz",
    "limit": "lower upper effort velocity",
    "safety_controller": "soft_lower_limit soft_upper_limit k_position k_velocity",
    "mimic": "joint multiplier offset",
}


def load_urdf(path: str | os.PathLike[str]) -> UrdfRobot:
    """Read a URDF file of at most 16 MiB; a file with any fault raises RecipeError."""
    source = os.fspath(path)
    return parse_urdf(bounds.read(source, bounds.URDF_BYTES), source)


def parse_urdf(content: bytes | str, source: str = "<urdf>") -> UrdfRobot:
    """Check the text of a URDF; `source` is its name in messages.

    A text with any fault raises RecipeError.
    """
    # A lone surrogate becomes bytes that the parser refuses as no UTF-8.
    raw = content.encode(errors="surrogatepass") if isinstance(content, str) else content
    raw = bounds.short_enough(raw, source, bounds.URDF_BYTES)
    return _Reader(source).robot(parse_xml(raw, source))


class _Reader(Elements):
    """Reads a robot; every message names the file and the element."""

    def __init__(self, source: str) -> None:
        super().__init__(source)
        self.rounded: dict[str, None] = {}
        self.unknown: Counter[str] = Counter()

    def robot(self, root: Element) -> UrdfRobot:
        self.refuse_xacro(root)
        if root.tag != "robot":
            self.fail("root element", "is not <robot>", root.tag, "give a URDF file")
        version = root.get("version", VERSIONS[0])
        if version not in VERSIONS:
            way_out = f"use one of {', '.join(VERSIONS)}"
            self.fail("<robot>", "has a version that is not known", version, way_out)
        links = [self.link(element) for element in root.iterfind("link")]
        if not 1 <= len(links) <= MAX_LINKS:
            way_out = "describe the robot's links" if not links else "leave out what carries none"
            self.fail("<robot>", f"needs 1 to {MAX_LINKS} links", len(links), way_out)
        joints = [self.joint(element) for element in root.iterfind("joint")]
        self.unique("link", (link.name for link in links))
        self.unique("joint", (joint.name for joint in joints))
        top = self.tree([link.name for link in links], joints)
        self.mimics(joints)
        return UrdfRobot(
            self.name(root) if root.get("name", "").strip() else Path(self.source).stem,
            self.source,
            top,
            tuple(links),
            tuple(joints),
            dict(Counter(child.tag for child in root if child.tag not in ("link", "joint"))),
            tuple(self.rounded),
            dict(self.unknown),
        )

    def refuse_xacro(self, root: Element) -> None:
        """Refuse macros: elements of xacro, under any prefix, and expressions in values."""
        prefixes = {"xacro"}
        for element in root.iter():
            for key, value in element.items():
                if key.startswith("xmlns:") and value.rstrip("/").endswith("xacro"):
                    prefixes.add(key[6:])
            prefix, colon, _ = element.tag.partition(":")
            found = f"<{element.tag}>" if colon and prefix in prefixes else ""
            if element.attrib and element.tag in FORMAT:
                values = (value for value in element.attrib.values() if re.search(r"\$[({]", value))
                found = next(values, found)
            if found:
                way_out = "pass --xacro to `lutgen import` if you trust the file, which expands it"
                self.fail("<robot>", "is xacro that was not expanded", found, way_out)

    def check_known(self, element: Element, where: str) -> None:
        """Count what the format does not have; refuse a place that is written in another way."""
        known = FORMAT[element.tag].split()
        for key, value in element.items():
            if key not in known and key != "xmlns" and ":" not in key:
                if element.tag == "origin":
                    way_out = "write the turn as rpy or quat_xyzw"
                    self.fail(where, f"<origin> has an unknown attribute {key}", value, way_out)
                self.unknown[f"{key} of <{element.tag}>"] += 1
        for child in element:
            if child.tag not in known:
                self.unknown[f"<{child.tag}> in <{element.tag}>"] += 1
            elif child.tag in FORMAT:
                self.check_known(child, where)

    def link(self, element: Element) -> UrdfLink:
        name = self.name(element)
        where = f"link {name!r}"
        self.check_known(element, where)
        shapes = self.shapes(element, "collision", where)
        looks = () if shapes else self.shapes(element, "visual", where)
        inertial = self.only(element, "inertial", where)
        if element.find("inertial") is None:
            return UrdfLink(name, collisions=shapes, visuals=looks)
        mass = self.only(inertial, "mass", where)
        if inertial.find("mass") is None:
            way_out = "give it a mass or remove it"
            self.fail(where, "has an <inertial> without <mass>", "nothing", way_out)
        value = self.number(mass, "value", where)
        if value < 0.0:
            self.fail(where, "has a negative mass", value, "write a mass of 0 or more")
        return UrdfLink(name, value, self.placement(inertial, where)[0], shapes, looks)

    def shapes(self, element: Element, tag: str, where: str) -> tuple[Collision, ...]:
        return tuple(
            self.shape(part, where, i)
            for i, part in enumerate(element.iterfind(tag), 1)
            if tag == "collision" or part.find("geometry") is not None
        )

    def shape(self, element: Element, where: str, index: int) -> Collision:
        """Read a <collision> or <visual>; a geometry of another kind keeps its name only."""
        where = f"{where}, {element.tag} {index}"
        geometry = self.only(element, "geometry", where)
        shape = next(iter(geometry), Element("nothing"))
        kind, placed = shape.tag, self.placement(element, where)
        if kind == "mesh":
            # No number of a mesh that may not be needed is a reason to refuse the robot.
            file, scale = shape.get("filename", ""), floats(shape.get("scale", "1 1 1"))
            return Collision(kind, (), *placed, file, scale)
        size: tuple[float, ...] = ()
        for key, count in SHAPES.get(kind, {}).items():
            size += self.numbers(shape, key, where, count)
        if min(size, default=0.0) < 0.0:
            self.fail(where, f"has a {kind} of negative size", size, "write lengths of 0 or more")
        note = "" if size else f"a shape of kind {kind!r} is not understood"
        return Collision(kind, size, *placed, note=note)

    def joint(self, element: Element) -> UrdfJoint:
        name = self.name(element)
        where = f"joint {name!r}"
        self.check_known(element, where)
        kind = element.get("type", "")
        if kind not in JOINT_KINDS:
            self.fail(where, "has an unknown type", kind, suggestion(kind, JOINT_KINDS, "use"))
        ends = []
        for tag in ("parent", "child"):
            part = self.only(element, tag, where)
            if not part.get("link"):
                way_out = f"write <{tag} link='...'/>"
                self.fail(where, f"names no {tag} link", "nothing", way_out)
            ends.append(part.attrib["link"])
        axis = (1.0, 0.0, 0.0)
        if kind not in ("fixed", "floating"):
            x, y, z = self.vector(self.only(element, "axis", where), "xyz", where, axis)
            length = math.hypot(x, y, z)
            if not 0.0 < length < math.inf:
                way_out = "write for example 0 1 0"
                self.fail(where, "has an axis without direction", (x, y, z), way_out)
            axis = (x / length, y / length, z / length)
        mimic, limit = (self.only(element, tag, where) for tag in ("mimic", "limit"))
        follows = Mimic(
            mimic.get("joint", ""),
            self.number(mimic, "multiplier", where, 1.0),
            self.number(mimic, "offset", where, 0.0),
        )
        effort = floats(limit.get("effort", ""))
        return UrdfJoint(
            *(name, kind, ends[0], ends[1]),
            *self.placement(element, where),
            axis,
            *self.limits(limit, kind, where),
            follows if element.find("mimic") is not None else None,
            effort[0] if effort else None,
            self.soft(element, where),
        )

    def limits(self, limit: Element, kind: str, where: str) -> tuple[float, float]:
        """Return the limits of a joint, or infinite ones.

        URDF's own default of a missing `lower` or `upper` is 0; a <limit> with neither sets effort
        and velocity alone.
        """
        limited = kind in ("revolute", "prismatic") and {"lower", "upper"} & limit.attrib.keys()
        if not limited:
            return -math.inf, math.inf
        lower = self.number(limit, "lower", where, 0.0, math.inf)
        upper = self.number(limit, "upper", where, 0.0, math.inf)
        if lower > upper:
            self.fail(where, "has a lower limit above the upper", (lower, upper), "swap them")
        if lower > LARGEST or upper < -LARGEST:
            self.fail(where, "has limits far from zero", (lower, upper), "correct them")
        # Writers without infinity use 1e16.
        lower = -math.inf if lower < -LARGEST else lower
        return lower, math.inf if upper > LARGEST else upper

    def soft(self, element: Element, where: str) -> tuple[float, float] | None:
        """Return the soft limits of a joint, or None; an empty range is None."""
        safety = self.only(element, "safety_controller", where)
        lower = self.number(safety, "soft_lower_limit", where, 0.0)
        upper = self.number(safety, "soft_upper_limit", where, 0.0)
        return (lower, upper) if lower < upper else None

    def placement(self, element: Element, where: str) -> tuple[Vector, Vector]:
        """Return xyz and rpy of the <origin> of an element, or zeros."""
        origin = self.only(element, "origin", where)
        xyz = self.vector(origin, "xyz", where, ZERO)
        if (quat := origin.get("quat_xyzw")) is not None:
            values = floats(quat)
            length = math.hypot(*values)
            if "rpy" in origin.attrib or len(values) != 4 or not 0.0 < length <= LARGEST:
                way_out = "write a quaternion of four numbers, and no rpy beside it"
                self.fail(where, "<origin> has no turn as quat_xyzw", quat, way_out)
            return xyz, angles(from_quaternion(*values))
        rpy = self.vector(origin, "rpy", where, ZERO)
        if any(rpy):
            rpy, taken = parts_of_turns(origin.attrib["rpy"])
            self.rounded |= dict.fromkeys(taken)
        return xyz, rpy

    def unique(self, what: str, names: Iterable[str]) -> None:
        for name, count in Counter(names).items():
            if count > 1:
                self.fail(f"{what} {name!r}", "is given more than once", count, "rename one")

    def tree(self, names: list[str], joints: list[UrdfJoint]) -> str:
        """Return the root of the tree; refuse unknown links, two parents, loops and two roots."""
        known = set(names)
        parents: dict[str, str] = {}
        for joint in joints:
            where = f"joint {joint.name!r}"
            for tag, name in (("parent", joint.parent), ("child", joint.child)):
                if name not in known:
                    way_out = suggestion(name, names[:100], "use one of")
                    self.fail(where, f"{tag} is no link of the robot", name, way_out)
            if joint.child in parents:
                got = [parents[joint.child], joint.parent]
                self.fail(f"link {joint.child!r}", "has two parents", got, "remove one joint")
            parents[joint.child] = joint.parent
        _, loop = parents_first({name: parents.get(name) for name in names})
        if loop:
            self.fail(f"link {loop[-1]!r}", "is its own ancestor", loop[:-1], "remove one joint")
        roots = [name for name in names if name not in parents]
        if len(roots) > 1:
            way_out = "connect them with joints"
            self.fail("<robot>", f"has {len(roots)} links without a parent", roots, way_out)
        return roots[0]

    def mimics(self, joints: list[UrdfJoint]) -> None:
        """Refuse a mimic of an unknown joint, and joints that mimic each other in a circle."""
        follows = {joint.name: joint.mimic.joint if joint.mimic else None for joint in joints}
        for name, master in follows.items():
            if master is not None and master not in follows:
                way_out = suggestion(master, list(follows)[:100], "use one of")
                self.fail(f"joint {name!r}", "mimics what is no joint", master, way_out)
        _, loop = parents_first(follows)
        if loop:
            self.fail(f"joint {loop[-1]!r}", "mimics itself", loop[:-1], "remove one mimic")

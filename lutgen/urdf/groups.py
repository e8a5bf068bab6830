"""Groups of joints that an SRDF file names.

Owns which joints a group has: those that it lists, those of its chains and links, and those of
the groups in it.  What groups are good for is not known here.
"""

from collections.abc import Iterator, Mapping
from xml.etree.ElementTree import Element

from lutgen.urdf.description import UrdfJoint, UrdfRobot


def joint_groups(root: Element, robot: UrdfRobot) -> dict[str, tuple[str, ...]]:
    """Return the moving joints of each ``<group>``, in order of the description.

    Parameters
    ----------
    root : Element
        The <robot> of an SRDF file.
    robot : UrdfRobot
        The description; what it does not have is not in a group, such as a floating base.

    Returns
    -------
    dict of str to tuple of str
        A group may have none.
    """
    parts: dict[str, list[Element]] = {}
    for group in root.iterfind("group"):
        if name := group.get("name", "").strip():
            parts.setdefault(name, []).extend(group)
    above = {joint.child: joint for joint in robot.joints}
    moving = [joint.name for joint in robot.joints if joint.kind != "fixed"]
    result = {}
    for name in parts:
        # A group of groups; one that is met twice adds nothing.
        wanted, open_, seen = set[str](), [name], {name}
        while open_:
            for part in parts.get(open_.pop(), ()):
                inner = part.get("name", "")
                if part.tag == "group" and inner not in seen:
                    seen.add(inner)
                    open_.append(inner)
                wanted.update(_joints(part, above))
        result[name] = tuple(joint for joint in moving if joint in wanted)
    return result


def _joints(part: Element, above: Mapping[str, UrdfJoint]) -> Iterator[str]:
    """Yield the joints of one element of a group; `above` has the joint that carries each link."""
    if part.tag == "joint":
        yield part.get("name", "")
    elif part.tag == "link" and (joint := above.get(part.get("name", ""))):
        yield joint.name
    elif part.tag == "chain":
        base, here = part.get("base_link", ""), part.get("tip_link", "")
        way = []
        while here != base and here in above:
            way.append(above[here].name)
            here = above[here].parent
        # Both ends belong to one branch, or the chain is none.
        if here == base:
            yield from way

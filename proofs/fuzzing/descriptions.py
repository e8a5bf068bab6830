"""URDFs with hostile joints, meshes, numbers and entities, with damaged meshes and SRDFs."""

import copy
import random
import struct
from xml.etree import ElementTree

from proofs.fuzzing import hostile
from proofs.fuzzing.case import Case
from proofs.fuzzing.hostile import pick
from proofs.fuzzing.seeds import DESCRIPTIONS, MESH, POSTURES

__all__ = ["make"]

INPUT = frozenset((0, 2))
TAGS = ("joint", "link", "inertial", "collision", "mimic", "mesh", "geometry", "robot", "axis", "a")
KINDS = ("revolute", "fixed", "continuous", "prismatic", "floating", "planar", "ball", "")
MESHES = (
    "../../etc/passwd",
    "/dev/zero",
    "package://x/y.stl",
    "http://x/y.stl",
    "r.urdf",
    "",
    "a.dae",
)
ENTITIES = (
    '<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa">'
    + "".join(f'<!ENTITY {chr(98 + i)} "{f"&{chr(97 + i)};" * 10}">' for i in range(9))
    + "]>",
    '<!DOCTYPE r [<!ENTITY j SYSTEM "file:///etc/passwd">]>',
    '<!DOCTYPE r SYSTEM "http://127.0.0.1:1/x.dtd">',
)


def _change(rng: random.Random, root: ElementTree.Element) -> str:
    everything = list(root.iter())
    parents = {child: parent for parent in everything for child in parent}
    node = pick(rng, everything)
    how = pick(
        rng, ("value", "value", "value", "name", "kind", "drop", "copy", "move", "tag", "many")
    )
    with_values = [e for e in everything if e.attrib]
    if how in ("value", "name") and with_values:
        node = pick(rng, with_values)
        key = pick(rng, list(node.attrib))
        if how == "name":
            other = pick(rng, with_values)
            there = pick(rng, list(other.attrib.values()))
            node.attrib[key] = pick(rng, (there, there, *hostile.NAMES, *MESHES))
        else:
            parts = node.attrib[key].split() or ["0"]
            parts[rng.randrange(len(parts))] = hostile.text_number(rng)
            if rng.random() < 0.15:
                parts = parts * pick(rng, (0, 2, 5000))
            node.attrib[key] = " ".join(parts)
        if rng.random() < 0.1:
            del node.attrib[key]
    elif how == "kind":
        joints = root.findall("joint")
        if joints:
            pick(rng, joints).set("type", pick(rng, KINDS))
    elif how == "drop" and node in parents:
        parents[node].remove(node)
    elif how == "copy" and node in parents:
        pick(rng, everything).append(copy.deepcopy(node))
    elif how == "move" and node in parents:
        target = pick(rng, everything)
        if target not in set(node.iter()):
            parents[node].remove(node)
            target.append(node)
    elif how == "tag":
        node.tag = pick(rng, TAGS)
    elif how == "many":
        _chain(rng, root)
    return str(how)


def _chain(rng: random.Random, root: ElementTree.Element) -> None:
    """Hang a long chain of links on the root, now and then closed to a ring."""
    first = root.find("link")
    last = "" if first is None else first.get("name", "")
    for i in range(pick(rng, (2, 30, 400, 3000))):
        ElementTree.SubElement(root, "link", name=f"chain{i}")
        joint = ElementTree.SubElement(root, "joint", name=f"j{i}", type=pick(rng, KINDS[:4]))
        ElementTree.SubElement(joint, "parent", link=last)
        ElementTree.SubElement(joint, "child", link=f"chain{i}")
        last = f"chain{i}"
    if rng.random() < 0.3:
        joint = ElementTree.SubElement(root, "joint", name="ring", type="fixed")
        ElementTree.SubElement(joint, "parent", link=last)
        ElementTree.SubElement(joint, "child", link="chain0")


def _deep(rng: random.Random) -> bytes:
    depth = int(pick(rng, (100, 5_000, 200_000)))
    return b'<robot name="d">' + b"<link>" * depth + b"</link>" * depth + b"</robot>"


def _mesh(rng: random.Random) -> bytes:
    if rng.random() < 0.3:  # it claims more triangles than it has
        return MESH[:80] + struct.pack("<I", pick(rng, (0, 5, 10**6, 2**31, 2**32 - 1))) + MESH[84:]
    if rng.random() < 0.3:
        numbers = [float(hostile.pick(rng, (0, 1e38, "nan", "inf", 1e-40, -1))) for _ in range(12)]
        return MESH[:84] + struct.pack("<12fH", *numbers, 0) + MESH[134:]
    return hostile.damaged(rng, MESH)


def _written(rng: random.Random, root: ElementTree.Element) -> bytes:
    text = ElementTree.tostring(root, encoding="unicode")
    if rng.random() < 0.04:
        text = pick(rng, ENTITIES) + text.replace("</link>", f"&{pick(rng, 'acfj')};</link>", 1)
    data = text.encode("utf-8", "replace")
    if rng.random() < 0.03:
        encoding = pick(rng, ("utf-16", "utf-32", "latin-1"))
        data = text.encode(str(encoding), "replace")
    return hostile.damaged(rng, data) if rng.random() < 0.08 else data


def make(rng: random.Random) -> Case:
    """Return a case: an import, and a check of the recipe that it wrote."""
    name = pick(rng, list(DESCRIPTIONS))
    root = ElementTree.fromstring(DESCRIPTIONS[name])
    done = [_change(rng, root) for _ in range(rng.randrange(1, 4))]
    files = {"r.urdf": _written(rng, root), "mast.stl": MESH}
    words = ["import", "r.urdf", "-o", "out.toml"]
    if rng.random() < 0.01:
        files["r.urdf"], done = _deep(rng), ["deep"]
    if rng.random() < 0.15:
        files["mast.stl"], done = _mesh(rng), [*done, "mesh"]
    if rng.random() < 0.15:
        files["r.srdf"] = hostile.damaged(rng, POSTURES) if rng.random() < 0.7 else POSTURES
        done.append("srdf")
    if rng.random() < 0.3:
        joints = [joint.get("name", "") for joint in root.iter("joint")] or ["none"]
        words += ["-j", pick(rng, joints)]
    if rng.random() < 0.05:
        words += ["--name", pick(rng, hostile.NAMES).replace("\x00", "0")]
    label = f"{name}: {' '.join(done)}"
    then = (("check", "out.toml", "--json"),)
    return Case(label, files, tuple(words), INPUT, ("out.toml",), then)

"""Joints of a robot description that do the same on other sides of it: four hips, two knees.

They are alike by name and by place, and one may turn as the mirror image of another.  Left and
right mirror each other in the plane of x and z; front and rear if the robot stands so (knees
pointing at each other), else they move alike.
"""

import math
import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from lutgen.arrays import Floats
from lutgen.parts import Contact
from lutgen.propose.contacts import hanging, placed
from lutgen.urdf.description import UrdfRobot
from lutgen.urdf.links import Place, carried, downwards

# Shares of the robot's size: within the first two joints are on one side, within the second one is
# where the mirror image of the other is.  Masses of mirror images differ by a tenth at most, and
# the cosine between their axes is at least this: descriptions round, and robots have a battery.
BESIDE, IMAGE, MASS, PARALLEL = 0.01, 0.05, 0.1, 0.9

# Parts of a name that say where a joint is and not what it is.
SIDES = {
    *("left", "right", "l", "r", "middle", "mid", "ml", "mr", "lm", "rm", "front", "fore", "f"),
    *("fl", "fr", "lf", "rf", "rear", "hind", "back", "h", "rl", "rr", "lr", "lh", "rh", "hl"),
    *("hr", "bl", "br", "lb", "rb"),
}
WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")


class Limb(NamedTuple):
    """A limb, which hangs from a joint: how it moves and where it is, frame of the root.

    `axis` (3,) and `spot` (3,), the middle of its contacts or else its com, are those with all
    joints at zero; `reach` (3,) leads from the joint to the spot in the standing posture.
    """

    slides: bool
    axis: Floats
    spot: Floats
    reach: Floats
    mass: float
    above: frozenset[str]


class Limbs:
    """The limbs of a robot, by its links' places with joints at zero and standing (`rest`)."""

    def __init__(
        self,
        robot: UrdfRobot,
        contacts: Sequence[Contact],
        zero: Mapping[str, Place],
        rest: Mapping[str, Place],
    ) -> None:
        spots, masses = _spots(robot, contacts, zero)
        standing, _ = _spots(robot, contacts, rest)
        above: dict[str, frozenset[str]] = {robot.root: frozenset()}
        self.limbs: dict[str, Limb] = {}
        for joint in downwards(robot):
            child = joint.child
            above[child] = above[joint.parent] | {joint.name}
            self.limbs[joint.name] = Limb(
                joint.kind == "prismatic",
                zero[child][0] @ joint.axis,
                spots[child],
                standing[child] - rest[child][1],
                masses[child],
                above[child],
            )
        places = np.array([limb.spot for limb in self.limbs.values()] or [np.zeros(3)])
        self.size = float(np.ptp(places, axis=0).max())
        self.folded = False

    def families(self, names: Sequence[str]) -> list[dict[str, float]]:
        """Return joints that one parameter can drive, with the sign of each.

        Each of the names is in one of them, many alone; in the order of the first of each.
        """
        found = self._alike(names)
        self.folded = self._is_folded(found)
        result = [family for members in found for family in self._signed(members)]
        place = {name: i for i, name in enumerate(names)}
        return sorted(result, key=lambda family: place[next(iter(family))])

    def sign(self, first: str, other: str) -> float:
        """Return 1 or -1, as the axis of a joint is that of the other's image; 0 for neither."""
        a, b = self.limbs[first], self.limbs[other]
        if a.slides != b.slides:
            return 0.0
        mirror = self._mirror(a, b)
        # An axis of rotation is the direction of a screw: its image points the other way.
        image = mirror * a.axis * (1.0 if a.slides else np.prod(mirror))
        along = float(image @ b.axis)
        return math.copysign(1.0, along) if abs(along) >= PARALLEL else 0.0

    def _mirror(self, a: Limb, b: Limb) -> Floats:
        apart = np.abs(a.spot - b.spot) > BESIDE * self.size
        # On one line across the robot they are images of each other, wherever its middle is.
        along = -1.0 if self.folded and apart[0] else 1.0
        return np.array([along, -1.0 if apart[1] and a.spot[1] * b.spot[1] < 0.0 else 1.0, 1.0])

    def _alike(self, names: Sequence[str]) -> list[list[str]]:
        """Return sets of joints that have one name but for the side, or for numbers of limbs."""
        stems: dict[tuple[str, ...], list[str]] = {}
        for name in names:
            stems.setdefault(stem(name), []).append(name)
        result = [members for members in stems.values() if len(members) > 1]
        numbered: dict[tuple[str, ...], list[str]] = {}
        for words, members in stems.items():
            if len(members) == 1:
                masked = tuple("#" if word.isdigit() else word for word in words)
                numbered.setdefault(masked, []).extend(members)
        for members in numbered.values():
            while members:
                result.append(self._images(members))
                members = [name for name in members if name not in result[-1]]
        return result

    def _images(self, names: Sequence[str]) -> list[str]:
        first = self.limbs[names[0]]
        result = [names[0]]
        spots = np.array([self.limbs[name].spot for name in names])
        middle = float(np.mean(spots[:, 0]))
        for mirror in ((1.0, -1.0, 1.0), (-1.0, 1.0, 1.0), (-1.0, -1.0, 1.0)):
            image = np.array(mirror) * (first.spot - [middle, 0.0, 0.0]) + [middle, 0.0, 0.0]
            away = np.linalg.norm(spots - image, axis=1)
            near = np.flatnonzero(away <= IMAGE * self.size).tolist()
            for _, name in sorted((float(away[i]), names[i]) for i in near):
                if (
                    name not in result
                    and abs(self.limbs[name].mass - first.mass) <= MASS * first.mass
                    and self.sign(names[0], name)
                ):
                    result.append(name)
                    break
        return result

    def _is_folded(self, sets: Sequence[Sequence[str]]) -> bool:
        """Return True if rear limbs stand as mirror images of front ones, not like these."""
        alike = mirrored = 0.0
        count = 0
        for members in sets:
            a = self.limbs[members[0]]
            for b in (self.limbs[name] for name in members[1:]):
                if abs(a.spot[0] - b.spot[0]) > BESIDE * self.size:
                    count += 1
                    image = self._mirror(a, b) * a.reach
                    alike += float(np.linalg.norm(b.reach - image))
                    image[0] = -image[0]
                    mirrored += float(np.linalg.norm(b.reach - image))
        # Straight legs are both; then the middle of the feet stays where it is.
        return mirrored <= alike + BESIDE * self.size * count

    def _signed(self, members: Sequence[str]) -> list[dict[str, float]]:
        """Return joints of one name as families: none hangs from another, all are apart."""
        left = list(members)
        result = []
        while left:
            family = {left[0]: 1.0}
            for name in left[1:]:
                limb = self.limbs[name]
                sign = self.sign(left[0], name)
                others = [self.limbs[other] for other in family]
                apart = all(
                    np.abs(limb.spot - other.spot)[:2].max() > BESIDE * self.size
                    for other in others
                )
                tied = any(name in other.above for other in others) or limb.above & {*family}
                if sign and apart and not tied:
                    family[name] = sign
            result.append(family)
            left = [name for name in left if name not in family]
        return result


def _spots(
    robot: UrdfRobot, contacts: Sequence[Contact], where: Mapping[str, Place]
) -> tuple[dict[str, Floats], dict[str, float]]:
    """Return for each link the middle of what hangs from it, and its mass.

    The middle of the contacts, without any the com, without masses the link's origin.
    """
    mass, moment = carried(robot, where)
    centre = placed(contacts, where)[0]
    spots = {
        name: moment[name] / mass[name] if mass[name] > 0.0 else where[name][1] for name in mass
    }
    for name, inside in hanging(robot, contacts).items():
        if inside:
            spots[name] = centre[inside].mean(axis=0)
    return spots, mass


def stem(name: str) -> tuple[str, ...]:
    """Return what a joint's name says beside the side that it is on, in lower case.

    Examples
    --------
    >>> stem("FL_hip_joint") == stem("rear_right_hip")
    True
    >>> stem("LHipYawPitch"), stem("leg_left_1_joint"), stem("left")
    (('hip', 'yaw', 'pitch'), ('leg', '1'), ())
    >>> stem("LF_KFE") == stem("rh_kfe_joint") == ("kfe",)
    True
    """
    words = [word.lower() for word in WORD.findall(name)]
    return tuple(word for word in words if word not in SIDES and word != "joint")


def common_name(names: Sequence[str]) -> str:
    """Return a name for joints that are alike: the words that all of them have.

    Examples
    --------
    >>> common_name(["FL_hip_joint", "FR_hip_joint"])
    'hip'
    >>> common_name(["j_arm1_3", "j_arm2_3"]), common_name(["left", "right"])
    ('j_arm_3', 'left')
    """
    own = [word for word in WORD.findall(names[0]) if word.lower() in stem(word)]
    words = [
        shown
        for shown, *same in zip(own, *(stem(name) for name in names), strict=False)
        if len(set(same)) == 1
    ]
    return "_".join(words) or names[0]

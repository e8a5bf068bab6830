"""What `--couple` says: which joints one parameter drives, or among which a grouping is proposed.

Owns how that is written.  Which joints are alike is not known here (`symmetry`), nor which matter.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase

from lutgen.errors import InputError, suggestion
from lutgen.propose.symmetry import Limbs
from lutgen.recipe.robot import RESERVED
from lutgen.recipe.robot_keys import IDENTIFIER
from lutgen.urdf import Couple, Motion, UrdfRobot

AUTO = "auto"
# A sign or a factor before a joint, a group or a pattern.
FACTOR = re.compile(r"([+-]?)(?:(\d+\.?\d*|\.\d+)\*)?(.+)")
FORMS = "write NAME=JOINT,JOINT,..., a group of the SRDF file, a pattern such as '*_hip', or auto"


@dataclass(frozen=True)
class Coupling:
    """Texts of `--couple`, and the groups of joints that the SRDF file names."""

    texts: tuple[str, ...] = ()
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


class Reader:
    """Reads the texts for one robot.

    Parameters
    ----------
    robot : UrdfRobot
        The description.
    motion : Motion
        All joints that can be free, each one by itself, and where they are at rest.
    limbs : Limbs
        By which the signs of joints are found that a pattern or group has.
    coupling : Coupling
        The texts; a fault raises InputError.
    """

    def __init__(self, robot: UrdfRobot, motion: Motion, limbs: Limbs, coupling: Coupling) -> None:
        self.robot, self.motion, self.limbs = robot, motion, limbs
        self.groups = coupling.groups
        self.texts = coupling.texts

    def couples(self) -> list[Couple]:
        """Return the joints of each NAME=...; at rest they stand where they do without it."""
        result: list[Couple] = []
        for text in self.texts:
            name, equals, items = text.partition("=")
            if not equals:
                continue
            if not re.fullmatch(IDENTIFIER, name) or name in RESERVED:
                raise InputError(
                    f"--couple: is no name of a parameter (got {name!r}); use letters, digits and "
                    "_, a letter first, and none that a map file uses."
                )
            scales = self._scales(text, items.split(","))
            if any(name == couple.name for couple in result):
                raise InputError(f"--couple: the name is given twice (got {text!r}); rename one.")
            result.append(at_rest(name, scales, self.motion, "as --couple says"))
        return result

    def among(self) -> list[list[str]]:
        """Return the joints of each text that is no NAME=..., among which to propose."""
        result = []
        for text in self.texts:
            if "=" not in text:
                found = [*self.motion.free] if text == AUTO else self._matches(text)
                if not found:
                    known = [AUTO, *self.groups]
                    raise InputError(
                        f"--couple: names no joints that can move (got {text!r}); "
                        f"{suggestion(text, known, FORMS + '; there are')}."
                    )
                result.append(found)
        return result

    def _scales(self, text: str, items: Sequence[str]) -> dict[str, float]:
        """Return the factor of each joint of a NAME=..."""
        result: dict[str, float] = {}
        for item in items:
            for joint, scale in self._item(text, item.strip(), result).items():
                if joint in result:
                    raise InputError(
                        f"--couple: joint {joint!r} is named twice (got {text!r}); remove one."
                    )
                result[joint] = scale
        return result

    def _item(self, text: str, item: str, before: Mapping[str, float]) -> dict[str, float]:
        """Return the factors of one joint, group or pattern."""
        joints = [joint.name for joint in self.robot.joints]
        if item in joints:
            return {item: 1.0}
        match = FACTOR.fullmatch(item)
        sign, number, name = match.groups() if match else ("", None, item)
        factor = float(f"{sign}{number or 1.0}")
        if factor == 0.0:
            raise InputError(f"--couple: a factor is 0 (got {item!r}); leave the joint out.")
        if name in joints:
            return {name: factor}
        found = self._matches(name)
        if not found:
            known = [*joints, *self.groups]
            raise InputError(
                f"--couple: there is no such joint or group, and no joint has that pattern (got "
                f"{item!r} in {text!r}); {suggestion(name, known, 'use one of')}."
            )
        if sign or number:
            return dict.fromkeys(found, factor)
        first, scale = next(iter(before.items()), (found[0], 1.0))
        signs = {joint: self.limbs.sign(first, joint) for joint in found}
        for joint, of_axis in signs.items():
            if not of_axis:
                raise InputError(
                    f"--couple: the axes of {first!r} and {joint!r} are no mirror images, so no "
                    f"sign follows (got {item!r}); write +{item}, or joint by joint."
                )
        return {joint: scale * of_axis for joint, of_axis in signs.items()}

    def _matches(self, text: str) -> list[str]:
        """Return the joints of a group or pattern that can be free; others follow or are held."""
        group = self.groups.get(text)
        return [
            name
            for name in self.motion.free
            if (name in group if group is not None else fnmatchcase(name, text))
        ]


def at_rest(name: str, scales: Mapping[str, float], motion: Motion, why: str) -> Couple:
    """Return a couple whose joints stand where they do at rest when its parameter does.

    The parameter is 0 where the first joint is.
    """
    first, scale = next(iter(scales.items()))
    value = motion.rest.get(first, 0.0) / scale
    offsets = {
        joint: 0.0 if joint == first else motion.rest.get(joint, 0.0) - factor * value
        for joint, factor in scales.items()
    }
    return Couple(name, {joint: (scales[joint], offsets[joint]) for joint in scales}, why)

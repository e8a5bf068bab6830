"""Choose which joints become parameters, and which of them one parameter drives."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase

from lutgen.errors import InputError, reject, suggestion
from lutgen.parts import Contact
from lutgen.propose.contacts import effects, robot_size
from lutgen.propose.symmetry import Limbs, common_name
from lutgen.recipe.rules import RESERVED
from lutgen.recipe.schema import IDENTIFIER
from lutgen.urdf.description import UrdfRobot
from lutgen.urdf.joints import TURN, Couple, Motion, read_motion
from lutgen.urdf.links import places

AUTO = "auto"
# A sign or a factor before a joint, a group or a pattern.
FACTOR = re.compile(r"([+-]?)(?:(\d+\.?\d*|\.\d+)\*)?(.+)")
FORMS = "write NAME=JOINT,JOINT,..., a group of the SRDF file, a pattern such as '*_hip', or auto"
# More joints than this are not proposed one by one, and more parameters than that are not where
# joints are coupled: three nodes of each make a map of 729 postures.
MAX_JOINTS, MAX_PARAMETERS = 10, 6
# Shares of the robot's size.  A contact that moves less does not move: descriptions round their
# angles (1.570795 for a right angle).  A joint that moves the com less, and no contact, is held:
# each parameter makes the map several times larger.
STILL, SLIGHT = 1e-5, 5e-3
ALIKE = "alike by name, and mirror images of each other or the same"


@dataclass(frozen=True)
class Coupling:
    """Texts of `--couple`, and the groups of joints that the SRDF file names."""

    texts: tuple[str, ...] = ()
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


def chosen_motion(
    robot: UrdfRobot,
    contacts: Sequence[Contact],
    joints: Sequence[str] | None = None,
    posture: Mapping[str, float] | None = None,
    coupling: Coupling | None = None,
) -> tuple[Motion, str]:
    """Return which joints are parameters or share one, and why any are coupled unasked.

    `joints` become parameters each by itself; `coupling` says what is coupled, or among which
    joints a grouping is proposed.  Without both: all that matter, coupled if more than 10.
    """
    coupling = coupling or Coupling()
    if joints is not None and not coupling.texts:
        return read_motion(robot, joints, posture), ""
    free = read_motion(robot, None, posture)
    rest = places(robot, free)
    matter, why = _mattering(robot, free, contacts, robot_size(contacts, rest))
    if not coupling.texts and len(matter) <= MAX_JOINTS:
        result = read_motion(robot, matter, posture)
        result.held.update(why)
        return result, ""
    limbs = Limbs(robot, contacts, places(robot, read_motion(robot)), rest)
    reader = _Reader(robot, free, limbs, coupling)
    couples = reader.couples()
    taken = set(joints or ())
    for couple in couples:
        for name in couple.joints:
            if name in taken:
                what = f"joint {name!r} is given twice"
                reject("--couple", what, f"it in {couple.name!r} too", "remove it once", InputError)
        taken.update(couple.joints)
    proposed: list[Couple] = []
    for names in reader.among() if coupling.texts else [[*free.free]]:
        found = _proposed(free, limbs, [name for name in names if name not in taken])
        # Both of two arms, also where one of them matters a little less.
        found = [couple for couple in found if not {*couple.joints} <= {*why}]
        taken.update(name for couple in found for name in couple.joints)
        proposed += found
    # If there are more than six, those are kept that move contacts or com most.
    apart = read_motion(robot, (), posture, proposed)
    most = {name: max(ways) for name, ways in effects(robot, apart, contacts).items()}
    ranked = sorted(proposed, key=lambda couple: -most[couple.first])
    least = [name for couple in ranked[MAX_PARAMETERS:] for name in couple.joints]
    proposed = [couple for couple in proposed if couple.first not in least]
    alone = [couple.first for couple in proposed if len(couple.joints) == 1]
    couples += [couple for couple in proposed if len(couple.joints) > 1]
    result = read_motion(robot, [*(joints or ()), *alone], posture, couples)
    said = {**why, **dict.fromkeys(least, "changes less than those that are parameters")}
    result.held.update({name: words for name, words in said.items() if name in result.held})
    return result, "" if coupling.texts else f"{len(matter)} joints move contacts or com"


def _mattering(
    robot: UrdfRobot, motion: Motion, contacts: Sequence[Contact], size: float
) -> tuple[list[str], dict[str, str]]:
    """Return the joints that matter, and of the others why they do not."""
    matter, why = [], {}
    for name, (way, com) in effects(robot, motion, contacts).items():
        if way > STILL * size or com > SLIGHT * size:
            matter.append(name)
        elif com > STILL * size:
            why[name] = f"moves no contact and the com by at most {1000.0 * com:.2g} mm"
        else:
            why[name] = "moves neither contacts nor com"
    return matter, why


def _proposed(free: Motion, limbs: Limbs, names: Sequence[str]) -> list[Couple]:
    """Return the joints that are alike as couples, others as couples of one."""
    result = []
    for family in limbs.families(names):
        while family:
            # A joint whose limits leave the others too little is left out.
            members: dict[str, float] = {}
            for name, sign in family.items():
                wider = {**members, name: sign}
                if len(wider) == 1 or _has_room(free, wider):
                    members = wider
            sign = next(iter(members.values()))
            scales = {name: own * sign for name, own in members.items()}
            result.append(_at_rest(common_name([*members]), scales, free, ALIKE))
            family = {name: sign for name, sign in family.items() if name not in members}
    return result


def _has_room(free: Motion, scales: Mapping[str, float]) -> bool:
    couple = _at_rest("", scales, free, "")
    low, high, least = -TURN, TURN, TURN
    for name, (scale, offset) in couple.joints.items():
        first, last = free.free[name]
        least = min(least, last - first)
        if last - first < TURN:
            ends = sorted([(first - offset) / scale, (last - offset) / scale])
            low, high = max(low, ends[0]), min(high, ends[1])
    return high - low >= 0.5 * least


def _at_rest(name: str, scales: Mapping[str, float], motion: Motion, why: str) -> Couple:
    """Return a couple whose joints stand at rest when its parameter does, 0 with the first."""
    first, scale = next(iter(scales.items()))
    value = motion.rest.get(first, 0.0) / scale
    offsets = {
        joint: 0.0 if joint == first else motion.rest.get(joint, 0.0) - factor * value
        for joint, factor in scales.items()
    }
    return Couple(name, {joint: (scales[joint], offsets[joint]) for joint in scales}, why)


class _Reader:
    """Reads the texts of `--couple`; a fault raises InputError.

    `motion` has all joints that can be free, each by itself; `limbs` know their signs.
    """

    def __init__(self, robot: UrdfRobot, motion: Motion, limbs: Limbs, coupling: Coupling) -> None:
        self.joints = [joint.name for joint in robot.joints]
        self.motion, self.limbs, self.coupling = motion, limbs, coupling

    def couples(self) -> list[Couple]:
        """Return the joints of each NAME=...; at rest they stand where they do without it."""
        result: list[Couple] = []
        for text in self.coupling.texts:
            name, equals, items = text.partition("=")
            if not equals:
                continue
            if not re.fullmatch(IDENTIFIER, name) or name in RESERVED:
                what = "is no name of a parameter"
                way_out = "use letters, digits and _, a letter first, and none that a map file uses"
                reject("--couple", what, f"{name!r}", way_out, InputError)
            scales: dict[str, float] = {}
            for item in items.split(","):
                for joint, scale in self.item(text, item.strip(), scales).items():
                    if joint in scales:
                        what = f"joint {joint!r} is named twice"
                        reject("--couple", what, f"{text!r}", "remove one", InputError)
                    scales[joint] = scale
            if any(name == couple.name for couple in result):
                raise InputError(f"--couple: the name is given twice (got {text!r}); rename one.")
            result.append(_at_rest(name, scales, self.motion, "as --couple says"))
        return result

    def among(self) -> list[list[str]]:
        """Return the joints of each text that is no NAME=..., among which to propose."""
        result = []
        for text in self.coupling.texts:
            if "=" not in text:
                found = [*self.motion.free] if text == AUTO else self.matches(text)
                if not found:
                    known = [AUTO, *self.coupling.groups]
                    got, way_out = f"{text!r}", suggestion(text, known, FORMS + "; there are")
                    reject("--couple", "names no joints that can move", got, way_out, InputError)
                result.append(found)
        return result

    def item(self, text: str, item: str, before: Mapping[str, float]) -> dict[str, float]:
        if item in self.joints:
            return {item: 1.0}
        match = FACTOR.fullmatch(item)
        sign, number, name = match.groups() if match else ("", None, item)
        factor = float(f"{sign}{number or 1.0}")
        if factor == 0.0:
            raise InputError(f"--couple: a factor is 0 (got {item!r}); leave the joint out.")
        if name in self.joints:
            return {name: factor}
        found = self.matches(name)
        if not found:
            known = [*self.joints, *self.coupling.groups]
            what = "there is no such joint or group, and no joint has that pattern"
            got = f"{item!r} in {text!r}"
            reject("--couple", what, got, suggestion(name, known, "use one of"), InputError)
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

    def matches(self, text: str) -> list[str]:
        """Return the joints of a group or pattern that can be free; others follow or are held."""
        group = self.coupling.groups.get(text)
        names = self.motion.free
        return [n for n in names if (fnmatchcase(n, text) if group is None else n in group)]

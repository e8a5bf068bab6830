"""Robots that do not stand on the ground: arms and hands that are bolted to something.

Owns how they are told from robots that stand; asked only where nobody said what touches the ground.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from lutgen.errors import RecipeError
from lutgen.parts import Contact
from lutgen.propose.candidates import is_above, near_ground, placed
from lutgen.urdf import Motion, Place, UrdfRobot, centre_of_mass, downwards, places

# Postures that are tried, and how many of them a robot on a foot that is part of its root may tip
# in: of 400 a robot on a pedestal (baxter) tips in none, arms on their flanges (so100, so101) in 17
# and 66 %.
TRIED, MAY_TIP = 64, 3


def refuse_bolted(
    robot: UrdfRobot,
    motion: Motion,
    contacts: Sequence[Contact],
    where: Mapping[str, Place],
    guessed: bool,
) -> None:
    """Raise RecipeError for a robot of which nothing stands on the ground.

    The com is not above what is near the ground, which is one limb or the root; or that is the root
    alone, was only `guessed` from a mesh, and the joints move the com off it.
    """
    near = near_ground(robot, contacts, where)
    points = placed(near, where)[0]
    limbs = _limbs(robot)
    on = {limbs[contact.link] for contact in near}
    names = ", ".join(dict.fromkeys(contact.link for contact in near)) or "no sphere or cylinder"
    if len(on) < 2 and not is_above(centre_of_mass(robot, where), points):
        why = "the centre of mass is not above what is lowest in this posture"
    elif guessed and motion.free and on == {robot.root} and _leaves(robot, motion, near):
        why = "joints move the centre of mass off what is lowest, a part of the root"
    else:
        return
    raise RecipeError(
        f"{robot.source}: nothing stands on the ground: {why} (got {names}), as of an arm or a "
        "hand that is bolted down; name what touches the ground with --contact, or another posture "
        "with --posture or -p."
    )


def _limbs(robot: UrdfRobot) -> dict[str, str]:
    """Return for each link the first link of its limb: what hangs from the root by one joint."""
    result = {robot.root: robot.root}
    for joint in downwards(robot):
        begins = result[joint.parent] == robot.root and joint.kind not in ("fixed", "floating")
        result[joint.child] = joint.child if begins else result[joint.parent]
    return result


def _leaves(robot: UrdfRobot, motion: Motion, contacts: Sequence[Contact]) -> bool:
    """Return whether the com is off the contacts in many postures, the same ones in every run."""
    rng = np.random.default_rng(0)
    tips = 0
    for _ in range(TRIED):
        values = {name: rng.uniform(low, high) for name, (low, high) in motion.free.items()}
        where = places(robot, motion, values)
        tips += not is_above(centre_of_mass(robot, where), placed(contacts, where)[0])
    return tips > MAY_TIP

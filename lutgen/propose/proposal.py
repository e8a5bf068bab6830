"""Propose a recipe from a robot description, and say what the description has besides.

Owns the choice between what is asked for and what is proposed; `proposal_text` writes it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from lutgen.errors import RecipeError
from lutgen.parts import Contact
from lutgen.propose.bolted import refuse_bolted
from lutgen.propose.candidates import (
    closed_meshes,
    inner_contacts,
    lower_links,
    named_contacts,
    proposed_contacts,
    unique_names,
)
from lutgen.propose.chosen import chosen_motion
from lutgen.propose.coupling import Coupling
from lutgen.propose.doubts import doubts
from lutgen.propose.proposal_text import carrying_links, guesses, parameter_names, recipe_text
from lutgen.propose.recognised import recognised
from lutgen.recipe.recipe import Recipe, parse_recipe
from lutgen.recipe.robot_keys import MAX_CONTACTS
from lutgen.urdf import TOUCHING, Meshes, Motion, UrdfRobot, places, read_motion, used_shapes

# Names that a sentence lists.
LISTED = 12


@dataclass(frozen=True)
class Imported:
    """A recipe's text, the recipe, and sentences on what the description has besides.

    `guessed` has one for each wheel and foot that was recognised in a mesh.
    `couples` has the joints and scales of each parameter that drives several, and `because` why
    they are coupled unasked, empty where they are not.  `warnings` are about likely mistakes.
    """

    text: str
    recipe: Recipe
    left_out: tuple[str, ...]
    guessed: tuple[str, ...] = ()
    couples: dict[str, dict[str, float]] = field(default_factory=dict)
    because: str = ""
    warnings: tuple[str, ...] = ()


def import_urdf(
    robot: UrdfRobot,
    contacts: Sequence[str] | None = None,
    given: Sequence[Contact] = (),
    joints: Sequence[str] | None = None,
    posture: Mapping[str, float] | None = None,
    meshes: Meshes | None = None,
    coupling: Coupling | None = None,
) -> Imported:
    """Turn a description into a recipe.

    Parameters
    ----------
    robot : UrdfRobot
        The description; lengths in m.
    contacts : sequence of str, optional
        Links whose collision shapes touch the ground.  None: if `given` is empty, the spheres and
        cylinders near the ground at rest, else none.
    given : sequence of Contact
        Contacts in the frames of the description's links.
    joints : sequence of str, optional
        Joints that become parameters, each by itself; None for all that move a contact, or the
        com by more than 0.5 % of the robot's size, coupled where they are more than 10.
    posture : mapping of str to float, optional
        Joints at rest, rad or m; 0 for all others, or their limit nearest to it.  The recipe's
        `home`, and where joints that are no parameters stand.
    meshes : Meshes, optional
        Opens the meshes, to find wheels and feet in them; None leaves them closed.
    coupling : Coupling, optional
        Which joints one parameter drives.

    Returns
    -------
    Imported
        RecipeError is raised for unknown names and where there are not 3 to 62 contacts.
    """
    if not any(link.mass > 0.0 for link in robot.links):
        raise RecipeError(
            f"{robot.source}: no link has a mass, so that nobody knows where the centre of mass is "
            "(got 0 kg); give the links an <inertial> with <mass>."
        )
    motion = read_motion(robot, joints, posture)
    rest = places(robot, motion)
    links = {link.name for link in robot.links}
    # An unknown link is refused in the same words, whoever names it.
    named_contacts(robot, [contact.link for contact in given if contact.link not in links])
    proposes = contacts is None and not given
    if meshes is not None:
        robot = recognised(robot, meshes, rest, None if proposes else contacts or ())
    if proposes:
        found = proposed_contacts(robot, rest)
        if not closed_meshes(robot):
            guessed = len(guesses(robot, found)) == len(found)
            refuse_bolted(robot, motion, found, rest, guessed)
    else:
        found = [*given, *named_contacts(robot, contacts or ())]
    if len(found) < 3:
        raise _wrong_number(robot, len(found))
    motion, because = chosen_motion(robot, found, joints, posture, coupling)
    inner = inner_contacts(robot, motion, found, rest)
    found = unique_names([contact for contact in found if contact not in inner])
    if not 3 <= len(found) <= MAX_CONTACTS:
        raise _wrong_number(robot, len(found))
    doubtful = doubts(robot, found, rest)
    text = recipe_text(robot, motion, found, doubtful)
    recipe = parse_recipe(text, robot.source)
    left_out = _left_out(robot, motion, found, inner)
    left_out += _away(robot, {c.link for c in (*found, *inner)}) if proposes else []
    under = lower_links(robot, [*found, *inner], rest)
    if under:
        left_out.append(
            f"shapes below all contacts, on which it lies in this posture: {_listed(under)}"
        )
    if meshes is not None and (closed := closed_meshes(robot)):
        left_out.append(f"meshes that were not opened: {closed}")
    told = _guessed(robot, found), _scales(motion), because, doubtful
    return Imported(text, recipe, tuple(left_out), *told)


def _guessed(robot: UrdfRobot, contacts: Sequence[Contact]) -> tuple[str, ...]:
    """Return what was recognised in meshes, links of the same words together."""
    notes = guesses(robot, contacts)
    links: dict[str, dict[str, None]] = {}
    for contact in contacts:
        if contact.name in notes:
            links.setdefault(notes[contact.name], {})[contact.link] = None
    return tuple(f"{_listed(list(names))}: {note}" for note, names in links.items())


def _scales(motion: Motion) -> dict[str, dict[str, float]]:
    """Return joints and scales of each parameter that drives several."""
    names = parameter_names(motion)
    return {
        names[couple.first]: {joint: scale for joint, (scale, _) in couple.joints.items()}
        for couple in motion.couples
    }


def _away(robot: UrdfRobot, touching: set[str]) -> list[str]:
    """Return the sentence on round shapes that no contact was proposed for."""
    away = [
        link.name
        for link in robot.links
        if link.name not in touching and any(s.kind in TOUCHING for s in link.collisions)
    ]
    return [f"spheres and cylinders away from the ground: {_listed(away)}"] if away else []


def _wrong_number(robot: UrdfRobot, count: int) -> RecipeError:
    """Return the refusal of too few or too many contacts, and where too few could be."""
    way_out = "name the links that touch the ground with --contact"
    closed = closed_meshes(robot)
    if count < 3 and closed:
        way_out += (
            f", and give points on those with meshes, which are not opened ({closed}): "
            "--contact 'LINK=X,Y,Z[,RADIUS]'"
        )
    return RecipeError(
        f"{robot.source}: a robot needs 3 to {MAX_CONTACTS} contacts (got {count}); {way_out}."
    )


def _listed(names: Sequence[str]) -> str:
    """Return names with commas, the first dozen of them."""
    shown = ", ".join(names[:LISTED])
    return shown if len(names) <= LISTED else f"{shown} and {len(names) - LISTED} more"


def _left_out(
    robot: UrdfRobot, motion: Motion, contacts: Sequence[Contact], inner: Sequence[Contact]
) -> list[str]:
    """Return one sentence for each thing of the description that the recipe does not have."""
    result = []
    reasons: dict[str, list[str]] = {}
    for name, why in motion.held.items():
        reasons.setdefault(why, []).append(name)
    for why, names in reasons.items():
        result.append(
            f"joints {_listed(names)}: held, each {why}"
            if len(names) > 1
            else f"joint {_listed(names)}: held, {why}"
        )
    touching = {contact.link for contact in contacts} | {contact.link for contact in inner}
    partly = {
        link.name: sorted({shape.kind for shape in link.collisions if shape not in used})
        for link in robot.links
        if link.name in touching and (used := used_shapes(link)) != list(link.collisions)
    }
    kinds = sorted({kind for found in partly.values() for kind in found})
    carrying = carrying_links(robot, contacts)
    shaped = [link for link in robot.links if link.collisions]
    named: dict[str, Sequence[str]] = {
        "contacts between two others, which carry nothing alone: ": [one.name for one in inner],
        "collision shapes of links that are no contacts: ": [
            link.name for link in shaped if link.name not in touching
        ],
        f"collision shapes of kind {_listed(kinds)}: of ": list(partly),
        "links without mass, which weigh nothing here: ": [
            link.name for link in shaped if not link.mass
        ],
        "links without mass or contacts: ": [
            link.name for link in robot.links if link.name not in carrying
        ],
        "how far printed angles are off the parts of a turn that they stand for: ": robot.rounded,
    }
    named["other elements: "] = [f"{count} <{tag}>" for tag, count in robot.ignored.items()]
    named["elements and attributes that are not understood: "] = [
        f"{count} {what}" for what, count in robot.unknown.items()
    ]
    return result + [what + _listed(names) for what, names in named.items() if names]

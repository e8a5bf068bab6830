"""Propose a recipe from a robot description, and say what the description has besides."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from lutgen.errors import RecipeError
from lutgen.parts import Contact
from lutgen.propose.contacts import (
    closed_shapes,
    inner_contacts,
    listed,
    lower_links,
    named_contacts,
    proposed_contacts,
    refuse_bolted,
)
from lutgen.propose.couplings import Coupling, chosen_motion
from lutgen.propose.doubts import doubts, swinging_axles
from lutgen.propose.opened import drawn, opened_meshes, with_support
from lutgen.propose.text import (
    axle_note,
    carrying_links,
    guesses,
    parameter_names,
    recipe_text,
    unused,
)
from lutgen.recipe import Recipe, parse_recipe
from lutgen.recipe.schema import MAX_CONTACTS
from lutgen.urdf.description import UrdfRobot
from lutgen.urdf.joints import Motion, read_motion
from lutgen.urdf.links import may_touch, places, require_mass, used_shapes
from lutgen.urdf.meshes import Meshes


@dataclass(frozen=True)
class Imported:
    """A recipe's text, the recipe, and sentences on what the description has besides.

    `guessed` has one for each wheel and foot that was recognised; `couples` has joints and scales
    of each parameter that drives several, and `because` why unasked; `warnings` are of mistakes.
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
    """Turn a description (m) into a recipe; RecipeError is raised for what makes none.

    The links named in `contacts` touch the ground with their collision shapes, and so do those that
    are `given`, in the frames of links; without either, the shapes near the ground at rest.  The
    `joints` become parameters, and what `coupling` says; without either, all that matter.
    `posture` has joints at rest, rad or m, else 0 or their limit nearest to it: the recipe's
    `home`.  `meshes` opens the meshes, to find wheels and feet in them.
    """
    require_mass(robot)
    motion = read_motion(robot, joints, posture)
    rest = places(robot, motion)
    links = {link.name for link in robot.links}
    # An unknown link is refused in the same words from every caller.
    named_contacts(robot, [contact.link for contact in given if contact.link not in links])
    proposes = contacts is None and not given
    if meshes is not None:
        robot = opened_meshes(robot, meshes, rest, None if proposes else contacts or ())
    if proposes:
        shaped = with_support(robot, rest)
        found = proposed_contacts(shaped, rest)
        if not closed_shapes(robot):
            refuse_bolted(robot, found, rest)
    else:
        named = {*(contacts or ())}
        shaped = replace(
            robot, links=tuple(drawn(one) if one.name in named else one for one in robot.links)
        )
        found = [*given, *named_contacts(shaped, contacts or ())]
    robot = shaped
    if len(found) < 3:
        raise _wrong_number(robot, len(found))
    whole, inner = robot, inner_contacts(robot, motion, found, rest)
    outer = [contact for contact in found if contact not in inner]
    if joints is None:
        # Axles that swing are held in mid-swing: no parameter moves them.
        swing = {axle.name for axle in swinging_axles(robot, outer, rest)}
        fixed = (replace(j, kind="fixed") if j.name in swing else j for j in robot.joints)
        robot = replace(robot, joints=tuple(fixed))
    motion, because = chosen_motion(robot, found, joints, posture, coupling)
    inner = inner_contacts(robot, motion, found, rest)
    kept: dict[str, Contact] = {}
    for contact in found:
        if contact not in inner:
            name = unused(contact.name, kept.keys())
            kept[name] = replace(contact, name=name)
    found = list(kept.values())
    if not 3 <= len(found) <= MAX_CONTACTS:
        raise _wrong_number(robot, len(found))
    axles = swinging_axles(whole, found, rest) if joints is None else ()
    carried = {name for axle in axles for name in axle.contacts}
    warnings = doubts(whole, [one for one in found if one.name not in carried], rest)
    text = recipe_text(robot, motion, found, warnings, axles)
    left_out = _left_out(robot, motion, found, inner)
    touching = {contact.link for contact in (*found, *inner)}
    round_ = [link.name for link in robot.links if may_touch(link)]
    if proposes and (away := [name for name in round_ if name not in touching]):
        left_out.append(f"spheres and cylinders away from the ground: {listed(away)}")
    if lower := lower_links(robot, [*found, *inner], rest):
        what = "shapes below all contacts, on which it lies in this posture"
        left_out.append(f"{what}: {listed(lower)}")
    if meshes is not None and (closed := closed_shapes(robot)):
        left_out.append(f"meshes that were not opened: {closed}")
    names = parameter_names(motion)
    return Imported(
        text,
        parse_recipe(text, robot.source),
        tuple(left_out),
        (*_guessed(robot, found), *map(axle_note, axles)),
        {
            names[couple.first]: {joint: scale for joint, (scale, _) in couple.joints.items()}
            for couple in motion.couples
        },
        because,
        warnings,
    )


def _guessed(robot: UrdfRobot, contacts: Sequence[Contact]) -> tuple[str, ...]:
    notes = guesses(robot, contacts)
    links: dict[str, dict[str, None]] = {}
    for contact in contacts:
        if contact.name in notes:
            links.setdefault(notes[contact.name], {})[contact.link] = None
    return tuple(f"{listed(names)}: {note}" for note, names in links.items())


def _wrong_number(robot: UrdfRobot, count: int) -> RecipeError:
    way_out = "name the links that touch the ground with --contact"
    closed = closed_shapes(robot)
    if count < 3 and closed:
        way_out += (
            f", and give points on those whose shapes were not understood ({closed}): "
            "--contact 'LINK=X,Y,Z[,RADIUS]'"
        )
    return RecipeError(
        f"{robot.source}: a robot needs 3 to {MAX_CONTACTS} contacts (got {count}); {way_out}."
    )


def _left_out(
    robot: UrdfRobot, motion: Motion, contacts: Sequence[Contact], inner: Sequence[Contact]
) -> list[str]:
    """Return one sentence for each thing of the description that the recipe does not have."""
    reasons: dict[str, list[str]] = {}
    for name, why in motion.held.items():
        reasons.setdefault(why, []).append(name)
    result = [
        f"joints {listed(names)}: held, each {why}"
        if len(names) > 1
        else f"joint {names[0]}: held, {why}"
        for why, names in reasons.items()
    ]
    touching = {contact.link for contact in (*contacts, *inner)}
    shaped = [link for link in robot.links if link.collisions]
    unused = {
        link.name: {shape.kind for shape in link.collisions if shape not in used_shapes(link)}
        for link in shaped
        if link.name in touching
    }
    kinds = sorted({kind for found in unused.values() for kind in found})
    carrying = carrying_links(robot, contacts)
    moving = [joint for joint in robot.joints if joint.name not in motion.held]
    endless = [one.name for one in moving if one.kind == "revolute" and one.upper == float("inf")]
    named = {
        "contacts between two others, which carry nothing alone: ": [one.name for one in inner],
        "collision shapes of links that are no contacts: ": [
            link.name for link in shaped if link.name not in touching
        ],
        f"collision shapes of kind {listed(kinds)}: of ": [
            n for n, other in unused.items() if other
        ],
        "links without mass, which weigh nothing here: ": [k.name for k in shaped if not k.mass],
        "links without mass or contacts: ": [
            link.name for link in robot.links if link.name not in carrying
        ],
        "joints without limits, taken as -180 to 180 deg: ": endless,
        "soft limits, narrower than those that are taken (or pass --soft-limits): ": [
            one.name
            for one in moving
            if one.soft and (one.lower < one.soft[0] or one.soft[1] < one.upper)
        ],
        "how far printed angles are off the parts of a turn that they stand for: ": robot.rounded,
        "other elements: ": [f"{count} <{tag}>" for tag, count in robot.ignored.items()],
        "elements and attributes that are not understood: ": [
            f"{count} {what}" for what, count in robot.unknown.items()
        ],
    }
    return result + [what + listed(names) for what, names in named.items() if names]

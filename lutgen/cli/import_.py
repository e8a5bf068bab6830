"""`lutgen import`: a recipe to start from, out of a robot description."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli.options import (
    Assignment,
    Named,
    as_json,
    asks,
    finite_numbers,
    force,
    log,
    option,
    output,
)
from lutgen.cli.table import show
from lutgen.errors import InputError, RecipeError

if TYPE_CHECKING:
    from lutgen.parts import Contact
    from lutgen.recipe import Recipe
    from lutgen.urdf.description import UrdfRobot
    from lutgen.urdf.srdf import Srdf

STANDS_NOWHERE = "the robot stands in none of its postures on these contacts"
# How the refusal ends where a recipe may have been edited.
KEPT = "pass --merge to keep what was edited by hand, or --force to write over it"


@dataclass(frozen=True)
class Asked:
    """What the command line says."""

    output: str = output(required=True, help="Recipe to write (.toml).")
    name: str | None = option("-n", help="The recipe's name; the robot's own by default.")
    contacts: tuple[str, ...] = option(
        "-c",
        "--contact",
        multiple=True,
        metavar="LINK[=X,Y,Z[,R]]",
        help=(
            "A link whose collision shapes touch the ground, or a point or sphere on it (m); "
            "repeat."
        ),
    )
    joints: tuple[str, ...] = option(
        "-j", "--joint", multiple=True, help="A joint that becomes a parameter; repeat."
    )
    couples: tuple[str, ...] = option(
        "--couple",
        multiple=True,
        metavar="NAME=JOINT,...",
        help=(
            "A parameter that drives several joints, -JOINT or 0.5*JOINT at another rate, all of "
            "a pattern ('*_hip') or of a group of the SRDF; or auto, a pattern or a group alone, "
            "of which groups by name and symmetry are proposed; repeat."
        ),
    )
    xacro: bool = option(
        "-x", is_flag=True, help="Expand xacro: evaluates the file, reads its includes."
    )
    soft_limits: bool = option(
        is_flag=True, help="Take the soft limits of <safety_controller> as the joints' limits."
    )
    merge: bool = option(
        is_flag=True,
        help="Keep the recipe that is there: only masses and places of its links become new.",
    )
    force: bool = force(help="Write over a recipe that is there, and what was edited in it.")
    assignments: tuple[tuple[str, float], ...] = option(
        "-p",
        "--parameter",
        type=Assignment("JOINT=VALUE", "joint and value", "knee=-60"),
        multiple=True,
        help="Where a joint stands, in deg or m, before what an SRDF says; repeat.",
    )
    posture: str | None = option(
        metavar="NAME", help="The posture to stand in, of the SRDF; the likeliest by default."
    )
    srdf: str | None = option(
        type=Named(), help="SRDF file with postures; by default one beside the description."
    )
    packages: tuple[str, ...] = option(
        "--package",
        multiple=True,
        metavar="NAME=DIR",
        help="The folder of a ROS package with meshes, or that a .xacro file includes; repeat.",
    )
    arguments: tuple[str, ...] = option(
        "--arg", multiple=True, metavar="NAME=VALUE", help="An argument of a .xacro file; repeat."
    )
    as_json: bool = as_json()


@click.command("import", short_help="Write a recipe from a robot description (URDF).")
@click.argument("urdf", type=Named())
@asks(Asked)
def import_(urdf: str, asked: Asked) -> None:
    """Write a recipe from the robot description URDF and say what it leaves out.

    It stands as an SRDF file says (group_state), or with its joints at zero; -p and --posture say
    otherwise.  Without --contact, the spheres and cylinders near the ground then touch it, and the
    wheels and feet that are recognised in meshes (pip install lutgen[meshes]).
    Without --joint and --couple, every joint that moves a contact, or the centre of mass by more
    than 0.5 % of the robot's size, becomes a parameter; of more than ten those that are alike move
    together.

    A recipe that is there stays as it is unless --merge or --force is given; give --merge the same
    options as the first time.

    \b
    $ lutgen import robot.urdf -o recipe.toml -c left_wheel -c right_wheel -c nose=0.3,0,-0.1
    """
    from lutgen.files import check_target, write_text
    from lutgen.propose import Coupling, import_urdf
    from lutgen.recipe import merged_recipe, read_text
    from lutgen.urdf.joints import read_motion
    from lutgen.urdf.links import centre_of_mass, places
    from lutgen.urdf.meshes import Meshes
    from lutgen.urdf.sources import Sources

    if not asked.output.endswith(".toml"):
        raise InputError(f"--output: is no recipe's name (got {asked.output!r}); end it in .toml.")
    robot = _read(urdf, asked)
    if asked.name is not None:
        if not asked.name.strip():
            raise InputError("--name: must not be empty (got ''); leave it out.")
        robot = replace(robot, name=asked.name)
    links = {link.name for link in robot.links}
    # A link's own name may have an equals sign in it.
    named = [text for text in asked.contacts if text in links or "=" not in text]
    points = [_point(text, i) for i, text in enumerate(asked.contacts, 1) if text not in named]
    srdf = _srdf(urdf, robot, asked)
    posture, words, beyond = _standing(urdf, robot, asked, srdf)
    chosen = named if asked.contacts else None
    coupling = Coupling(asked.couples, srdf.groups if srdf is not None else {})
    meshes = Meshes(Sources(Path(urdf).parent, _packages(asked)))
    made = import_urdf(robot, chosen, points, asked.joints or None, posture, meshes, coupling)
    recipe = made.recipe
    report = {
        "name": recipe.name,
        "mass": math.fsum(link.mass for link in robot.links),
        "com": centre_of_mass(robot, places(robot, read_motion(robot, (), posture))).tolist(),
        "posture": words,
        "parameters": [p.name for p in recipe.parameters],
        "coupled": made.couples,
        "because": made.because,
        "contacts": list(recipe.contact_names),
        "guessed": list(made.guessed),
        "left_out": [*beyond, *made.left_out],
        "warnings": list(made.warnings),
    }
    for words in made.warnings:
        log.warning("%s: %s", urdf, words)
    text = made.text
    if asked.merge:
        old = read_text(asked.output)
        text, report["changed"] = merged_recipe(old, asked.output, made.text)
    else:
        check_target(asked.output, asked.force, text.encode("utf-8"), KEPT)
    write_text(asked.output, text, asked.force or asked.merge)
    _warn_unless_standing(recipe)
    show(report, import_lines(report, robot.root), asked.as_json)


def _warn_unless_standing(recipe: "Recipe") -> None:
    """Say that a recipe is of no use yet where its robot stands in none of its postures."""
    from lutgen.mapping import require_standing

    try:
        require_standing(recipe)
    except RecipeError:
        log.warning(
            "%s: %s; choose others with --contact, or correct them in the recipe",
            recipe.name,
            STANDS_NOWHERE,
        )


def import_lines(report: dict[str, Any], root: str) -> Iterator[str]:
    """Return the report as text."""
    place = ", ".join(f"{x:.4f}" for x in report["com"])
    yield f"{report['name']}: {report['mass']:.6g} kg, com at rest ({place}) m from {root}"
    for what in ("contacts", "parameters"):
        yield f"  {what} ({len(report[what])}): {' '.join(report[what]) or '-'}"
    if report["because"]:
        yield f"  chosen, as {report['because']} (or choose with --couple or --joint)"
    for name, joints in report["coupled"].items():
        yield f"  {name} drives {', '.join(scaled(*one) for one in joints.items())}"
    yield f"  posture: {report['posture']}"
    if report["guessed"]:
        yield "guessed from meshes:"
    yield from (f"  {what}" for what in report["guessed"])
    yield "left out:" if report["left_out"] else "nothing left out"
    yield from (f"  {what}" for what in report["left_out"])
    if "changed" in report:
        yield "changed:" if report["changed"] else "nothing changed"
        yield from (f"  {what}" for what in report["changed"])


def scaled(joint: str, scale: float) -> str:
    """Return a joint as `--couple` takes it."""
    return {1.0: joint, -1.0: f"-{joint}"}.get(scale, f"{scale:g}*{joint}")


def _srdf(path: str, robot: "UrdfRobot", asked: Asked) -> "Srdf | None":
    """Return what the SRDF file says that is given or stands beside the description."""
    from lutgen.urdf.srdf import load_srdf, srdf_beside

    file = Path(asked.srdf) if asked.srdf is not None else srdf_beside(path)
    return None if file is None else load_srdf(file, robot)


def _standing(
    path: str, robot: "UrdfRobot", asked: Asked, srdf: "Srdf | None"
) -> tuple[dict[str, float], str, list[str]]:
    """Return the posture to stand in (rad, m), where it comes from, and what it leaves out."""
    from lutgen.urdf.srdf import beyond_limits, joint_values

    given = joint_values(robot, asked.assignments)
    if srdf is None:
        if asked.posture is not None:
            raise InputError(
                f"--posture: there is no SRDF file beside {path} (got {asked.posture!r}); "
                "give one with --srdf, or joints with -p."
            )
        why = "no SRDF file names one"
        values: dict[str, float] = {}
    else:
        file = Path(srdf.source)
        name = asked.posture if asked.posture is not None else srdf.standing()
        values = {} if name is None else srdf.posture(name)
        known = ", ".join(srdf.postures) or "none"
        why = f"{file.name} names none to stand in: {known}" if name is None else ""
        words = f"{name} of {file.name}"
    if why:
        words = f"joints at zero, or at their limit nearest to it ({why})"
    if given:
        words = f"{', '.join(given)} as given; else {words}"
    beyond = [
        f"joint {joint}: at its limit, beyond which the posture is"
        for joint in beyond_limits(robot, values)
        if joint not in given
    ]
    return {**values, **given}, words, beyond


def _read(path: str, asked: Asked) -> "UrdfRobot":
    """Read a description, after expansion where it is asked for."""
    from lutgen.urdf.joints import soft_limited
    from lutgen.urdf.read import load_urdf
    from lutgen.urdf.sources import load_xacro

    macros = path.endswith(".xacro")
    if macros and not asked.xacro:
        raise InputError(
            f"{path}: must be expanded, which evaluates it and reads the files that it includes "
            "(got no --xacro); pass --xacro if you trust it."
        )
    arguments = dict(_pairs("--arg", "NAME=VALUE", asked.arguments))
    if arguments and not asked.xacro:
        raise InputError(f"--arg: is for xacro (got {path}); leave it out, or pass --xacro.")
    robot = load_xacro(path, _packages(asked), arguments) if asked.xacro else load_urdf(path)
    return soft_limited(robot) if asked.soft_limits else robot


def _packages(asked: Asked) -> dict[str, Path]:
    """Return the folders of packages that are given."""
    given = _pairs("--package", "NAME=DIR", asked.packages)
    packages = {name: Path(folder) for name, folder in given}
    for name, folder in packages.items():
        if not folder.is_dir():
            raise InputError(
                f"--package: {name} is in no folder that there is (got {str(folder)!r}); "
                "write NAME=DIR."
            )
    return packages


def _pairs(option: str, form: str, texts: tuple[str, ...]) -> list[tuple[str, str]]:
    """Return name and value of each NAME=VALUE."""
    result = []
    for text in texts:
        name, equals, value = text.partition("=")
        if not (name.strip() and equals and value):
            raise InputError(f"{option}: has no name or no value (got {text!r}); write {form}.")
        result.append((name.strip(), value))
    return result


def _point(text: str, index: int) -> "Contact":
    """Return the contact of ``LINK=X,Y,Z[,R]``."""
    from lutgen.parts import Contact

    link, _, numbers = text.rpartition("=")
    values = finite_numbers(numbers)
    if len(values) not in (3, 4) or min(values[3:], default=0.0) < 0.0:
        raise InputError(
            f"--contact: is no point of a link (got {text!r}); write LINK=X,Y,Z[,RADIUS]."
        )
    radius = values[3] if len(values) == 4 else 0.0
    return Contact(f"{link}_P{index}", link, (values[0], values[1], values[2]), radius)

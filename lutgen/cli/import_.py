"""`lutgen import`: a recipe to start from, out of a robot description."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lutgen.cli import options as given
from lutgen.cli.lazy import Floats, maps, proposals
from lutgen.cli.options import command, finite_numbers, log, option
from lutgen.cli.output import show
from lutgen.errors import InputError, RecipeError, reject
from lutgen.files import write_text
from lutgen.parts import Contact

if TYPE_CHECKING:
    from lutgen.urdf.description import UrdfRobot

STANDS_NOWHERE = (
    "the robot stands in none of its postures on these contacts; choose others with --contact, or "
    "correct them in the recipe"
)


@dataclass(frozen=True)
class Options:
    output: str = given.output("Recipe to write (.toml).", required=True)
    name: str | None = option("The recipe's name; the robot's own by default.", "-n")
    contacts: tuple[str, ...] = option(
        "A link whose collision shapes touch the ground, or a point or sphere on it (m); repeat.",
        "-c --contact",
        metavar="LINK[=X,Y,Z[,R]]",
    )
    joints: tuple[str, ...] = option("A joint that becomes a parameter; repeat.", "-j --joint")
    couples: tuple[str, ...] = option(
        "A parameter that drives several joints, -JOINT or 0.5*JOINT at another rate, all of "
        "a pattern ('*_hip') or of a group of the SRDF; or auto, a pattern or a group alone, "
        "of which groups by name and symmetry are proposed; repeat.",
        "--couple",
        metavar="NAME=JOINT,...",
    )
    xacro: bool = option("Expand xacro: evaluates the file, reads its includes.", "-x")
    soft_limits: bool = option("Take the soft limits of <safety_controller> as the joints' limits.")
    force: bool = option("Write over a recipe that is there, and what was edited in it.")
    assignments: tuple[tuple[str, float], ...] = option(
        "Where a joint stands, in deg or m, before what an SRDF says; repeat.",
        "-p --parameter",
        type=given.Numbers("JOINT=VALUE", "joint and value", "for example knee=-60"),
    )
    posture: str | None = option(
        "The posture to stand in, of the SRDF; the likeliest by default.", metavar="NAME"
    )
    srdf: str | None = given.file("SRDF file with postures; by default one beside the description.")
    packages: tuple[str, ...] = option(
        "The folder of a ROS package with meshes, or that a .xacro file includes; repeat.",
        "--package",
        metavar="NAME=DIR",
    )
    arguments: tuple[str, ...] = option(
        "An argument of a .xacro file; repeat.", "--arg", metavar="NAME=VALUE"
    )


@command("urdf", Options)
def import_(urdf: str, options: Options) -> None:
    """Write a recipe from a robot description (URDF, MJCF).

    The output lists what it leaves out.  The robot stands as an SRDF file says (group_state), or
    with its joints at zero, unless -p or --posture changes that.  Without --contact, the spheres
    and cylinders near the ground then touch it, and the wheels and feet that are recognised in
    meshes (pip install lutgen[meshes]).  Without --joint and --couple, every joint that moves a
    contact, or the centre of mass by more than 0.5 % of the robot's size, becomes a parameter; of
    more than ten those that are alike move together.

    A recipe that is there stays as it is unless --force is given.

    \b
    $ lutgen import robot.urdf -o recipe.toml -c left_wheel -c right_wheel -c nose=0.3,0,-0.1
    """
    from lutgen.urdf.joints import read_motion
    from lutgen.urdf.links import centre_of_mass, places
    from lutgen.urdf.meshes import Meshes
    from lutgen.urdf.sources import Sources
    from lutgen.urdf.srdf import joint_values, load_srdf, srdf_beside, standing_posture

    if not options.output.endswith(".toml"):
        got = options.output
        raise InputError(f"--output: is no recipe's name (got {got!r}); end it in .toml.")
    robot, hulls = read_robot(urdf, options)
    links = {link.name for link in robot.links}
    # A link's own name may have an equals sign in it.
    named = [text for text in options.contacts if text in links or "=" not in text]
    points = [point(text, i) for i, text in enumerate(options.contacts, 1) if text not in named]
    file = Path(options.srdf) if options.srdf is not None else srdf_beside(urdf)
    srdf = None if file is None else load_srdf(file, robot)
    rest = standing_posture(robot, srdf, options.posture, joint_values(robot, options.assignments))
    made = proposals.import_urdf(
        robot,
        named if options.contacts else None,
        points,
        options.joints or None,
        rest.values,
        Meshes(Sources(Path(urdf).parent, packages(options)), hulls),
        proposals.Coupling(options.couples, srdf.groups if srdf is not None else {}),
    )
    report: dict[str, Any] = {
        "name": made.recipe.name,
        "mass": math.fsum(link.mass for link in robot.links),
        "com": centre_of_mass(robot, places(robot, read_motion(robot, (), rest.values))),
        "posture": rest.words,
        "parameters": [p.name for p in made.recipe.parameters],
        "coupled": made.couples,
        "because": made.because,
        "contacts": made.recipe.contact_names,
        "guessed": made.guessed,
        "left_out": [*rest.left_out, *made.left_out],
        "warnings": made.warnings,
    }
    for words in made.warnings:
        log.warning("%s: %s", urdf, words)
    write_text(options.output, made.text, options.force)
    try:
        maps.require_standing(made.recipe)
    except RecipeError:
        # The recipe is of no use yet.
        log.warning("%s: %s", made.recipe.name, STANDS_NOWHERE)
    show(report, lambda shown: import_lines(shown, robot.root))


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
        yield "guessed:"
    yield from (f"  {what}" for what in report["guessed"])
    yield "left out:" if report["left_out"] else "nothing left out"
    yield from (f"  {what}" for what in report["left_out"])


def scaled(joint: str, scale: float) -> str:
    """Return a joint as `--couple` takes it."""
    return {1.0: joint, -1.0: f"-{joint}"}.get(scale, f"{scale:g}*{joint}")


def read_robot(path: str, options: Options) -> "tuple[UrdfRobot, dict[str, Floats]]":
    """Read a description, after expansion if requested, under the name that is given.

    For MuJoCo's format the corners of its meshes come with it.
    """
    from lutgen.urdf.joints import soft_limited
    from lutgen.urdf.mjcf import is_mjcf, load_mjcf
    from lutgen.urdf.read import load_urdf
    from lutgen.urdf.sources import load_xacro

    if path.endswith(".xacro") and not options.xacro:
        what = "must be expanded, which evaluates it and reads the files that it includes"
        reject(path, what, "no --xacro", "pass --xacro if you trust it", InputError)
    arguments = dict(pairs("--arg", "NAME=VALUE", options.arguments))
    if arguments and not options.xacro:
        raise InputError(f"--arg: is for xacro (got {path}); leave it out, or pass --xacro.")
    hulls: dict[str, Floats] = {}
    if options.xacro:
        robot = load_xacro(path, packages(options), arguments)
    elif is_mjcf(path):
        robot, hulls = load_mjcf(path)
    else:
        robot = load_urdf(path)
    if options.name is not None:
        if not options.name.strip():
            raise InputError("--name: must not be empty (got ''); leave it out.")
        robot = replace(robot, name=options.name)
    return soft_limited(robot) if options.soft_limits else robot, hulls


def packages(options: Options) -> dict[str, Path]:
    """Return the folders of packages that are given."""
    texts = pairs("--package", "NAME=DIR", options.packages)
    found = {name: Path(folder) for name, folder in texts}
    for name, folder in found.items():
        if not folder.is_dir():
            what = f"{name} is in no folder that there is"
            reject("--package", what, repr(str(folder)), "write NAME=DIR", InputError)
    return found


def pairs(flag: str, form: str, texts: tuple[str, ...]) -> Iterator[tuple[str, str]]:
    """Return name and value of each NAME=VALUE."""
    for text in texts:
        name, _, value = text.partition("=")
        if not (name.strip() and value):
            raise InputError(f"{flag}: has no name or no value (got {text!r}); write {form}.")
        yield name.strip(), value


def point(text: str, index: int) -> "Contact":
    """Return the contact of ``LINK=X,Y,Z[,R]``."""
    link, _, numbers = text.rpartition("=")
    values = finite_numbers(numbers)
    if len(values) not in (3, 4) or min(values[3:], default=0.0) < 0.0:
        way_out = "write LINK=X,Y,Z[,RADIUS]"
        reject("--contact", "is no point of a link", repr(text), way_out, InputError)
    radius = values[3] if len(values) == 4 else 0.0
    return Contact(f"{link}_P{index}", link, (values[0], values[1], values[2]), radius)

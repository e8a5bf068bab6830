"""`lutgen import`: a recipe to start from, out of a robot description."""

import json
import math
from dataclasses import replace
from typing import TYPE_CHECKING

import click

from lutgen.cli.options import as_json, finite_numbers
from lutgen.errors import InputError

if TYPE_CHECKING:
    from lutgen.recipe import Contact
    from lutgen.urdf import UrdfRobot


@click.command("import", short_help="Write a recipe from a robot description (URDF).")
@click.argument("urdf", type=click.Path())
@click.option("-o", "--output", required=True, type=click.Path(), help="Recipe to write (.toml).")
@click.option("-n", "--name", help="The recipe's name; the robot's own by default.")
@click.option(
    "-c",
    "--contact",
    "contacts",
    multiple=True,
    metavar="LINK[=X,Y,Z[,R]]",
    help="A link whose collision shapes touch the ground, or a point or sphere on it (m); repeat.",
)
@click.option(
    "-j", "--joint", "joints", multiple=True, help="A joint that becomes a parameter; repeat."
)
@click.option(
    "-x", "--xacro", is_flag=True, help="Expand a .xacro file: evaluates it, reads its includes."
)
@as_json
def import_(
    urdf: str,
    output: str,
    name: str | None,
    contacts: tuple[str, ...],
    joints: tuple[str, ...],
    xacro: bool,
    as_json: bool,
) -> None:
    """Write a recipe from the robot description URDF and say what it leaves out.

    Without --contact, spheres and cylinders that reach below the centre of mass touch the ground.
    Without --joint, every joint that moves a contact, or the centre of mass by more than 0.5 % of
    the robot's size, becomes a parameter.

    \b
    $ lutgen import robot.urdf -o recipe.toml -c left_wheel -c right_wheel -c nose=0.3,0,-0.1
    """
    from lutgen.files import write_text
    from lutgen.recipe import import_urdf
    from lutgen.urdf import centre_of_mass, places, read_motion

    if not output.endswith(".toml"):
        raise InputError(f"--output: is no recipe's name (got {output!r}); end it in .toml.")
    robot = _read(urdf, xacro)
    if name is not None:
        if not name.strip():
            raise InputError("--name: must not be empty (got ''); leave it out.")
        robot = replace(robot, name=name)
    links = {link.name for link in robot.links}
    # A link's own name may have an equals sign in it.
    named = [text for text in contacts if text in links or "=" not in text]
    points = [_point(text, i) for i, text in enumerate(contacts, 1) if text not in named]
    made = import_urdf(robot, named if contacts else None, points, joints or None)
    recipe = made.recipe
    com = centre_of_mass(robot, places(robot, read_motion(robot, ()))).tolist()
    mass = math.fsum(link.mass for link in robot.links)
    write_text(output, made.text)
    if as_json:
        report = {
            "name": recipe.name,
            "mass": mass,
            "com": com,
            "parameters": [p.name for p in recipe.parameters],
            "contacts": list(recipe.contact_names),
            "left_out": list(made.left_out),
        }
        click.echo(json.dumps(report, indent=2))
        return
    place = ", ".join(f"{x:.4f}" for x in com)
    click.echo(f"{recipe.name}: {mass:.6g} kg, com at rest ({place}) m from {robot.root}")
    for what, names in (
        ("contacts", recipe.contact_names),
        ("parameters", [p.name for p in recipe.parameters]),
    ):
        click.echo(f"  {what} ({len(names)}): {' '.join(names) or '-'}")
    click.echo("left out:" if made.left_out else "nothing left out")
    for what in made.left_out:
        click.echo(f"  {what}")


def _read(path: str, xacro: bool) -> "UrdfRobot":
    """Read a description, after expansion where it is asked for."""
    from lutgen.urdf import load_urdf, load_xacro

    macros = path.endswith(".xacro")
    if xacro and not macros:
        raise InputError(f"--xacro: {path} is no .xacro file (got it as URDF); leave --xacro out.")
    if macros and not xacro:
        raise InputError(
            f"{path}: must be expanded, which evaluates it and reads the files that it includes "
            "(got no --xacro); pass --xacro if you trust it."
        )
    return load_xacro(path) if xacro else load_urdf(path)


def _point(text: str, index: int) -> "Contact":
    """Return the contact of ``LINK=X,Y,Z[,R]``."""
    from lutgen.recipe import Contact

    link, _, numbers = text.rpartition("=")
    values = finite_numbers(numbers)
    if len(values) not in (3, 4) or min(values[3:], default=0.0) < 0.0:
        raise InputError(
            f"--contact: is no point of a link (got {text!r}); write LINK=X,Y,Z[,RADIUS]."
        )
    radius = values[3] if len(values) == 4 else 0.0
    return Contact(f"{link}_P{index}", link, (values[0], values[1], values[2]), radius)

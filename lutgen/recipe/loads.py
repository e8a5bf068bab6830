"""What a recipe's robot carries and what pulls at it: payloads, forces, an uncertain com.

This reads ``[[robot.payload]]``, ``[[robot.force]]`` and ``com_uncertainty``.  What they do to
stability is in `lutgen.channels.loads`.
"""

from lutgen.parts import ZERO, Force, Link
from lutgen.recipe.keys import names
from lutgen.recipe.robot import carrier
from lutgen.recipe.table import Table


def read_payloads(robot: Table, links: tuple[Link, ...]) -> tuple[Link, ...]:
    """Read ``[[robot.payload]]``: the links, and after them one massive link for each payload."""
    result = list(links)
    taken = {link.name for link in links}
    for table in robot.tables("payload", names("robot.payload")):
        _refuse_massless(table, "mass", links, "moves no com of a robot without masses")
        name = table.new_name("payload", taken)
        taken.add(name)
        link = carrier(table, "payload", links)
        position = table.vector("position", "write [x, y, z] in the link's frame")
        mass = table.number("mass", "write the payload's mass in the unit of the links' masses")
        if mass <= 0.0:
            table.fail("mass", "must be above 0", mass, "write the payload's mass, or remove it")
        result.append(Link(name, link, position, mass=mass))
    return tuple(result)


def read_forces(robot: Table, links: tuple[Link, ...]) -> tuple[Force, ...]:
    """Read ``[[robot.force]]`` in order; `links` without the payloads, which carry none."""
    result: list[Force] = []
    taken: set[str] = set()
    for table in robot.tables("force", names("robot.force")):
        _refuse_massless(table, "force", links, "has no weight to compare with without masses")
        name = table.new_name("force", taken)
        taken.add(name)
        link = carrier(table, "force", links)
        position = table.vector("position", "write [x, y, z] in the link's frame")
        force = table.vector("force", "write [x, y, z] in N along the body's axes")
        moment = table.vector("moment", "write [x, y, z] in N times the length unit", ZERO)
        result.append(Force(name, link, position, force, moment))
    return tuple(result)


def read_com_uncertainty(robot: Table) -> float:
    """Read the radius of the ball about the computed com in which the real one lies."""
    way_out = "write a length of 0 or more"
    radius = robot.number("com_uncertainty", way_out, 0.0)
    if radius < 0.0:
        robot.fail("com_uncertainty", "must not be negative", radius, way_out)
    return radius


def _refuse_massless(table: Table, key: str, links: tuple[Link, ...], what: str) -> None:
    """Refuse an entry of a robot whose com is the origin by definition."""
    if not any(link.mass for link in links):
        table.fail(key, what, table.values.get(key, "nothing"), "give its links masses in kg")

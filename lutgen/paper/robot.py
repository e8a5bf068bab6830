"""The recipe of the paper's robot: three wheels, of which one or two have a parameter."""

from collections.abc import Sequence
from importlib.resources import files

from lutgen.paper.nominal import AHEAD, NOMINAL_DEG, RADIUS
from lutgen.recipe import Recipe, parse_recipe

TEXT = files(__package__).joinpath("robot.toml.in").read_text(encoding="utf-8")
PARAMETER = '\n[[robot.parameter]]\nname = "{}"\nmin = 0.0\nmax = 50.0\nunit = "deg"\n'
JOINT = 'joint = {{ type = "revolute", axis = [0, 1, 0], parameter = "{}" }}'
# Nodes of each parameter's map, deg: the paper's 50 x 50 map must have a node at 31.
KNOTS = [float(knot) for knot in range(50)]


def paper_recipe(moving: int = 2, azimuths: Sequence[float] = AHEAD) -> Recipe:
    """Return the robot of simulation 1 (`moving` = 1: P1 alone) or 2 (P1 and P2).

    Azimuths of the wheels in deg from the body's x axis.  The map holds one gravity direction,
    straight down.
    """
    names = ("alpha", "gamma")[:moving]
    fixed = 3 - moving
    text = TEXT.format(
        name=f"paper_{('one', 'two')[moving - 1]}",
        parameters="".join(map(PARAMETER.format, names)),
        joint=[*map(JOINT.format, names), *[""] * fixed],
        elevation=[0.0] * moving + [NOMINAL_DEG] * fixed,
        azimuth=[float(azimuth) for azimuth in azimuths],
        radius=RADIUS,
        samples=", ".join(f"{name} = {KNOTS}" for name in names),
    )
    return parse_recipe(text, "the paper's robot")

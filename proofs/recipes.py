"""Two small robots as recipes, and the parts they are written of; the tests use them, too."""

from collections.abc import Sequence

__all__ = ["contact", "rover", "sweep_part", "tripod"]


def contact(
    name: str,
    position: Sequence[float],
    radius: float = 0.0,
    axis: Sequence[float] | None = None,
    link: str = "body",
) -> str:
    """Return the TOML of one contact: a point, a sphere (radius) or a disc (radius and axis)."""
    text = f'[[robot.contact]]\nname = "{name}"\nlink = "{link}"\n'
    text += f"position = [{', '.join(repr(float(x)) for x in position)}]\n"
    if radius:
        text += f"radius = {radius!r}\n"
    if axis is not None:
        text += f"axis = [{', '.join(repr(float(x)) for x in axis)}]\n"
    return text


def sweep_part(
    samples: str = "",
    chart: str = "cone",
    nodes: int = 7,
    max_tilt: float = 50.0,
    channels: Sequence[str] = ("sdg", "tip_angle"),
) -> str:
    """Return the TOML of the [sweep] table; `samples` is the inside of its braces."""
    text = "[sweep]\n"
    if samples:
        text += f"samples = {{ {samples} }}\n"
    text += f'[sweep.gravity]\nchart = "{chart}"\nnodes = {nodes}\n'
    if chart == "cone":
        text += f"max_tilt = {max_tilt!r}\n"
    return text + f"channels = [{', '.join(repr(name) for name in channels)}]\n".replace("'", '"')


def tripod(
    samples: str = "reach = 4, swing = 3",
    head: str = "friction = 0.8",
    contacts: str = "",
    **sweep: object,
) -> str:
    """Return a recipe of three feet of which one moves: 2 parameters, a length and an angle."""
    return (
        f'[robot]\nname = "tripod"\nlength_unit = "m"\n{head}\n'
        '[[robot.parameter]]\nname = "reach"\nmin = 0.0\nmax = 0.6\nunit = "m"\n'
        '[[robot.parameter]]\nname = "swing"\nmin = -40.0\nmax = 50.0\nunit = "deg"\n'
        '[[robot.link]]\nname = "body"\nmass = 5.0\ncom = [0.02, 0.03, 0.1]\n'
        '[[robot.link]]\nname = "hip"\nparent = "body"\norigin = [0.1, 0, 0]\n'
        'joint = { type = "revolute", axis = [0, 0, 1], parameter = "swing" }\n'
        '[[robot.link]]\nname = "leg"\nparent = "hip"\nmass = 1.0\n'
        'joint = { type = "prismatic", axis = [1, 0, -0.2], parameter = "reach" }\n'
        + contact("front", (0.7, 0.0, -1.0), link="leg")
        + contact("left", (-0.5, 0.8, -1.1))
        + contact("right", (-0.6, -0.7, -0.9))
        + contacts
        + sweep_part(samples, **sweep)  # type: ignore[arg-type]
    )


def rover(ahead: float = 0.0, rock_angle: float = 30.0, **sweep: object) -> str:
    """Return a recipe of a body on four wheels of which one lifts: round contacts, with gaps.

    The centre of mass is `ahead` of the middle of the wheels, where it is on both diagonals.
    """
    wheels = "".join(
        contact(f"wheel{i}", place, 0.25, (0, 1, 0), link)
        for i, (place, link) in enumerate(
            [
                ((0.6 - ahead, 0.5, 0.0), "arm"),
                ((0.6 - ahead, -0.5, -0.4), "body"),
                ((-0.6 - ahead, 0.5, -0.4), "body"),
                ((-0.6 - ahead, -0.5, -0.45), "body"),
            ],
            1,
        )
    )
    return (
        '[robot]\nname = "rover"\nlength_unit = "m"\nupright = 90.0\n'
        f'rock_angle = {rock_angle}\n[[robot.parameter]]\nname = "lift"\n'
        'min = 0.3\nmax = 0.5\nunit = "m"\n'
        '[[robot.link]]\nname = "arm"\nparent = "body"\n'
        'joint = { type = "prismatic", axis = [0, 0, -1], parameter = "lift" }\n'
        + wheels
        + sweep_part("lift = 3", **sweep)  # type: ignore[arg-type]
    )

"""The posture in which an imported robot stands, and why that one."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from lutgen.errors import InputError
from lutgen.urdf.description import UrdfRobot
from lutgen.urdf.srdf import Srdf, beyond_limits


@dataclass(frozen=True)
class Standing:
    """Values of joints (rad, m), where they come from, and sentences on what they leave out."""

    values: dict[str, float]
    words: str
    left_out: tuple[str, ...]


def standing_posture(
    robot: UrdfRobot, srdf: Srdf | None, name: str | None, given: Mapping[str, float]
) -> Standing:
    """Return the posture to stand in: the one of that `name`, or the likeliest of the SRDF's.

    The joints that are `given`, rad or m, stand elsewhere, and all others at zero.  InputError is
    raised for a name without such a posture.
    """
    if srdf is None and name is not None:
        raise InputError(
            f"--posture: there is no SRDF file beside {robot.source} (got {name!r}); "
            "give one with --srdf, or joints with -p."
        )
    values: dict[str, float] = {}
    why = "no SRDF file names one"
    if srdf is not None:
        name = srdf.standing() if name is None else name
        known, file = ", ".join(srdf.postures) or "none", Path(srdf.source).name
        why = f"{file} names none to stand in: {known}"
        values = {} if name is None else srdf.posture(name)
    words = f"joints at zero, or at their limit nearest to it ({why})"
    if srdf is not None and name is not None:
        words = f"{name} of {file}"
    if given:
        words = f"{', '.join(given)} as given; else {words}"
    left_out = tuple(
        f"joint {joint}: at its limit, beyond which the posture is"
        for joint in beyond_limits(robot, values)
        if joint not in given
    )
    return Standing({**values, **given}, words, left_out)

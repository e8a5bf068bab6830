"""What lutgen says of a posture: asked through a recipe, as anybody would.

Owns the step from primitives back to a recipe without parameters.  Nothing of lutgen but its public
names is used, so that the same question can be put to any version of it.  "Stands or rocks" is
`tip_angle` >= 0 and nothing else.
"""

from collections.abc import Sequence

import numpy as np

import lutgen
from lutgen.recipe import Recipe
from proofs.physics.body import DISC, POINT, Floats, Posture

# The answer asks for no table, but a recipe must have a sweep.
SWEEP = '[sweep.gravity]\nchart = "cone"\nmax_tilt = 60.0\nnodes = 2\nchannels = ["tip_angle"]\n'


def as_recipe(posture: Posture, keys: str = "", rolling: Sequence[bool] = ()) -> Recipe:
    """Return a rigid robot's recipe in m, its com at the origin.

    `keys` are further lines of the table of the robot, such as its `upright`; without them the
    recipe's defaults hold.  `rolling` tells of every primitive whether it rolls; empty if none
    does.
    """
    lines = ['[robot]\nname = "judged"\nlength_unit = "m"', keys, '[[robot.link]]\nname = "body"']
    for k, kind in enumerate(posture.kind):
        lines.append(f'[[robot.contact]]\nname = "c{k}"\nlink = "body"')
        lines.append(f"position = {posture.centres[k].tolist()}")
        if kind != POINT:
            lines.append(f"radius = {float(posture.radius[k])!r}")
        if kind == DISC:
            lines.append(f"axis = {posture.axes[k].tolist()}")
        if rolling and rolling[k]:
            lines.append("rolling = true")
    return lutgen.parse_recipe("\n".join([*lines, "[sweep]", SWEEP]))


def tip_angles(recipe: Recipe, gravity_dir: Floats) -> Floats:
    """Return the tip angles (d,), rad, of a rigid robot's recipe under directions (d, 3)."""
    nothing = np.zeros((1, 0))
    return np.asarray(lutgen.evaluate(recipe, nothing, gravity_dir, ("tip_angle",))["tip_angle"][0])

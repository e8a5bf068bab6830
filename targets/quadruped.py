"""A quadruped with twelve joints and four ball feet: a robot of legs among the rows.

The sizes are those of a small walking robot, some 10 kg with shanks of 0.2 m; its four feet all
touch only where its joints are symmetric, else it rocks on three of them.
"""

from functools import lru_cache

from lutgen.recipe.recipe import Recipe, parse_recipe

# Of each leg: where its hip is (m).
LEGS = (("fl", 0.2, 0.15), ("fr", 0.2, -0.15), ("rl", -0.2, 0.15), ("rr", -0.2, -0.15))
# Of each joint: its range (deg).
JOINTS = (("roll", -30, 30), ("pitch", -20, 80), ("knee", -140, -40))
AXIS = '[[robot.parameter]]\nname = "{n}_{j}"\nmin = {low}\nmax = {high}\nunit = "deg"\n'
LEG = """
[[robot.link]]
name = "{n}_hip"
parent = "body"
origin = [{x}, {y}, 0]
joint = {{ type = "revolute", axis = [1, 0, 0], parameter = "{n}_roll" }}
[[robot.link]]
name = "{n}_thigh"
parent = "{n}_hip"
joint = {{ type = "revolute", axis = [0, 1, 0], parameter = "{n}_pitch" }}
mass = 0.6
com = [0, 0, -0.05]
[[robot.link]]
name = "{n}_shank"
parent = "{n}_thigh"
origin = [0, 0, -0.2]
joint = {{ type = "revolute", axis = [0, 1, 0], parameter = "{n}_knee" }}
[[robot.contact]]
name = "{n}"
link = "{n}_shank"
position = [0, 0, -0.2]
radius = 0.022
"""


@lru_cache
def quadruped() -> Recipe:
    """Return its recipe."""
    text = '[robot]\nname = "quadruped"\nlength_unit = "m"\n'
    text += "".join(AXIS.format(n=n, j=j, low=a, high=b) for n, _, _ in LEGS for j, a, b in JOINTS)
    text += '[[robot.link]]\nname = "body"\nmass = 6.0\ncom = [0, 0, 0]\n'
    text += "".join(LEG.format(n=n, x=x, y=y) for n, x, y in LEGS)
    samples = ", ".join(f"{n}_{j} = 2" for n, _, _ in LEGS for j, _, _ in JOINTS)
    text += f"[sweep]\nsamples = {{ {samples} }}\n[sweep.gravity]\n"
    text += 'chart = "cone"\nmax_tilt = 60.0\nnodes = 5\nchannels = ["sdg", "tip_angle"]\n'
    return parse_recipe(text)

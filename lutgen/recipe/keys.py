"""Every key of a recipe, once: what validation knows, the reference lists and the schema says.

Owns the table of the keys.  The rules between keys are those of the files that read them.
"""

from lutgen.quantities import CHANNELS
from lutgen.recipe.key import Key
from lutgen.recipe.robot_keys import ROBOT

CHARTS = ("cone", "sphere")
SIZE = r"[0-9]+(\.[0-9]+)? ?(B|[kK]i?B|Mi?B)?"
SHARE = r"[0-9]*\.?[0-9]+([eE][-+]?[0-9]+)? ?%?"

BYTES = "4 bytes a node each, `status` 1"

# In the order of the reference; "" is the file itself.
KEYS: dict[str, tuple[Key, ...]] = {
    "": (
        Key("robot", "table", "What the robot is.", "{ name = 'rover', length_unit = 'm' }"),
        Key("sweep", "table", "What its map holds.", "{ samples = { lift = 37 } }"),
        Key("export", "table", "Defaults of `lutgen export`.", "{ flash = '16KiB' }", "none"),
    ),
    **ROBOT,
    "sweep": (
        Key(
            "samples",
            "samples",
            "Of each parameter its nodes, both ends included, or its knots.",
            "{ lift = 37, reach = [0.0, 0.1, 0.4] }",
            default="needed with parameters",
            costs="the map grows with the product of all",
        ),
        Key("gravity", "table", "Which directions the map has, and what it says of them.", "{}"),
        Key(
            "channels",
            "names",
            "What the map holds; here or in `[sweep.gravity]`.",
            '["sdg", "tip_angle"]',
            default="needed here or there",
            choices=CHANNELS,
            costs=BYTES,
        ),
    ),
    "sweep.gravity": (
        Key(
            "chart",
            "text",
            "Tilts up to `max_tilt`, or every direction.",
            '"cone"',
            choices=CHARTS,
            costs="a sphere has six faces where a cone has one",
        ),
        Key(
            "max_tilt",
            "number",
            "The largest tilt of a cone; a sphere has none.",
            "60.0",
            default="needed of a cone",
            unit="deg",
            bounds="(0, 85]",
        ),
        Key(
            "nodes",
            "whole number",
            "Along a side of a face; 2 or more of a sphere.",
            "33",
            bounds="[1, )",
            costs="a face has their square",
        ),
        Key(
            "channels",
            "names",
            "What the map holds; here or in `[sweep]`.",
            '["sdg", "tip_angle"]',
            default="needed here or there",
            choices=CHANNELS,
            costs=BYTES,
        ),
    ),
    "export": (
        Key(
            "flash",
            "quantity",
            "The most bytes of tables and code: a number, or a text with B, kB, KiB or MiB.",
            '"16KiB"',
            default="no limit",
            bounds="(0, )",
            pattern=SIZE,
        ),
        Key(
            "max_error",
            "quantity",
            "The largest error of the stability factor: a length, or with % a share of its range.",
            '"1%"',
            default="no limit",
            bounds="(0, )",
            pattern=SHARE,
        ),
    ),
}


def names(table: str) -> tuple[str, ...]:
    """Return the keys that a table may have, in the order of the reference.

    Parameters
    ----------
    table : str
        Its full name without places in arrays: "" for the file, or one such as ``"robot.link"``.

    Returns
    -------
    tuple of str
        KeyError is raised for a table that recipes do not have.
    """
    return tuple(key.name for key in KEYS[table])

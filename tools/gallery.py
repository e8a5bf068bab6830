"""Draw the figures of maps into the gallery and write their numbers into the gallery's page.

    python tools/gallery.py build/maps/paper_two.h5 ... [--output maps]

The figures go to OUTPUT/<name>/*.png.  In OUTPUT/README.md only the lines between the two marker
comments of a map are written; a map without them gets a heading and markers at the end.  The same
map gives the same bytes.
"""

import argparse
import math
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from lutgen import plot
from lutgen.analysis import Posture, posture_limits
from lutgen.errors import LutgenError
from lutgen.mapping import StabilityMap, load_map, share_that_tips
from lutgen.parts import to_internal
from lutgen.recipe.recipe import Recipe
from targets.marks import between

PAGE_HEAD = "# Gallery\n"


@dataclass(frozen=True)
class Shot:
    """One figure: its file's name, its kind, what it shows, and the options of its function."""

    name: str
    kind: str
    caption: str
    options: dict[str, Any]


def shot(name: str, kind: str, caption: str, **options: Any) -> Shot:
    """Return a figure of the table."""
    return Shot(name, kind, caption, options)


def slope(degrees: float) -> tuple[float, float, float]:
    """Return gravity on ground on which the nose is uphill."""
    return (-math.tan(math.radians(degrees)), 0.0, -1.0)


GROUND: dict[str, Any] = {"convention": "plane"}
SDG: dict[str, Any] = {"channel": "sdg", **GROUND}
P1_HIGH = {"alpha": 10.0}
EVEN = {"alpha": 31.0, "gamma": 31.0}
UNEVEN = {"alpha": 20.0, "gamma": 40.0}
FLAT = {"front": -10.6, "rear": -10.6}
UP = {"front": 90.0, "rear": 90.0}
LOWERED = {"front": -60.0, "rear": 0.0}
LEANING = {"spread": 40.0, "lean": 20.0}
# The left flippers reach the ground, the right ones stand up.
UNEQUAL = {"front_left": -10.0, "front_right": 60.0, "rear_left": -10.0, "rear_right": 60.0}
RIGHT = {"params": {"front_left": 0.0, "rear_left": 0.0}, "axes": ("front_right", "rear_right")}
TWISTED = {"front": -45.0, "rear": 0.0}
STEERED = {"steer": 35.0, "roll": 6.0}
LIFTED = {"track": 0.8, "loader": 40.0}
REACHING = {"swing": 90.0, "boom": 20.0, "stick": -60.0}
# The joints of the published description; positive angles lower a front flipper's tip.
STAIRS = {
    **{"front_left_flipper_j": -40.0, "front_right_flipper_j": -40.0},
    **{"rear_left_flipper_j": 0.0, "rear_right_flipper_j": 0.0},
}
HERO: dict[str, Any] = {
    "postures": {
        "flippers up": {"front": 100.0, "rear": 100.0},
        "flippers flat": FLAT,
        "on the tips\nof its flippers": {"front": -100.0, "rear": -100.0},
    },
    "title": "One robot, three postures: how far may it lean?",
}
SHOTS: dict[str, tuple[Shot, ...]] = {
    "paper_one": (
        shot("robot", "robot", "the robot with wheel P1 low", params={"alpha": 45.0}, **GROUND),
        shot("curve", "curve", "stability factor over alpha, level ground", **SDG),
        shot("sphere", "sphere", "tip-over angle under every gravity, P1 high", params=P1_HIGH),
        shot("polar", "polar", "largest tilt per heading, P1 high", params=P1_HIGH),
    ),
    "paper_two": (
        shot("contour", "contour", "stability factor over both angles, level ground", **SDG),
        shot("surface", "surface", "the same as a landscape", **SDG),
        shot("robot", "robot", "climbing", params=UNEVEN, gravity=slope(20.0), **GROUND),
        shot("slope", "contour", "tip-over angle, climbing", gravity=slope(40.0), **GROUND),
        shot("sphere", "sphere", "tip-over angle under every gravity, even wheels", params=EVEN),
        shot("polar", "polar", "largest tilt per heading, uneven wheels", params=UNEVEN),
    ),
    "absolem": (
        shot("hero", "hero", "one robot, three postures: how far may it lean?", **HERO),
        shot("robot", "robot", "climbing", params=LOWERED, gravity=slope(20.0)),
        shot("limits", "limits", "how far it may be tilted, flippers on the ground", params=FLAT),
        shot("contour", "contour", "tip-over angle over both flipper pairs, level", **GROUND),
        shot("slope", "contour", "the same, climbing", gravity=slope(30.0), **GROUND),
        shot("sphere", "sphere", "tip-over angle, flippers on the ground", params=FLAT),
        shot("polar_up", "polar", "largest tilt per heading, flippers straight up", params=UP),
    ),
    "three_leg_sphere": (
        shot("sphere", "sphere", "tip-over angle under every gravity", params=LEANING),
        shot("robot", "robot", "leg 1 to the left", params=LEANING, **GROUND),
        shot("contour", "contour", "tip-over angle over both parameters, level ground", **GROUND),
        shot("polar", "polar", "largest tilt per heading, leg 1 to the left", params=LEANING),
    ),
    "marv": (
        shot("robot", "robot", "left flippers down, right ones up", params=UNEQUAL, **GROUND),
        shot("polar", "polar", "largest tilt per heading, the same posture", params=UNEQUAL),
        shot("contour", "contour", "tip-over angle over the right flippers", **RIGHT, **GROUND),
        shot("sphere", "sphere", "tip-over angle under every gravity", params=UNEQUAL),
    ),
    "markhor": (
        shot("robot", "robot", "raised on its front flippers", params=TWISTED, **GROUND),
        shot("limits", "limits", "how far it may be tilted", params=TWISTED),
        shot("contour", "contour", "tip-over angle over both flipper pairs, level", **GROUND),
    ),
    "articulated": (
        shot("robot", "robot", "bent to the left and twisted", params=STEERED, **GROUND),
        shot("limits", "limits", "how far it may be tilted", params=STEERED),
        shot("contour", "contour", "tip-over angle over both joints, level ground", **GROUND),
        shot("sphere", "sphere", "tip-over angle under every gravity", params=STEERED),
    ),
    "excavator": (
        shot("robot", "robot", "the arm reaches out to the left", params=REACHING, **GROUND),
        shot("limits", "limits", "how far it may be tilted", params=REACHING),
        shot("contour", "contour", "boom and stick, arm ahead", params={"swing": 0.0}, **GROUND),
        shot("aside", "contour", "the same, arm to the left", params={"swing": 90.0}, **GROUND),
    ),
    "tractor": (
        shot("robot", "robot", "the loader is up", params=LIFTED, **GROUND),
        shot("limits", "limits", "how far it may be tilted, the loader up", params=LIFTED),
        shot("contour", "contour", "rear track and loader", gravity=(0.0, 0.25, -1.0)),
    ),
    "absolem_urdf": (
        shot("robot", "robot", "front flippers up", params=STAIRS, gravity=slope(20.0)),
        shot("polar", "polar", "largest tilt per heading, the same posture", params=STAIRS),
    ),
}


def shots_of(recipe: Recipe) -> tuple[Shot, ...]:
    """Return the figures of a recipe: its entry in the table, or what fits any robot."""
    if recipe.name in SHOTS:
        return SHOTS[recipe.name]
    result = [
        shot("robot", "robot", "the robot in the middle of its ranges"),
        shot("polar", "polar", "largest tilt per heading"),
        shot("sphere", "sphere", "tip-over angle under every gravity"),
    ]
    if len(recipe.parameters) == 1:
        result.append(shot("curve", "curve", "over its parameter"))
    elif recipe.parameters:
        result.append(shot("contour", "contour", "over two parameters"))
    return tuple(result)


def row_of(recipe: Recipe, params: dict[str, float]) -> list[float]:
    """Return a posture (display units) in rad or length."""
    return [to_internal(params[p.name], p.display_unit) for p in recipe.parameters]


def draw_one(recipe: Recipe, one: Shot) -> Figure:
    """Draw a figure."""
    if one.kind == "limits":
        posture = Posture(recipe, row_of(recipe, one.options["params"]))
        return plot.draw_limits(recipe, posture_limits(posture))
    if one.kind == "hero":
        postures = {n: row_of(recipe, p) for n, p in one.options["postures"].items()}
        return plot.draw_hero(recipe, postures, one.options["title"])
    return plot.draw(one.kind, recipe, **one.options)


def draw_all(recipe: Recipe, folder: Path) -> None:
    """Draw the figures of a recipe."""
    folder.mkdir(parents=True, exist_ok=True)
    for one in shots_of(recipe):
        plot.save(draw_one(recipe, one), folder / f"{one.name}.png")


def numbers(recipe: Recipe, stability_map: StabilityMap) -> str:
    """Return a map's numbers as a line of Markdown."""
    chart = recipe.chart
    sizes = [
        *recipe.grid.shape,
        *((chart.faces,) if chart.faces > 1 else ()),
        chart.nodes,
        chart.nodes,
    ]
    nodes = f"{' x '.join(str(size) for size in sizes)} = {math.prod(sizes):,}"
    kilobytes = Path(stability_map.path).stat().st_size / 1000.0
    size = f"{kilobytes / 1000.0:.1f} MB" if kilobytes >= 1000.0 else f"{kilobytes:.0f} kB"
    tips = share_that_tips(stability_map)
    share = "" if tips is None else f", {100.0 * tips:.1f} % tip over"
    channels = ", ".join(recipe.channels)
    return f"`{recipe.digest[:12]}`: {channels}; {nodes} nodes, {size}{share}."


def block(recipe: Recipe, stability_map: StabilityMap) -> str:
    """Return what stands between the markers of a map."""
    lines = [numbers(recipe, stability_map), ""]
    for each in shots_of(recipe):
        wide = each.kind == "hero"
        alt = f"{recipe.name}: {each.caption}"
        lines.append(
            f'<img src="{recipe.name}/{each.name}.png" width="{"98%" if wide else "49%"}" '
            f'alt="{alt}" title="{alt}">'
        )
    return "\n".join(lines)


def write_page(page: Path, name: str, text: str) -> None:
    """Bring one map's part of the page up to date; a map without one gets it at the end."""
    old = page.read_text(encoding="utf-8") if page.exists() else PAGE_HEAD
    begin, end = f"<!-- {name} -->", f"<!-- end of {name} -->"
    if begin not in old:
        new = f"{old.rstrip()}\n\n## {name}\n\n{begin}\n\n{end}\n"
        page.write_text(new, encoding="utf-8")
    between(page, name, text)


def main(arguments: list[str] | None = None) -> int:
    """Run the command."""
    parser = argparse.ArgumentParser(description="Draw the gallery's figures of maps.")
    parser.add_argument("maps", nargs="+", metavar="map", help="build/maps/NAME.h5")
    parser.add_argument("--output", type=Path, default=Path(__file__).resolve().parents[1] / "maps")
    options = parser.parse_args(arguments)
    try:
        for path in options.maps:
            stability_map = load_map(path)
            recipe = stability_map.recipe
            draw_all(recipe, options.output / recipe.name)
            write_page(options.output / "README.md", recipe.name, block(recipe, stability_map))
    except LutgenError as error:
        print(f"gallery: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

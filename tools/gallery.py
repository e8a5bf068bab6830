"""Draw the figures of one map into the gallery and write its numbers into the gallery's page.

    python tools/gallery.py maps/paper_two.toml build/maps/paper_two.h5 [--output maps]

The figures go to OUTPUT/<name>/*.png.  In OUTPUT/README.md only the lines between the two marker
comments of the map are written; a map without them gets a heading and markers at the end.  The
same recipe and map give the same bytes.
"""

import argparse
import fcntl
import math
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from lutgen import plot
from lutgen.analysis import Posture, even_headings, posture_limits, sweep_limits
from lutgen.errors import InputError, LutgenError
from lutgen.files import write_text
from lutgen.mapping import StabilityMap, load_map, share_that_tips
from lutgen.parts import to_internal
from lutgen.recipe.recipe import Recipe, load_recipe

# Dots per inch: a figure is one column (3.5 in) wide and stays below 200 kB.
RESOLUTION = 160
WIDE_RESOLUTION = 120
# Of the envelope of all postures.
HEADINGS = 72
PAGE_HEAD = "# Gallery\n"
# Kinds that are drawn from the recipe.
EXACT = ("robot", "polar", "metrics")


@dataclass(frozen=True)
class Shot:
    """One figure: its file's name, its kind, what it shows, and the options of `lutgen.plot.draw`.

    An `exact` one is drawn from the recipe, for maps with few nodes along an axis.
    """

    name: str
    kind: str
    caption: str
    options: dict[str, Any]
    exact: bool = False


def shot(name: str, kind: str, caption: str, exact: bool = False, **options: Any) -> Shot:
    """Return a figure of the table."""
    return Shot(name, kind, caption, options, exact)


# Slopes are nodes of the maps, so that the pictures show stored values.
CLIMB_41 = (-math.tan(math.radians(60.0)) / 2.0, 0.0, -1.0)
CLIMB_49 = (-math.tan(math.radians(75.0)) * 5.0 / 16.0, 0.0, -1.0)
P1_HIGH = {"alpha": 10.0}
EVEN = {"alpha": 31.0, "gamma": 31.0}
UNEVEN = {"alpha": 20.0, "gamma": 40.0}
FLAT = {"front": -10.6, "rear": -10.6}
UP = {"front": 90.0, "rear": 90.0}
STEP = {"front": 45.0, "rear": -10.6}
LEANING = {"spread": 40.0, "lean": 20.0}
# The left flippers reach the ground, the right ones stand up.
UNEQUAL = {"front_left": -10.0, "front_right": 60.0, "rear_left": -10.0, "rear_right": 60.0}
LEFT_DOWN = {"front_left": 0.0, "rear_left": 0.0}
TWISTED = {"front": -45.0, "rear": 0.0}
STEERED = {"steer": 35.0, "roll": 6.0}
REACHING = {"swing": 90.0, "boom": 20.0, "stick": -60.0}
FORWARD = {"swing": 0.0}
# Degrees: two figures that are compared.
ARM_SCALE = (18.0, 42.0)
# The joints of the published description; positive angles lower a front flipper's tip.
STAIRS = {
    **{"front_left_flipper_j": -40.0, "front_right_flipper_j": -40.0},
    **{"rear_left_flipper_j": 0.0, "rear_right_flipper_j": 0.0},
}
TIP: dict[str, Any] = {"channel": "tip_angle"}
RIGHT: dict[str, Any] = {"params": LEFT_DOWN, "axes": ("front_right", "rear_right"), **TIP}
SHOTS: dict[str, tuple[Shot, ...]] = {
    "paper_one": (
        shot("robot", "robot", "the robot with wheel P1 low", params={"alpha": 45.0}),
        shot("curve", "curve", "stability factor and height over alpha, level ground"),
        shot("sphere", "sphere", "stability factor over gravity, P1 high", params=P1_HIGH),
        shot("polar", "polar", "largest tilt per heading, P1 high", params=P1_HIGH),
    ),
    "paper_two": (
        shot("contour", "contour", "stability factor over both angles, level ground"),
        shot("surface", "surface", "the same as a surface"),
        shot("robot", "robot", "the robot climbing", params=UNEVEN, gravity=(-0.35, 0.0, -1.0)),
        shot("slope", "contour", "stability factor, climbing steeply", gravity=CLIMB_41),
        shot("sphere", "sphere", "stability factor over gravity, even wheels", params=EVEN),
        shot("polar", "polar", "largest tilt per heading, uneven wheels", params=UNEVEN),
    ),
    "absolem": (
        shot("robot", "robot", "the robot on a slope", params=STEP, gravity=(-0.5, 0.2, -1.0)),
        shot("contour", "contour", "tip-over angle over both flipper pairs, level ground", **TIP),
        shot("slope", "contour", "tip-over angle, climbing steeply", gravity=CLIMB_49, **TIP),
        shot("sphere", "sphere", "tip-over angle, flippers on the ground", params=FLAT, **TIP),
        shot("polar_up", "polar", "largest tilt per heading, flippers straight up", params=UP),
        shot("limits", "limits", "the same, flippers on the ground, and all postures", params=FLAT),
    ),
    "three_leg_sphere": (
        shot("sphere", "sphere", "stability factor over all of gravity", params=LEANING),
        shot("robot", "robot", "leg 1 to the left", params=LEANING, gravity=(0.25, 0.1, -1.0)),
        shot("contour", "contour", "tip-over angle over both parameters, level ground", **TIP),
        shot("polar", "polar", "largest tilt per heading, leg 1 to the left", params=LEANING),
    ),
    "marv": (
        shot("robot", "robot", "left flippers down, right ones up", params=UNEQUAL),
        shot("polar", "polar", "largest tilt per heading, the same posture", params=UNEQUAL),
        shot("contour", "contour", "tip-over angle over the right flippers", True, **RIGHT),
        shot("sphere", "sphere", "tip-over angle over gravity", params=UNEQUAL, **TIP),
    ),
    "markhor": (
        shot("robot", "robot", "raised on its front flippers", params=TWISTED),
        shot("limits", "limits", "largest tilts, and those of all postures", params=TWISTED),
        shot("contour", "contour", "tip-over angle over both flipper pairs, level ground", **TIP),
        shot("metrics", "metrics", "measures of stability over the heading", params=TWISTED),
    ),
    "articulated": (
        shot("robot", "robot", "bent to the left and twisted", params=STEERED),
        shot("limits", "limits", "largest tilts, and those of all postures", params=STEERED),
        shot("contour", "contour", "tip-over angle over both joints, level ground", **TIP),
        shot("sphere", "sphere", "tip-over angle over gravity", params=STEERED, **TIP),
    ),
    "excavator": (
        shot("robot", "robot", "the arm reaches out to the left", params=REACHING),
        shot("limits", "limits", "largest tilts, and those of all postures", params=REACHING),
        shot(
            "contour",
            "contour",
            "tip-over angle over boom and stick, arm forward",
            params=FORWARD,
            scale=ARM_SCALE,
            **TIP,
        ),
        shot(
            "aside",
            "contour",
            "the same with the arm to the left",
            params={"swing": 90.0},
            scale=ARM_SCALE,
            **TIP,
        ),
    ),
    "absolem_urdf": (
        shot("robot", "robot", "front flippers up", params=STAIRS, gravity=(-0.4, 0.1, -1.0)),
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
    ]
    channel = next((name for name in recipe.channels if name != "facet"), "sdg")
    if recipe.chart.nodes > 1:
        result.append(shot("sphere", "sphere", "over gravity", channel=channel))
    if len(recipe.parameters) == 1:
        result.append(shot("curve", "curve", "over its parameter", channel=channel))
    elif recipe.parameters:
        result.append(shot("contour", "contour", "over two parameters", channel=channel))
    return tuple(result)


def limits_figure(recipe: Recipe, params: dict[str, float]) -> Figure:
    """Draw the limits of a posture (display units) and of all postures of the sweep."""
    posture = [to_internal(params[p.name], p.display_unit) for p in recipe.parameters]
    rows = recipe.grid.params(range(recipe.grid.size))
    swept = sweep_limits(recipe, rows, even_headings(HEADINGS))
    return plot.draw_limits(recipe, posture_limits(Posture(recipe, posture)), swept)


def draw_all(recipe: Recipe, stability_map: StabilityMap, folder: Path) -> None:
    """Draw the figures of a map."""
    folder.mkdir(parents=True, exist_ok=True)
    for each in shots_of(recipe):
        if each.kind == "limits":
            figure = limits_figure(recipe, **each.options)
        else:
            source = recipe if each.kind in EXACT or each.exact else stability_map
            figure = plot.draw(each.kind, source, **each.options)
        dpi = RESOLUTION if figure.get_figwidth() < 5.0 else WIDE_RESOLUTION
        plot.save(figure, folder / f"{each.name}.png", dpi=dpi)


def numbers(recipe: Recipe, stability_map: StabilityMap) -> list[str]:
    """Return the table of a map's numbers, as lines of Markdown."""
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
    where = "all directions" if chart.kind == "sphere" else "the cone's directions"
    tips = share_that_tips(stability_map)
    share = "-" if tips is None else f"{100.0 * tips:.1f} % of all postures x {where}"
    return [
        "| recipe | channels | nodes | file | tips over |",
        "|---|---|---|---|---|",
        f"| `{recipe.digest[:12]}` | {', '.join(recipe.channels)} | {nodes} | {size} | {share} |",
    ]


def block(recipe: Recipe, stability_map: StabilityMap) -> str:
    """Return what stands between the markers of a map."""
    lines = [*numbers(recipe, stability_map), ""]
    for each in shots_of(recipe):
        wide = each.kind == "sphere" and recipe.chart.kind == "sphere"
        alt = f"{recipe.name}: {each.caption}"
        lines.append(
            f'<img src="{recipe.name}/{each.name}.png" width="{"98%" if wide else "49%"}" '
            f'alt="{alt}" title="{alt}">'
        )
    return "\n".join(lines)


def with_block(page: str, name: str, text: str) -> str:
    """Return a page with the text between the markers of a map replaced."""
    begin, end = f"<!-- gallery {name} -->", f"<!-- end of {name} -->"
    if page.count(begin) != 1 or page.count(end) != 1 or page.index(begin) > page.index(end):
        if begin in page or end in page:
            raise InputError(
                f"README.md: the markers of {name} are damaged (got {page.count(begin)} x "
                f"'{begin}' and {page.count(end)} x '{end}'); write each once, in this order."
            )
        page = f"{page.rstrip()}\n\n## {name}\n\n{begin}\n{end}\n"
    before, _, rest = page.partition(begin)
    return f"{before}{begin}\n{text}\n{end}{rest.partition(end)[2]}"


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Keep other processes of a parallel make away from the page."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def write_page(page: Path, name: str, text: str) -> None:
    """Bring one map's part of the page up to date."""
    with locked(page.parent):
        old = page.read_text(encoding="utf-8") if page.exists() else PAGE_HEAD
        new = with_block(old, name, text)
        if new != old or not page.exists():
            write_text(page, new, force=True)


def main(arguments: list[str] | None = None) -> int:
    """Run the command."""
    parser = argparse.ArgumentParser(description="Draw the gallery's figures of one map.")
    parser.add_argument("recipe", help="maps/NAME.toml")
    parser.add_argument("map", help="the map swept from it")
    parser.add_argument("--output", type=Path, default=Path(__file__).resolve().parents[1] / "maps")
    options = parser.parse_args(arguments)
    try:
        recipe = load_recipe(options.recipe)
        stability_map = load_map(options.map)
        if stability_map.recipe.digest != recipe.digest:
            raise InputError(
                f"{options.map}: was swept from another recipe than {options.recipe} (got digest "
                f"{stability_map.recipe.digest[:12]} and {recipe.digest[:12]}); sweep it again."
            )
        draw_all(recipe, stability_map, options.output / recipe.name)
        write_page(options.output / "README.md", recipe.name, block(recipe, stability_map))
    except LutgenError as error:
        print(f"gallery: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""`lutgen stance`: whether feet on uneven ground hold a weight."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from lutgen.cli import options as given
from lutgen.cli.lazy import analysis, charts, np
from lutgen.cli.options import FigureOptions, command, option
from lutgen.cli.output import TIPS, aligned, cell, entries, save_figure, show, unit_text

SAID = {True: "holds", False: "does not hold", None: "undecided, at the limit of friction"}
# The frame's own axes have names.
AXES = {(1.0, 0.0, 0.0): "x", (0.0, 1.0, 0.0): "y", (0.0, 0.0, 1.0): "z"}


@dataclass(frozen=True)
class Options(FigureOptions):
    gravity: tuple[float, float, float] | None = option(
        "-g",
        type=given.Numbers(*given.DIRECTION, nonzero=True),
        help="Gravity in the frame of the file, pointing down; instead of the file's.",
    )
    output: str | None = given.output(help="Figure (PNG, SVG or PDF).")
    as_json: bool = given.as_json()


@command("file", Options)
def stance(file: str, options: Options) -> None:
    """Print whether feet on uneven ground hold a weight.

    FILE (TOML) describes them and the centre of mass.  Each foot has a place, a normal and a
    friction coefficient of its own.  Exit code 3 where no forces within the friction cones carry
    the weight, or where that cannot be told.

    \b
    $ lutgen stance stair.toml -g 0.1,0,-1
    stair: holds
    """
    footing = analysis.read_footing(file)
    if options.gravity is not None:
        footing = replace(footing, gravity_dir=np.array(options.gravity))
    found = footing.equilibrium()
    save_figure(lambda plot: plot.draw_footing(footing, found), options.output, options)
    # Lengths are in the file's unit, forces shares of the weight.
    report = {
        **entries(footing, "title length_unit gravity=gravity_dir com"),
        **entries(found, "holds margin axes region region_is_open=is_open"),
        "feet": [*feet(footing, found)],
    }
    show(report, stance_lines, options.as_json, 0 if found.holds else TIPS)


def feet(footing: "analysis.Footing", found: "analysis.Equilibrium") -> Iterator[dict[str, Any]]:
    """Return one entry for each foot; null where the weight is not held."""
    for i, up in enumerate(charts.unit_directions(footing.normals)):
        mu = float(footing.friction[i])
        force = normal = used = None
        if found.forces is not None:
            force = found.forces[i]
            normal = float(force @ up)
            along = float(np.linalg.norm(force - normal * up))
            # A foot that carries nothing uses no friction, nor does one that has none.
            used = along / (mu * normal) if mu * normal > 1e-9 else 0.0
        yield {
            "name": footing.names[i],
            "friction": mu,
            "normal_force": normal,
            "force": force,
            "friction_used": used,
        }


def stance_lines(report: dict[str, Any]) -> Iterator[str]:
    """Return the report as text."""
    unit = unit_text(report["length_unit"])
    yield f"{report['title']}: {SAID[report['holds']]}"
    rows = [["margin", length(report["margin"], unit)]]
    for i, axis in enumerate(report["axes"]):
        name = AXES.get(tuple(axis)) or ",".join(length(x, form=".3g") for x in axis)
        at = sum(a * b for a, b in zip(axis, report["com"], strict=True))
        text = f"com at {length(at, unit)}"
        if report["region"]:
            along = [corner[i] for corner in report["region"]]
            text += f", may lie from {length(min(along))} to {length(max(along), unit)}"
        rows.append([f"along {name}", text])
    count = len(report["region"])
    shape = {0: "none", 1: "a point", 2: "a line"}.get(count, f"{count} corners")
    is_open = ", open within the search" if report["region_is_open"] else ""
    yield from aligned([*rows, ["region", shape + is_open]])
    rows = [["foot", "friction", "normal force", "friction used"]]
    for foot in report["feet"]:
        used = foot["friction_used"]
        used = "-" if used is None else f"{100.0 * used:.0f} %"
        force = length(foot["normal_force"], form=".3f")
        rows.append([foot["name"], f"{foot['friction']:g}", force, used])
    yield from aligned(rows)


def length(value: float | None, unit: str = "", form: str = ".4g") -> str:
    """Return a number as text; a linear program leaves more of zero than a sum does."""
    return cell(0.0 if value is not None and abs(value) < 1e-9 else value, form, unit)

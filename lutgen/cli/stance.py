"""`lutgen stance`: whether feet on uneven ground hold a weight."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli import options
from lutgen.cli.options import Named, asks, option
from lutgen.cli.table import TIPS, aligned, cell, even, number, show, unit_text

if TYPE_CHECKING:
    from lutgen.analysis import Equilibrium, Footing

SAID = {True: "holds", False: "does not hold", None: "undecided, at the limit of friction"}
# What a linear program leaves of zero is larger than what a sum leaves.
_even = partial(even, rounding=1e-9)
# The frame's own axes have names.
AXES = {(1.0, 0.0, 0.0): "x", (0.0, 1.0, 0.0): "y", (0.0, 0.0, 1.0): "z"}


@dataclass(frozen=True)
class Asked:
    """What the command line says."""

    gravity: tuple[float, float, float] | None = option(
        "-g",
        type=options.Numbers("X,Y,Z", "direction", "three numbers such as 0,0,-1", nonzero=True),
        help="Gravity in the frame of the file, pointing down; instead of the file's.",
    )
    as_json: bool = options.as_json()
    output: str | None = options.output(help="Figure (PNG, SVG or PDF).")
    size: str | None = options.size()
    style: str = options.style()
    force: bool = options.force()


@click.command(short_help="Whether feet on uneven ground hold a weight.")
@click.argument("file", type=Named())
@asks(Asked)
def stance(file: str, asked: Asked) -> None:
    """Print whether the feet that FILE (TOML) describes hold its centre of mass.

    Each foot has a place, a normal and a friction coefficient of its own.  Exit code 3 where no
    forces within the friction cones carry the weight, or where that cannot be told.

    \b
    $ lutgen stance stair.toml -g 0.1,0,-1
    stair: holds
    """
    from lutgen.cli.footing import read_footing

    footing = read_footing(file)
    if asked.gravity is not None:
        import numpy as np

        footing = replace(footing, gravity_dir=np.array(asked.gravity))
    found = footing.equilibrium()
    if asked.output is not None:
        from lutgen.plot import draw_footing, on_sheet, save

        with on_sheet(asked.size, asked.style):
            save(draw_footing(footing, found), asked.output, force=asked.force)
    report = stance_report(footing, found)
    show(report, stance_lines(footing, found), asked.as_json, bool(found.holds), TIPS)


def stance_report(footing: "Footing", found: "Equilibrium") -> dict[str, Any]:
    """Return what `--json` prints; lengths in the file's unit, forces as shares of the weight."""
    return {
        "title": footing.title,
        "length_unit": footing.length_unit,
        "gravity": footing.gravity_dir.tolist(),
        "com": footing.com.tolist(),
        "holds": found.holds,
        "margin": number(found.margin),
        "axes": found.axes.tolist(),
        "region": found.region.tolist(),
        "region_is_open": found.is_open,
        "feet": list(_feet(footing, found)),
    }


def _feet(footing: "Footing", found: "Equilibrium") -> Iterator[dict[str, Any]]:
    """Return one entry for each foot; null where the weight is not held."""
    import numpy as np

    from lutgen.chart import unit_directions

    normals = unit_directions(footing.normals)
    for i, name in enumerate(footing.names):
        mu = float(footing.friction[i])
        force = normal = used = None
        if found.forces is not None:
            normal = float(found.forces[i] @ normals[i])
            along = float(np.linalg.norm(found.forces[i] - normal * normals[i]))
            force = found.forces[i].tolist()
            # A foot that carries nothing uses no friction, nor does one that has none.
            used = along / (mu * normal) if mu * normal > 1e-9 else 0.0
        yield {
            "name": name,
            "friction": mu,
            "normal_force": normal,
            "force": force,
            "friction_used": used,
        }


def stance_lines(footing: "Footing", found: "Equilibrium") -> Iterator[str]:
    """Return the report as text."""
    unit = unit_text(footing.length_unit)
    yield f"{footing.title}: {SAID[found.holds]}"
    rows = [["margin", cell(_even(number(found.margin)), ".4g", unit)]]
    yield from aligned([*rows, *_extent(footing, found, unit)])
    rows = [["foot", "friction", "normal force", "friction used"]]
    for foot in _feet(footing, found):
        normal, used = foot["normal_force"], foot["friction_used"]
        used = "-" if used is None else f"{100.0 * used:.0f} %"
        rows.append([foot["name"], f"{foot['friction']:g}", cell(_even(normal), ".3f"), used])
    yield from aligned(rows)


def _extent(footing: "Footing", found: "Equilibrium", unit: str) -> Iterator[list[str]]:
    """Return where the com is along each axis of the region, and how far that extends."""
    for i, axis in enumerate(found.axes):
        name = AXES.get(tuple(axis.tolist())) or ",".join(f"{_even(x):.3g}" for x in axis.tolist())
        text = f"com at {_even(float(axis @ footing.com)):.4g}{unit}"
        if len(found.region):
            low, high = found.region[:, i].min(), found.region[:, i].max()
            text += f", may lie from {_even(low):.4g} to {_even(high):.4g}{unit}"
        yield [f"along {name}", text]
    kinds = {0: "none", 1: "a point", 2: "a line"}
    shape = kinds.get(len(found.region), f"{len(found.region)} corners")
    yield ["region", shape + (", open within the search" if found.is_open else "")]

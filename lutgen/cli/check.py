"""`lutgen check`: validate a recipe and say what its sweep will cost."""

import json

import click

from lutgen.cli.options import allow_python, as_json, file_size


@click.command(short_help="Validate a recipe; print robot, nodes, file size and run time.")
@click.argument("recipe", type=click.Path())
@allow_python
@as_json
def check(recipe: str, allow_python: bool, as_json: bool) -> None:
    """Validate RECIPE and say what its sweep will cost.

    \b
    $ lutgen check maps/paper_two.toml
    paper_two: 3 contacts (P1 P2 P3), 2 parameters, unit 1
    """
    from lutgen.mapping import expected_seconds, plan, require_standing
    from lutgen.recipe import load_recipe

    robot = load_recipe(recipe, allow_python=allow_python)
    require_standing(robot)
    layout = plan(robot)
    values = layout.nodes * len(robot.channels)
    size = 4 * layout.count * layout.chunk_nodes * len(robot.channels)
    seconds = expected_seconds(robot)
    axes = {
        p.name: {
            "from": _shown(axis.knots[0], p.display_unit),
            "to": _shown(axis.knots[-1], p.display_unit),
            "unit": p.display_unit,
            "nodes": axis.size,
        }
        for p, axis in zip(robot.parameters, robot.grid.axes, strict=True)
    }
    if as_json:
        report = {
            "name": robot.name,
            "digest": robot.digest,
            "length_unit": robot.length_unit,
            "contacts": list(robot.contact_names),
            "parameters": axes,
            "chart": {"kind": robot.chart.kind, "shape": list(robot.chart.shape)},
            "channels": list(robot.channels),
            "nodes": layout.nodes,
            "file_bytes": size,
            "seconds": round(seconds, 3),
        }
        click.echo(json.dumps(report, indent=2))
        return
    names = " ".join(robot.contact_names)
    click.echo(
        f"{robot.name}: {len(robot.contact_names)} contacts ({names}), "
        f"{len(axes)} parameters, unit {robot.length_unit}"
    )
    for name, axis in axes.items():
        click.echo(
            f"  {name}: {axis['from']:g} to {axis['to']:g} {axis['unit']}, {axis['nodes']} nodes"
        )
    faces, side, _ = robot.chart.shape
    click.echo(f"  gravity: {robot.chart.kind}, {faces} face(s) of {side} x {side} nodes")
    click.echo(f"  channels: {' '.join(robot.channels)}")
    click.echo(
        f"sweep: {layout.nodes:,} nodes, {values:,} values, {file_size(size)}, "
        f"about {seconds:.1f} s of computing"
    )


def _shown(value: float, unit: str) -> float:
    import math

    return round(math.degrees(value), 9) if unit == "deg" else float(value)

"""`lutgen info`: what a map file holds."""

import json
import math
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli.options import as_json

if TYPE_CHECKING:
    from lutgen.mapping import StabilityMap


@click.command(short_help="Print what a map file holds; --verify its checksums.")
@click.argument("map_file", metavar="MAP.h5", type=click.Path())
@click.option("--verify", is_flag=True, help="Read everything and check every checksum.")
@as_json
def info(map_file: str, verify: bool, as_json: bool) -> None:
    """Print axes, channels, ranges, the share of directions that tip, and provenance.

    \b
    $ lutgen info paper_two.h5 --verify
    """
    from lutgen.errors import MapFileError
    from lutgen.mapping import load_map
    from lutgen.mapping import verify as check_all

    stability_map = load_map(map_file)
    if verify:
        try:
            check_all(stability_map)
        except MapFileError as error:
            raise click.ClickException(str(error)) from error
    report = describe(stability_map)
    if verify:
        report["verified"] = True
    if as_json:
        click.echo(json.dumps(report, indent=2))
        return
    click.echo(f"{report['title']} (format {report['format']}, lutgen {report['lutgen_version']})")
    for axis in report["axes"]:
        click.echo(
            f"  {axis['name']}: {axis['from']:g} to {axis['to']:g} {axis['unit']}, "
            f"{axis['nodes']} nodes"
        )
    faces, side, _ = report["chart"]["shape"]
    click.echo(f"  gravity: {report['chart']['kind']}, {faces} face(s) of {side} x {side} nodes")
    for channel in report["channels"]:
        low, high = (f"{channel[k]:.6g}" if channel[k] is not None else "-" for k in ("min", "max"))
        click.echo(f"  {channel['name']}: {low} to {high} {channel['unit']}")
    if report["share_that_tips"] is not None:
        click.echo(f"  tips: {100.0 * report['share_that_tips']:.2f} % of directions (by area)")
    click.echo(f"  recipe sha256: {report['recipe_sha256']}")
    if verify:
        click.echo("  checksums: all good")


def describe(stability_map: "StabilityMap") -> dict[str, Any]:
    """Return the contents of `lutgen info --json`."""
    from lutgen.mapping import channel_range, channel_unit, share_that_tips

    recipe = stability_map.recipe
    axes = []
    for parameter, axis in zip(recipe.parameters, stability_map.axes, strict=True):
        ends = [float(axis.knots[0]), float(axis.knots[-1])]
        if parameter.display_unit == "deg":
            ends = [round(math.degrees(value), 9) for value in ends]
        axes.append(
            {
                "name": axis.name,
                "unit": parameter.display_unit,
                "from": ends[0],
                "to": ends[1],
                "nodes": axis.size,
            }
        )
    channels = []
    for name in stability_map.channels:
        low, high = channel_range(stability_map, name)
        unit = channel_unit(name, recipe.length_unit)
        if unit == "rad" and low is not None and high is not None:
            low, high, unit = math.degrees(low), math.degrees(high), "deg"
        channels.append({"name": name, "unit": unit, "min": low, "max": high})
    return {
        "title": str(stability_map.attributes["title"]),
        "format": int(stability_map.attributes["lutgen_format"]),
        "lutgen_version": str(stability_map.attributes["lutgen_version"]),
        "robot": recipe.name,
        "length_unit": recipe.length_unit,
        "axes": axes,
        "chart": {"kind": recipe.chart.kind, "shape": list(recipe.chart.shape)},
        "channels": channels,
        "share_that_tips": share_that_tips(stability_map),
        "recipe_sha256": str(stability_map.attributes["recipe_sha256"]),
    }

"""`lutgen info`: what a map file holds."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli.check import axis_entry, grid_lines
from lutgen.cli.options import Named, as_json, asks, option
from lutgen.cli.table import cell, show
from lutgen.quantities import QUANTITIES

if TYPE_CHECKING:
    from lutgen.mapping import StabilityMap


@dataclass(frozen=True)
class Asked:
    """What the command line says."""

    verify: bool = option(is_flag=True, help="Read everything and check every checksum.")
    unsealed: bool = option(is_flag=True, help="Read a file without a digest, too.")
    as_json: bool = as_json()


@click.command(short_help="Print what a map file holds; --verify its checksums.")
@click.argument("map_file", metavar="MAP.h5", type=Named())
@asks(Asked)
def info(map_file: str, asked: Asked) -> None:
    """Print axes, channels, ranges, the share of directions that tip, and provenance.

    \b
    $ lutgen info paper_two.h5 --verify
    """
    from lutgen.errors import MapFileError
    from lutgen.mapping import load_map, verify

    stability_map = load_map(map_file, asked.unsealed)
    if asked.verify:
        try:
            verify(stability_map)
        except MapFileError as error:
            raise click.ClickException(str(error)) from error
    report = info_report(stability_map)
    if asked.verify:
        report["verified"] = True
    show(report, info_lines(report), asked.as_json)


def info_report(stability_map: "StabilityMap") -> dict[str, Any]:
    """Return what `--json` prints."""
    from lutgen.mapping import channel_range, share_that_tips

    recipe, attributes = stability_map.recipe, stability_map.attributes
    channels = []
    for name in stability_map.channels:
        low, high = channel_range(stability_map, name)
        one, unit = QUANTITIES[name], QUANTITIES[name].stored_unit(recipe.length_unit)
        if low is not None and high is not None:
            low, high, unit = one.shown(low), one.shown(high), one.shown_unit(recipe.length_unit)
        entry = {"name": name, "unit": unit, "min": low, "max": high}
        if one.words and low is not None and high is not None:
            entry |= {"unit": "", "min": one.word(low), "max": one.word(high)}
        channels.append(entry)
    return {
        "title": str(attributes["title"]),
        "format": int(attributes["lutgen_format"]),
        "definition": int(attributes["lutgen_definition"]),
        "lutgen_version": str(attributes["lutgen_version"]),
        "robot": recipe.name,
        "length_unit": recipe.length_unit,
        "axes": [
            {"name": axis.name, **axis_entry(parameter, axis)}
            for parameter, axis in zip(recipe.parameters, stability_map.axes, strict=True)
        ],
        "chart": {"kind": recipe.chart.kind, "shape": list(recipe.chart.shape)},
        "channels": channels,
        "share_that_tips": share_that_tips(stability_map),
        "recipe_sha256": str(attributes["recipe_sha256"]),
    }


def info_lines(report: dict[str, Any]) -> Iterator[str]:
    """Return the report as text."""
    yield f"{report['title']} (format {report['format']}, lutgen {report['lutgen_version']})"
    yield from grid_lines({axis["name"]: axis for axis in report["axes"]}, report["chart"])
    for channel in report["channels"]:
        low, high = (
            end if isinstance(end, str) else cell(end) for end in (channel["min"], channel["max"])
        )
        yield f"  {channel['name']}: {low} to {high} {channel['unit']}".rstrip()
    if report["share_that_tips"] is not None:
        yield f"  tips: {100.0 * report['share_that_tips']:.2f} % of directions (by area)"
    yield f"  recipe sha256: {report['recipe_sha256']}"
    if "verified" in report:
        yield "  checksums: all good"

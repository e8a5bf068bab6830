"""`lutgen sweep` and `lutgen info`: compute a map, and say what a map file holds."""

import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from lutgen.cli import options as given
from lutgen.cli.lazy import maps, robots
from lutgen.cli.options import RecipeOptions, command, log, option
from lutgen.cli.output import cell, entries, file_size, show
from lutgen.cli.recipes import axis_entry, grid_lines
from lutgen.errors import MapFileError
from lutgen.quantities import QUANTITIES


@dataclass(frozen=True)
class SweepOptions(RecipeOptions):
    output: str = given.output("The map file (HDF5).", required=True)
    force: bool = option(
        "Replace what is there: unfinished work, or a file that lutgen did not make."
    )
    threads: int | None = option("Threads to compute with.  [default: all]")
    resume: bool = option("Go on with an interrupted sweep of the same recipe.")
    engine: str = option("Where blocks are computed: local or dask.", default="local")
    scheduler: str | None = option("A running dask scheduler, tcp://HOST:8786.", metavar="ADDR")


@dataclass(frozen=True)
class InfoOptions:
    verify: bool = option("Read everything and check every checksum.")
    unsealed: bool = option("Read a file without a digest, too.")


@command("recipe", SweepOptions)
def sweep(robot: "robots.Recipe", options: SweepOptions) -> None:
    """Compute the map of RECIPE into an HDF5 file.

    The file appears under its name when it is whole.  A sweep that is stopped, by Ctrl-C, a kill
    or a power cut, leaves OUTPUT.part, from which `--resume` goes on; only `--force` begins anew.

    \b
    $ lutgen sweep maps/paper_two.toml -o paper_two.h5
    """
    quiet = bool(click.get_current_context().find_root().params.get("quiet"))
    start = time.perf_counter()
    # click draws the bar on a terminal only; elsewhere it prints nothing but the label.
    bar: Any
    with click.progressbar(
        length=0,
        label=robot.name,
        file=sys.stderr,
        item_show_func=lambda rate: str(rate or ""),
        hidden=quiet or not sys.stderr.isatty(),
    ) as bar:

        def progress(done: int, total: int) -> None:
            bar.length = total
            rate = done / (time.perf_counter() - start) / 1e6
            bar.update(done - bar.pos, f"{rate:.1f} M nodes/s")

        try:
            maps.sweep(
                robot,
                options.output,
                progress=progress,
                **entries(options, "threads resume engine scheduler force"),
            )
        except KeyboardInterrupt:
            begun = Path(f"{options.output}.part").exists()
            raise click.ClickException(
                f"interrupted; {options.output}.part holds what is done: go on with --resume"
                if begun
                else "interrupted before the first block; nothing is left behind"
            ) from None
    seconds, size = time.perf_counter() - start, Path(options.output).stat().st_size
    if not quiet:
        click.echo(f"{options.output}: {file_size(size)} in {seconds:.2f} s", err=True)
    log.info("recipe digest %s", robot.digest)
    report = {
        **entries(robot, "robot=name digest"),
        "map": options.output,
        **entries(robot, "nodes channels"),
        "bytes": size,
        "seconds": round(seconds, 3),
    }
    show(report, lambda _: ())


MAP = click.Argument(["map_file"], metavar="MAP.h5", type=given.Named())


@command(MAP, InfoOptions)
def info(map_file: str, options: InfoOptions) -> None:
    """Print what a map file holds; --verify its checksums.

    Axes, channels, their ranges, the share of directions that tip over, and provenance.

    \b
    $ lutgen info paper_two.h5 --verify
    """
    stability_map = maps.load_map(map_file, options.unsealed)
    if options.verify:
        try:
            maps.verify(stability_map)
        except MapFileError as error:
            raise click.ClickException(str(error)) from error
    recipe, attributes = stability_map.recipe, stability_map.attributes
    report = {
        "title": str(attributes["title"]),
        "format": int(attributes["lutgen_format"]),
        "definition": int(attributes["lutgen_definition"]),
        "lutgen_version": str(attributes["lutgen_version"]),
        **entries(recipe, "robot=name length_unit"),
        "axes": [
            {"name": axis.name, **axis_entry(parameter, axis)}
            for parameter, axis in zip(recipe.parameters, stability_map.axes, strict=True)
        ],
        "chart": entries(recipe.chart, "kind shape"),
        "channels": [channel_entry(stability_map, name) for name in stability_map.channels],
        "share_that_tips": maps.share_that_tips(stability_map),
        "recipe_sha256": str(attributes["recipe_sha256"]),
        **({"verified": True} if options.verify else {}),
    }
    show(report, info_lines)


def channel_entry(stability_map: "maps.StabilityMap", name: str) -> dict[str, Any]:
    """Return the range of a channel; nulls where it has no number at all."""
    low, high = maps.channel_range(stability_map, name)
    one, length = QUANTITIES[name], stability_map.recipe.length_unit
    if low is None or high is None:
        return {"name": name, "unit": one.stored_unit(length), "min": low, "max": high}
    if one.words:
        return {"name": name, "unit": "", "min": one.word(low), "max": one.word(high)}
    unit = one.shown_unit(length)
    return {"name": name, "unit": unit, "min": one.shown(low), "max": one.shown(high)}


def info_lines(report: dict[str, Any]) -> Iterator[str]:
    """Return the report as text."""
    yield f"{report['title']} (format {report['format']}, lutgen {report['lutgen_version']})"
    yield from grid_lines({axis["name"]: axis for axis in report["axes"]}, report["chart"])
    for channel in report["channels"]:
        ends = (channel["min"], channel["max"])
        low, high = (end if isinstance(end, str) else cell(end) for end in ends)
        yield f"  {channel['name']}: {low} to {high} {channel['unit']}".rstrip()
    if report["share_that_tips"] is not None:
        yield f"  tips over: {100.0 * report['share_that_tips']:.2f} % of directions (by area)"
    yield f"  recipe sha256: {report['recipe_sha256']}"
    if "verified" in report:
        yield "  checksums: all good"

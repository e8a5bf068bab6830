"""`lutgen export`: C tables, runtime and report."""

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import click

from lutgen.cli.options import Named, RecipeOptions, asks, force, log, option, output
from lutgen.cli.sources import open_source
from lutgen.cli.table import show
from lutgen.quantities import EXPORTABLE

ARITHMETIC = ("float", "integer")


@dataclass(frozen=True)
class Asked(RecipeOptions):
    """What the command line says."""

    output: str = output(required=True, help="The folder; it appears when whole.")
    force: bool = force()
    name: str | None = option(help="C identifier of the map.  [default: the robot's name]")
    flash: str | None = option(
        metavar="SIZE", help="Most bytes of tables and code: 16KiB, 64k (of 1000), 4096."
    )
    max_error: str | None = option(
        metavar="X",
        help="Largest error of |SD_g|: 1% of its range, or 0.05 in the length unit.",
    )
    channels: str | None = option(
        metavar="A,B",
        help=f"Of {', '.join(EXPORTABLE)}; tip_angle is always there.  [default: the recipe's]",
    )
    # Their names are asked of `codecs` below: importing that takes longer than --help may.
    codec: str = option(
        metavar="NAME",
        default="auto",
        help="auto, or the only one that may be used; any other name is answered with all.",
    )
    arithmetic: str = option(
        type=click.Choice(ARITHMETIC),
        default="float",
        help="integer: for processors without floating point.",
    )


@click.command(short_help="Write a map as C tables with a small runtime.")
@click.argument("source", type=Named())
@asks(Asked)
@click.pass_context
def export(ctx: click.Context, source: str, asked: Asked) -> None:
    """Write SOURCE, a map or a recipe, as a folder of C sources that any project can take.

    With a flash size the most exact export that fits, with a largest error the smallest that
    keeps it, with both one that does both; without either, what the recipe's [export] says.

    \b
    $ lutgen export paper_two.h5 -o firmware
    $ cd firmware && cc -std=c99 -I. paper_two.c examples/read.c && ./a.out
    """
    from firmware_export import export as run
    from firmware_export.codecs import named
    from firmware_export.emit import check_directory
    from firmware_export.quantity import parse_error, parse_size

    # What is wrong with the command is said before anything is computed.
    check_directory(asked.output, asked.force)
    named(asked.codec)
    if asked.flash is not None:
        parse_size(asked.flash)
    if asked.max_error is not None:
        parse_error(asked.max_error)
    wanted = asked.channels
    quiet = bool(ctx.find_root().params.get("quiet"))
    watched = not quiet and sys.stderr.isatty()

    def progress(text: str) -> None:
        if watched:
            click.echo(f"\r\033[K{text}", nl=False, err=True)
        log.info("%s", text)

    try:
        report = run(
            open_source(source, asked.allow_python),
            asked.output,
            name=asked.name,
            flash=asked.flash,
            max_error=asked.max_error,
            channels=None if wanted is None else [part.strip() for part in wanted.split(",")],
            codec=asked.codec,
            arithmetic=asked.arithmetic,
            progress=progress,
            force=asked.force,
        )
    except KeyboardInterrupt:
        raise click.ClickException("interrupted; nothing is left behind") from None
    finally:
        if watched:
            click.echo("\r\033[K", nl=False, err=True)
    told = {"directory": asked.output, **report}
    show(told, lines(told), asked.as_json)


def lines(report: dict[str, Any]) -> Iterator[str]:
    """Return the report as text."""
    yield f"{report['name']}: {report['spec']}, {report['arithmetic']} arithmetic"
    for name, text in _entries(report):
        yield f"{name:<12}{text}"


def _entries(report: dict[str, Any]) -> Iterator[tuple[str, str]]:
    from firmware_export.emit import bytes_text, errors_of, share

    yield "flash", bytes_text(report["bytes"])
    for name, errors in errors_of(report).items():
        text = "largest error {}, p99 {}, RMS {}".format(*errors) if errors else ""
        yield name, text or "errors not measured"
    unsafe = report["false_safe"]
    guard = f"guard {report['guard_deg']:.3g} deg, "
    yield (
        "verdict",
        f"{guard}{share(report['false_tip'])} of the stable configurations reported unsafe, "
        + ("not certified" if unsafe is None else f"{unsafe} points said to stand that tip"),
    )
    for note in (report["certificate"] or {}).get("text", ()):
        yield "note", note
    yield "folder", report["directory"]

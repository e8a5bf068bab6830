"""`lutgen export`: C tables, runtime and report."""

import json
import logging
import sys
from typing import Any

import click

from lutgen.cli.options import allow_python, as_json, open_source

log = logging.getLogger("lutgen")

CODECS = ("auto", "contacts", "grid", "poly")
ARITHMETIC = ("float", "integer")


@click.command(short_help="Write a map as C tables with a small runtime.")
@click.argument("source", type=click.Path())
@click.option(
    "-o", "--output", required=True, type=click.Path(), help="The folder; it appears when whole."
)
@click.option("--name", help="C identifier of the map.  [default: the robot's name]")
@click.option(
    "--flash", metavar="SIZE", help="Most bytes of tables and code: 16KiB, 64k (of 1000), 4096."
)
@click.option(
    "--max-error",
    metavar="X",
    help="Largest error of |SD_g|: 1% of its range, or 0.05 in the length unit.",
)
@click.option(
    "--channels",
    metavar="A,B",
    help="Of sdg, tip_angle, height; tip_angle is always there.  [default: the recipe's]",
)
@click.option("--codec", type=click.Choice(CODECS), default="auto", show_default=True)
@click.option(
    "--arithmetic",
    type=click.Choice(ARITHMETIC),
    default="float",
    show_default=True,
    help="integer: for processors without floating point.",
)
@allow_python
@as_json
@click.pass_context
def export(
    ctx: click.Context,
    source: str,
    output: str,
    name: str | None,
    flash: str | None,
    max_error: str | None,
    channels: str | None,
    codec: str,
    arithmetic: str,
    allow_python: bool,
    as_json: bool,
) -> None:
    """Write SOURCE, a map or a recipe, as a folder of C sources that any project can take.

    With a flash size the most exact export that fits, with a largest error the smallest that
    keeps it, with both one that does both; without either, what the recipe's [export] says.

    \b
    $ lutgen export paper_two.h5 -o firmware
    $ cd firmware && cc -std=c99 *.c && ./a.out
    """
    from firmware_export import export as run
    from firmware_export.emit import check_directory
    from firmware_export.quantity import parse_error, parse_size

    # What is wrong with the command is said before anything is computed.
    check_directory(output)
    if flash is not None:
        parse_size(flash)
    if max_error is not None:
        parse_error(max_error)
    wanted = tuple(part.strip() for part in channels.split(",")) if channels is not None else None
    quiet = bool(ctx.find_root().params.get("quiet"))
    watched = not quiet and sys.stderr.isatty()

    def progress(text: str) -> None:
        if watched:
            click.echo(f"\r\033[K{text}", nl=False, err=True)
        log.info("%s", text)

    try:
        report = run(
            open_source(source, allow_python),
            output,
            name=name,
            flash=flash,
            max_error=max_error,
            channels=wanted,
            codec=codec,
            arithmetic=arithmetic,
            progress=progress,
        )
    except KeyboardInterrupt:
        raise click.ClickException("interrupted; nothing is left behind") from None
    finally:
        if watched:
            click.echo("\r\033[K", nl=False, err=True)
    if as_json:
        click.echo(json.dumps({"directory": output, **report}, indent=2, allow_nan=False))
        return
    for line in lines(report, output):
        click.echo(line)


def _error_text(name: str, entry: dict[str, Any] | None, unit: str) -> str:
    """Return the errors of a channel as text."""
    from firmware_export.emit import error_texts

    if not entry:
        return "errors not measured"
    largest, p99, rms = error_texts(name, entry, unit)
    return f"largest error {largest}, p99 {p99}, RMS {rms}"


def lines(report: dict[str, Any], output: str) -> list[str]:
    """Return the report as text."""
    from firmware_export.emit import bytes_text, share

    sizes = report["bytes"]
    text = [f"{report['name']}: {report['spec']}, {report['arithmetic']} arithmetic"]
    text.append(f"{'flash':<12}{bytes_text(sizes)}")
    for name, channel in report["channels"].items():
        errors = _error_text(name, channel["error"], report["length_unit"])
        text.append(f"{name:<12}{errors}")
    unsafe = report["false_safe"]
    text.append(
        f"{'verdict':<12}guard {report['guard_deg']:.3g} deg, "
        f"{share(report['given_up'])} of the standing configurations given up, "
        + ("not certified" if unsafe is None else f"{unsafe} points said to stand that tip")
    )
    certificate = report["certificate"] or {}
    text += [f"{'note':<12}{note}" for note in certificate.get("text", ())]
    text.append(f"{'folder':<12}{output}")
    return text

"""`lutgen prove`: whether an export is proved never to be falsely safe."""

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli.options import Named, as_json, asks, output
from lutgen.cli.table import show

if TYPE_CHECKING:
    from firmware_export.prove import Statement


@dataclass(frozen=True)
class Asked:
    """What the command line says."""

    output: str | None = output(help="The file of the proof.  [default: DIR/NAME_proof.json]")
    as_json: bool = as_json()


@click.command(short_help="Prove that an export is never falsely safe.")
@click.argument("directory", metavar="DIR", type=Named())
@asks(Asked)
def prove(directory: str, asked: Asked) -> None:
    """Prove that the export in DIR never says that the robot stands where it tips.

    For every posture that its axes hold and every direction, rounding of the C included.  Writes
    the proof to a file that `python -m proofs.check_proof DIR` checks.  Exit code 1 where it cannot
    be proved, with what stands in the way.

    \b
    $ lutgen prove firmware
    proved: 30 cells, guard 0.000258 deg, of which the proof needs 0.000258 deg
    """
    from firmware_export.proved import proof_text
    from firmware_export.proved import prove as run

    begin = time.perf_counter()
    stated, content = run(directory)
    seconds = time.perf_counter() - begin
    path = None
    if content is not None:
        path = Path(asked.output or Path(directory) / f"{content['name']}_proof.json")
        _write(path, proof_text(content))
    report = _report(stated, directory, seconds, path)
    show(report, _lines(report), asked.as_json, stated.proved)


def _write(path: Path, text: str) -> None:
    from lutgen.errors import ExportError

    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise ExportError(
            f"{path}: the proof cannot be written (got {error.strerror}); "
            "name another file with -o."
        ) from error


def _report(
    stated: "Statement", directory: str, seconds: float, path: Path | None
) -> dict[str, Any]:
    return {
        "directory": directory,
        **stated.told,
        "guard_deg": math.degrees(stated.guard),
        "guard_i": stated.guard_i,
        "looked": stated.looked,
        "seconds": round(seconds, 3),
        "file": None if path is None else str(path),
    }


def _lines(report: dict[str, Any]) -> Iterator[str]:
    guard = f"guard {report['guard_deg']:.3g} deg"
    if report["status"] == "proved":
        yield (
            f"proved: {report['cells']:,} cells, {guard}, of which the proof needs "
            f"{report['needed_deg']:.3g} deg"
        )
        yield (
            f"integers: guard {report['guard_i']} in 1/32767, of which the proof needs "
            f"{report['needed_i']}"
        )
        yield f"file: {report['file']}"
    else:
        yield f"not proved, {guard}: {report['reason']}"
    yield f"time: {report['seconds']:.2f} s"

"""`lutgen sweep`: compute a map."""

import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from lutgen.cli.options import Named, RecipeOptions, asks, file_size, force, log, option, output
from lutgen.cli.sources import open_recipe
from lutgen.cli.table import show


@dataclass(frozen=True)
class Asked(RecipeOptions):
    """What the command line says."""

    output: str = output(required=True, help="The map file (HDF5).")
    force: bool = force(
        help="Replace what is there: unfinished work, or a file that lutgen did not make."
    )
    threads: int | None = option(type=int, help="Threads to compute with.  [default: all]")
    resume: bool = option(is_flag=True, help="Go on with an interrupted sweep of the same recipe.")
    engine: str = option(default="local", help="Where blocks are computed: local or dask.")
    scheduler: str | None = option(
        metavar="ADDR", help="A running dask scheduler, tcp://HOST:8786."
    )


@click.command(short_help="Compute a recipe's stability map.")
@click.argument("recipe", type=Named())
@asks(Asked)
@click.pass_context
def sweep(ctx: click.Context, recipe: str, asked: Asked) -> None:
    """Compute the map of RECIPE into an HDF5 file.

    The file appears under its name when it is whole.  A sweep that is stopped, by Ctrl-C, a kill
    or a power cut, leaves OUTPUT.part, from which `--resume` goes on; only `--force` begins anew.

    \b
    $ lutgen sweep maps/paper_two.toml -o paper_two.h5
    """
    from lutgen.mapping import sweep as run

    robot = open_recipe(recipe, asked.allow_python)
    quiet = bool(ctx.find_root().params.get("quiet"))
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
            run(
                robot,
                asked.output,
                threads=asked.threads,
                resume=asked.resume,
                engine=asked.engine,
                progress=progress,
                scheduler=asked.scheduler,
                force=asked.force,
            )
        except KeyboardInterrupt:
            begun = Path(f"{asked.output}.part").exists()
            raise click.ClickException(
                f"interrupted; {asked.output}.part holds what is done: go on with --resume"
                if begun
                else "interrupted before the first block; nothing is left behind"
            ) from None
    seconds, size = time.perf_counter() - start, Path(asked.output).stat().st_size
    if not quiet:
        click.echo(f"{asked.output}: {file_size(size)} in {seconds:.2f} s", err=True)
    log.info("recipe digest %s", robot.digest)
    report = {
        "robot": robot.name,
        "digest": robot.digest,
        "map": asked.output,
        "nodes": robot.nodes,
        "channels": list(robot.channels),
        "bytes": size,
        "seconds": round(seconds, 3),
    }
    # In words the map is all that it has to say.
    show(report, (), asked.as_json)

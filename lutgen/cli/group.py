"""The command group: its options, and how errors become one line and an exit code."""

import logging
import os
from typing import Any

import click

from lutgen._version import __version__
from lutgen.cli.check import check
from lutgen.cli.eval import eval_
from lutgen.cli.explore import explore
from lutgen.cli.export import export
from lutgen.cli.import_ import import_
from lutgen.cli.info import info
from lutgen.cli.limits import limits
from lutgen.cli.metrics import metrics
from lutgen.cli.new import new
from lutgen.cli.optimum import optimum
from lutgen.cli.paper import paper
from lutgen.cli.path import path
from lutgen.cli.plot import plot
from lutgen.cli.recipes import recipes
from lutgen.cli.schema import schema
from lutgen.cli.stance import stance
from lutgen.cli.sweep import sweep
from lutgen.cli.wheels import wheels
from lutgen.errors import ExportError, LutgenError, SweepError

FAILED, BAD_INPUT = 1, 2


class Group(click.Group):
    """Turns the library's errors into one sentence on stderr."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command; exit 1 where the task failed, 2 where its input is wrong."""
        try:
            return super().invoke(ctx)
        except LutgenError as error:
            failure = click.ClickException(str(error))
            failed = isinstance(error, ExportError | SweepError)
            # click reads it from the instance; the class has the value 1.
            vars(failure)["exit_code"] = FAILED if failed else BAD_INPUT
            raise failure from error
        except BrokenPipeError:
            # The reader of our output has gone: nothing is left to say, not even at exit.
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            ctx.exit(FAILED)


@click.group(cls=Group, context_settings={"help_option_names": ["-h", "--help"]})
@click.option("-v", "--verbose", count=True, help="Say more on stderr.")
@click.option("-q", "--quiet", is_flag=True, help="Say nothing on stderr but errors.")
@click.version_option(__version__, prog_name="lutgen")
def main(verbose: int, quiet: bool) -> None:
    """Stability maps for robots that can change their shape.

    \b
    lutgen check maps/paper_two.toml
    lutgen sweep maps/paper_two.toml -o paper_two.h5
    lutgen plot paper_two.h5 -o map.png --kind contour
    lutgen export paper_two.h5 -o firmware

    \b
    Exit codes: 0 all is fine, 1 the task failed, 2 the input is wrong,
    3 the answer is that the robot tips over, or that nobody can tell.
    """
    level = logging.ERROR if quiet else max(logging.WARNING - 10 * verbose, logging.DEBUG)
    logging.basicConfig(level=level, format="lutgen: %(message)s")
    logging.getLogger("lutgen").setLevel(level)


for command in (
    *(new, schema, recipes, import_, check, sweep, info, eval_, limits, metrics),
    *(stance, optimum, plot, export, explore, wheels, paper, path),
):
    main.add_command(command)

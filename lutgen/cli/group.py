"""The command group: its options, and how errors become one line and an exit code."""

import errno
import logging
import os
import traceback
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn

import click

from lutgen import errors
from lutgen._version import __version__

FAILED, BAD_INPUT = 1, 2
# The modules that have commands.
COMMANDS = (
    "budget control eval export import_ limits optimum pages path posture recipes sweep weigh"
)
# The system's errors of an output that takes no more: a name stands with all other files.
NO_OUTPUT = (errno.EPIPE, errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF)
# The name of a fault of lutgen itself, and how much of its own words is quoted.
UNFORESEEN = "this is a fault of lutgen"
LONGEST = 300


class Group(click.Group):
    """Turns the library's errors into one sentence on stderr."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command; exit 1 where the task failed, 2 where its input is wrong."""
        try:
            return super().invoke(ctx)
        except errors.LutgenError as error:
            text = errors.readable(str(error))
            # The faults of a recipe are a line each.
            text = text if isinstance(error, errors.RecipeError) else errors.one_line(text)
            failure = click.ClickException(text)
            failed = isinstance(error, errors.ExportError | errors.SweepError)
            # click reads it from the instance; the class has the value 1.
            vars(failure)["exit_code"] = FAILED if failed else BAD_INPUT
            raise failure from error
        except click.ClickException as error:
            vars(error)["message"] = errors.readable(error.message)
            raise

    def main(self, *args: Any, **settings: Any) -> Any:
        """Run the command line; an unforeseen error ends in a sentence, too."""
        try:
            return super().main(*args, **settings)
        except Exception as error:
            _end(error)


class _Readable(logging.Formatter):
    """Says what a terminal may show: names may hold characters that it obeys."""

    def formatMessage(self, record: logging.LogRecord) -> str:
        """Return the line of a record, without a traceback."""
        return errors.one_line(errors.readable(super().formatMessage(record)))


def _end(error: Exception) -> NoReturn:
    """Say in a sentence why a command ended that no message of ours explains; exit."""
    if isinstance(error, OSError) and error.errno in NO_OUTPUT and error.filename is None:
        # The reader of our output has gone, or its disk is full: it gets nothing, not even at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        if not isinstance(error, BrokenPipeError):
            click.echo(f"Error: the output cannot be written (got {error.strerror}).", err=True)
        raise SystemExit(FAILED)
    log = logging.getLogger("lutgen")
    log.info("%s", UNFORESEEN, exc_info=error)
    if isinstance(error, MemoryError):
        said = f"the memory is not enough (got {str(error) or 'no more'}); request less at once."
    else:
        place = ""
        if error.__traceback__ is not None:
            *_, last = traceback.extract_tb(error.__traceback__)
            place = f" in {Path(last.filename).name}, line {last.lineno}"
        got = errors.readable(" ".join(f"{type(error).__name__}: {error}".split())[:LONGEST])
        way_out = "" if log.isEnabledFor(logging.INFO) else "run it again with `lutgen -v`, and "
        said = (
            f"{UNFORESEEN} (got {got}{place}); {way_out}report the traceback, the command and its "
            "files to the source of your lutgen (see SECURITY.md there)."
        )
    click.echo(f"Error: {said}", err=True)
    raise SystemExit(FAILED) from error


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
    3 the answer is that the robot tips over, or that it is unknown.
    """
    level = logging.ERROR if quiet else max(logging.WARNING - 10 * verbose, logging.DEBUG)
    handler = logging.StreamHandler()
    handler.setFormatter(_Readable("lutgen: %(message)s"))
    logging.basicConfig(level=level, handlers=[handler])
    logging.getLogger("lutgen").setLevel(level)
    # Numba would answer with a traceback.
    threads = os.environ.get("NUMBA_NUM_THREADS", "1")
    if not (threads.isascii() and threads.isdigit() and int(threads[:6])):
        what = "must be a whole number above 0"
        way_out = "correct it in the environment, or unset it"
        errors.reject("NUMBA_NUM_THREADS", what, repr(threads), way_out, errors.InputError)


for module in COMMANDS.split():
    for found in vars(import_module(f"lutgen.cli.{module}")).values():
        if isinstance(found, click.Command):
            main.add_command(found)

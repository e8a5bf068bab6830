"""Run the command `lutgen`, as a program and as `python -m lutgen`.

Ctrl-C ends the program without a word while the commands are being imported, and where it falls
into a callback of a compiled library, which could only drop it.
"""

import io
import os
import signal
import sys
from typing import TYPE_CHECKING, NoReturn

# One that is ignored, as in the background of a shell, stays so.
_heard = signal.getsignal(signal.SIGINT) is signal.default_int_handler
if _heard:
    signal.signal(signal.SIGINT, signal.SIG_DFL)
import click  # noqa: E402

from lutgen.cli import main  # noqa: E402

if TYPE_CHECKING:
    from sys import UnraisableHookArgs
    from types import FrameType

__all__ = ["program"]


def _dropped(what: "UnraisableHookArgs") -> None:
    """End the program on a Ctrl-C that was dropped; objects that it left half made say nothing."""
    if issubclass(what.exc_type, KeyboardInterrupt):
        os._exit(1)


def _interrupt(number: int, frame: "FrameType | None") -> None:
    """Raise KeyboardInterrupt."""
    sys.unraisablehook = _dropped
    signal.default_int_handler(number, frame)


def program() -> NoReturn:
    """Run the command line and exit."""
    if _heard:
        signal.signal(signal.SIGINT, _interrupt)
    # A console that lacks a character of a name shows its number.
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        main()
    except SystemExit as end:
        if isinstance(end.__context__, click.Abort):
            # Threads that still compile are not waited for.
            sys.stdout.flush()
            os._exit(end.code if isinstance(end.code, int) else 1)
        raise
    raise SystemExit(0)


if __name__ == "__main__":
    program()

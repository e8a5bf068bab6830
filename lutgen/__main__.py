"""Run the command `lutgen`, as a program and as `python -m lutgen`.

Ctrl-C ends the program without a word while the commands are being imported.  If it falls into a
callback of a compiled library, which can only drop it, it is raised again.
"""

import _thread
import io
import os
import signal
import sys
import threading
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

# Seconds after which a dropped Ctrl-C comes again: by then the callback has ended.
AGAIN = 0.05
_interrupts: list[int] = []


def _interrupt(number: int, frame: "FrameType | None") -> None:
    """Raise KeyboardInterrupt, and keep that it was raised."""
    _interrupts.append(number)
    signal.default_int_handler(number, frame)


if _heard:
    signal.signal(signal.SIGINT, _interrupt)


def program() -> NoReturn:
    """Run the command line and exit."""
    usual = sys.unraisablehook

    def dropped(what: "UnraisableHookArgs") -> None:
        if not issubclass(what.exc_type, KeyboardInterrupt):
            # An object that Ctrl-C left half made complains when it goes.
            if not _interrupts:
                usual(what)
            return
        later = threading.Timer(AGAIN, _thread.interrupt_main)
        later.daemon = True
        later.start()

    sys.unraisablehook = dropped
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

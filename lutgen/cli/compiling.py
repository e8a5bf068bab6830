"""One line to the user before the compiler is waited for.

Owns the notice only; kernels and their cache are `lutgen.jit`'s.
"""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

import click

MESSAGE = "compiling the kernels: about half a minute on an idle machine, kept for the next time"


@contextmanager
def compiling_is_told(quiet: bool) -> Iterator[None]:
    """Unless `quiet`, say so once on stderr when a kernel in the with block is not in the cache."""
    from numba.core import event

    class Notice(event.Listener):  # type: ignore[misc]
        told = quiet

        def on_start(self, event: object) -> None:
            if not self.told:
                self.told = True
                # On a terminal it takes the place of the progress bar, which is drawn again.
                begin = "\r" if sys.stderr.isatty() else ""
                click.echo(f"{begin}{MESSAGE}", err=True)

        def on_end(self, event: object) -> None:
            """Nothing to say."""

    # A kernel that is loaded from the cache is no such event.
    with event.install_listener("numba:compile", Notice()):
        yield

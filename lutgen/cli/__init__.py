"""The `lutgen` command: one module per verb, results on stdout, progress and logs on stderr."""

from lutgen.cli.group import main

__all__ = ["main"]

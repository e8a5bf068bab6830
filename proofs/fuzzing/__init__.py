"""Hostile input for every door of the command line: `values`, `cases`, `run`, `__main__`."""

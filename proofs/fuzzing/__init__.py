"""Hostile input for every door of the command line: it has to stay polite, quick and small.

In reading order: `values`, `robots`, `inputs`, `run`, `__main__`.
"""

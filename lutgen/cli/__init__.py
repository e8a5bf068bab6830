"""The `lutgen` command: one module per verb, results on stdout, progress and logs on stderr.

In reading order: `options`, `sources`, `table`, `check`, `compiling`, `eval_export`, `eval`,
`export`, `import_`, `info`, `limits`, `metrics`, `optimum`, `paper`, `path`, `plot`, `recipes`,
`stance`, `sweep`, `wheels`, `group`.
"""

from lutgen.cli.group import main

__all__ = ["main"]

"""The `lutgen` command: one module per verb, results on stdout, progress and logs on stderr.

In reading order: `options`, `check`, `compiling`, `eval_export`, `eval`, `export`, `import_`,
`info`, `limits_report`, `limits`, `metrics`, `optimum`, `paper`, `path_report`, `path`, `plot`,
`sweep`, `wheels`, `group`.
"""

from lutgen.cli.group import main

__all__ = ["main"]

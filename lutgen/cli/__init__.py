"""The `lutgen` command: one module per verb, results on stdout, progress and logs on stderr.

In reading order: `options`, `sources`, `table`, `check`, `eval_export`, `eval`,
`export`, `explore`, `import_`, `info`, `limits`, `budget`, `metrics`, `new`, `optimum`, `paper`,
`path`, `plot`, `policy`, `control`, `recipes`, `schema`, `stance`, `sweep`, `wheels`, `group`.
"""

from lutgen.cli.group import main

__all__ = ["main"]

"""The `lutgen` command: results on stdout, progress and logs on stderr.

In reading order: `lazy`, `options`, `output`, `recipes`, `import_`, `sweep`, `eval`, `limits`,
`budget`, `metrics`, `wheels`, `stance`, `weigh`, `optimum`, `path`, `control`, `plot`, `export`,
`pages`, `group`.
"""

from lutgen.cli.group import main

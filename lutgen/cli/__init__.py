"""The `lutgen` command: results on stdout, progress and logs on stderr.

In reading order: `lazy`, `options`, `output`, `recipes`, `import_`, `sweep`, `eval`, `limits`,
`budget`, `posture`, `weigh`, `optimum`, `path`, `control`, `export`, `pages`, `group`.
"""

from lutgen.cli.group import main

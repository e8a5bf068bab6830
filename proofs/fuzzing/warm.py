"""What the process that all runs are forked from has imported and compiled before the first."""

from pathlib import Path

from click.testing import CliRunner

from lutgen.cli import main
from tests.fixtures.recipes import tripod

with CliRunner().isolated_filesystem():
    Path("r.toml").write_text(tripod(nodes=5), "utf-8")
    for words in ("check r.toml", "eval r.toml", "limits r.toml", "metrics r.toml"):
        CliRunner().invoke(main, words.split())

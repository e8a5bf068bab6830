"""The page on the command line: its commands, its tables, and completion as it says."""

import re

from click.testing import CliRunner

from lutgen.cli import main
from tests.cli.test_alike import VERDICTS
from tests.fixtures.places import ROOT

PAGE = "docs/guide/commands.md"
TEXT = (ROOT / PAGE).read_text(encoding="utf-8")
# Shells of the table, and the line that it gives each.
LINES = dict(re.findall(r"^\| (\w+)[^|]* \| `~[^`]+` \| `(.+)` \|$", TEXT, re.MULTILINE))


def test_the_table_of_verdicts_names_the_commands_that_have_one():
    listed = re.findall(r"^\| `(\w+)` \|", TEXT, re.MULTILINE)
    assert listed == sorted(VERDICTS)
    # What the help of a command says of its own exit code.
    says = {name for name, one in main.commands.items() if "code 3" in " ".join(one.help.split())}
    assert says == set(listed)


def completions(words, incomplete):
    """Return what lutgen answers the function of bash, which asks through the environment."""
    asked = {
        "_LUTGEN_COMPLETE": "bash_complete",
        "COMP_WORDS": f"{words} {incomplete}",
        "COMP_CWORD": str(len(words.split())),
    }
    lines = CliRunner().invoke(main, [], prog_name="lutgen", env=asked).stdout.splitlines()
    return [line.split(",", 1)[1] for line in lines]


def test_commands_options_kinds_and_recipes_are_completed():
    assert completions("lutgen", "lim") == ["limits"]
    assert completions("lutgen plot map.h5 --kind", "s") == ["surface", "sphere"]
    assert completions("lutgen recipes", "ab") == ["absolem"]
    assert "--json" in completions("lutgen sweep", "--")
    assert {f"_LUTGEN_COMPLETE={shell}_source" in line for shell, line in LINES.items()} == {True}
    assert len(LINES) == 3

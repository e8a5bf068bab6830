"""Commands run inside the tests' own process, as several files of tests do."""

import json
from typing import Any

from click.testing import CliRunner, Result

from lutgen.cli import main

__all__ = ["data", "good", "run", "stdout"]


def run(*arguments: object) -> Result:
    """Run a command; an exception that is not an exit fails the test."""
    result = CliRunner().invoke(main, [*map(str, arguments)])
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result


def good(*arguments: object) -> Result:
    """Run a command that must succeed."""
    result = run(*arguments)
    assert result.exit_code == 0, result.stderr
    return result


def stdout(*arguments: object) -> str:
    """Return what a command that must succeed prints on stdout."""
    return good(*arguments).stdout


def data(*arguments: object, code: int = 0) -> dict[str, Any]:
    """Return what a command prints with --json, which must be JSON and nothing else."""

    def refuse(text: str) -> None:
        raise AssertionError(f"{text} is not JSON")

    result = run(*arguments, "--json")
    assert result.exit_code == code, result.stderr
    report = json.loads(result.stdout, parse_constant=refuse)
    assert isinstance(report, dict)
    return report

"""What all commands do alike: `--json`, the exit status of a verdict, and completion in a shell."""

from pathlib import Path

import pytest

import lutgen
from lutgen.cli import main
from tests.fixtures.commands import data, good
from tests.fixtures.recipes import tripod

COMMANDS = sorted(main.commands)


@pytest.fixture
def recipe(tmp_path: Path) -> Path:
    """Return the recipe of a small robot."""
    path = tmp_path / "tripod.toml"
    path.write_text(tripod())
    return path


# --json


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_can_report_as_json(name: str) -> None:
    flags = {flag for option in main.commands[name].params for flag in option.opts}
    assert "--json" in flags


def test_a_sweep_reports_the_map_that_it_wrote(recipe: Path, tmp_path: Path) -> None:
    target = tmp_path / "map.h5"
    report = data("sweep", recipe, "-o", target)
    assert report.pop("seconds") > 0.0
    stability_map = lutgen.load_map(target)
    assert report == {
        "robot": "tripod",
        "digest": stability_map.recipe.digest,
        "map": str(target),
        "nodes": stability_map.channel("sdg").size,
        "channels": list(stability_map.channels),
        "bytes": target.stat().st_size,
    }


def test_a_figure_is_reported_with_what_it_shows(recipe: Path, tmp_path: Path) -> None:
    target = tmp_path / "robot.svg"
    report = data("plot", recipe, "-o", target, "--kind", "robot")
    assert report == {
        "robot": "tripod",
        "digest": lutgen.load_recipe(recipe).digest,
        "source": str(recipe),
        "kind": "robot",
        "figure": str(target),
        "bytes": target.stat().st_size,
    }
    # In words a figure is the only answer.
    assert good("plot", recipe, "-o", target, "--kind", "robot").stdout == ""


def test_the_papers_page_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = tmp_path / "paper.html"
    monkeypatch.setattr("lutgen.paper.write_report", lambda folder, tell: page)
    assert data("paper", "-o", tmp_path) == {"folder": str(tmp_path), "page": str(page)}
    assert good("paper", "-o", tmp_path).stdout == f"{page}\n"

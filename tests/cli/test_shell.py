"""What all commands do alike: `--json`, the exit status of a verdict, and completion in a shell."""

from pathlib import Path

import click
import pytest

import lutgen
from lutgen.cli import main
from tests.fixtures.commands import data, good, run
from tests.fixtures.recipes import tripod

COMMANDS = sorted(main.commands)


@pytest.fixture
def recipe(tmp_path: Path) -> Path:
    """Return the recipe of a small robot."""
    path = tmp_path / "tripod.toml"
    path.write_text(tripod())
    return path


AT = ("-p", "reach=0.3", "-p", "swing=10")
WHEEL = '[[robot.wheel]]\ncontact = "front"\naxis = [0, 1, 0]\nradius = 0.1\n'
FLAT = "x,y,z\n0,0,0\n1,0,0\n2,0,0\n"
# Commands that have a verdict on a robot, and what they are asked.
VERDICTS: dict[str, tuple[object, ...]] = {
    "eval": AT,
    "limits": AT,
    "optimum": (),
    "path": (*AT, "--terrain", "flat.csv", "--no-control"),
    "stance": (),
    "wheels": AT,
}


def stance(com_x: float) -> str:
    """Return four feet under a centre of mass."""
    feet = "".join(
        f"[[foot]]\nposition = [{x}, {y}, 0]\n" for x, y in ((1, 1), (1, -1), (-1, 1), (-1, -1))
    )
    return f"com = [{com_x}, 0, 1]\nfriction = 0.5\n{feet}"


@pytest.fixture
def robots(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the working folder, with a robot that stands on level ground and one that tips."""
    monkeypatch.chdir(tmp_path)
    for name, com_x in (("stands", 0.02), ("tips", -3.0)):
        text = tripod().replace("com = [0.02,", f"com = [{com_x},")
        Path(f"{name}.toml").write_text(text.replace("[sweep]", f"{WHEEL}[sweep]", 1))
        Path(f"{name}_stance.toml").write_text(stance(com_x))
    Path("flat.csv").write_text(FLAT)
    return tmp_path


# exit codes


@pytest.mark.parametrize("as_json", [(), ("--json",)], ids=["words", "json"])
@pytest.mark.parametrize("command", VERDICTS)
def test_a_verdict_is_the_exit_code_of_every_command_that_has_one(
    command: str, as_json: tuple[str, ...], robots: Path
) -> None:
    for name, code in (("stands", 0), ("tips", 3)):
        source = f"{name}_stance.toml" if command == "stance" else f"{name}.toml"
        result = run(command, source, *VERDICTS[command], *as_json)
        assert result.exit_code == code, result.output
        # It is an answer and no error: printed whole, on stdout.
        assert len(result.stdout.splitlines()) > 1
        assert "Error" not in result.stderr


def test_metrics_have_nothing_to_compare_where_the_robot_tips_on_level_ground(
    robots: Path,
) -> None:
    assert run("metrics", "tips.toml", *AT).exit_code == 2


def test_a_robot_that_tips_has_no_wheels_to_speak_of_whether_or_not_they_slip(
    robots: Path,
) -> None:
    # Sideways is what the wheel cannot do.
    asked = (*AT, "--velocity", "0,1")
    assert run("wheels", "stands.toml", *asked).exit_code == 1
    assert run("wheels", "tips.toml", *asked).exit_code == 3


# --json


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_can_report_as_json(name: str) -> None:
    flags = {flag for option in main.commands[name].params for flag in option.opts}
    # A schema is JSON without being asked.
    assert "--json" in flags or name == "schema"


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
    monkeypatch.setattr("lutgen.paper.write_report", lambda folder, tell, force: page)
    assert data("paper", "-o", tmp_path) == {"folder": str(tmp_path), "page": str(page)}
    assert good("paper", "-o", tmp_path).stdout == f"{page}\n"


# paths


@pytest.mark.parametrize("name", COMMANDS)
def test_an_empty_text_is_no_path_to_any_command(name: str, tmp_path: Path) -> None:
    paths = [one for one in main.commands[name].params if isinstance(one.type, click.Path)]
    for one in paths:
        with pytest.raises(click.BadParameter, match="names nothing"):
            one.type.convert("", one, None)
        assert one.type.convert(str(tmp_path), one, None) == str(tmp_path)
    assert paths or name in {"new", "recipes", "schema"}

"""What all commands do alike: sources, `--json`, the exit code of a verdict, help, completion."""

import shutil
import subprocess
import sys
from pathlib import Path

import click
import pytest

import lutgen
from lutgen.cli import main
from lutgen.plot import KINDS
from tests.fixtures.commands import data, good, run, stdout
from tests.fixtures.recipes import rigid, tripod

COMMANDS = sorted(main.commands)
AT = ("-p", "reach=0.3", "-p", "swing=10")
WHEEL = '[[robot.wheel]]\ncontact = "front"\naxis = [0, 1, 0]\nradius = 0.1\n'
# Every command that wants a recipe, and its options; a map has its file's name.
RECIPES = {
    "check": (),
    "sweep": ("-o",),
    "limits": AT,
    "metrics": (*AT, "--headings", 4),
    "optimum": ("--method", "map"),
    "wheels": AT,
    "path": (*AT, "--points", 4, "--no-control"),
}
# Commands that have a verdict on a robot, and their options.
VERDICTS = {
    "eval": AT,
    "limits": AT,
    "optimum": (),
    "path": (*AT, "--terrain", "flat.csv", "--no-control"),
    "stance": (),
    "wheels": AT,
}


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """Return a folder with a recipe, its map, and the map under a name without an ending."""
    folder = tmp_path_factory.mktemp("alike")
    text = tripod().replace("[sweep]", f"{WHEEL}\n[sweep]", 1)
    (folder / "tripod.toml").write_text(text)
    lutgen.sweep(lutgen.parse_recipe(text), folder / "tripod.h5")
    shutil.copy(folder / "tripod.h5", folder / "tripod")
    return folder


# sources


@pytest.mark.parametrize("command", RECIPES)
def test_a_map_given_for_a_recipe_answers_as_the_recipe_inside_it(command, place, tmp_path):
    answers = []
    for source in ("tripod.toml", "tripod.h5", "tripod"):
        arguments = [place / source, *RECIPES[command]]
        if command == "sweep":
            good(command, *arguments, tmp_path / source)
            answers.append((tmp_path / source).read_bytes())
        else:
            result = run(command, *arguments)
            answers.append(f"{result.exit_code} {result.output}".encode())
    assert answers[0] == answers[1] == answers[2]
    assert b"Error" not in answers[0]


def test_the_code_of_a_recipe_inside_a_map_runs_only_where_it_is_allowed(tmp_path):
    code = (
        "import numpy as np\n"
        "FEET = np.array([[1.0, 1, -1], [-1, 1, -1], [-1, -1, -1], [1, -1, -1]])\n"
        "def postures(q):\n"
        "    return np.repeat(FEET[None], len(q), 0), np.zeros((len(q), 3))\n"
    )
    (tmp_path / "sources_plugin.py").write_text(code)
    (tmp_path / "code.toml").write_text(rigid("", head='python = "sources_plugin:postures"'))
    recipe = lutgen.load_recipe(tmp_path / "code.toml", allow_python=True)
    lutgen.sweep(recipe, tmp_path / "code.h5")
    assert "--allow-python" in run("limits", tmp_path / "code.h5").stderr
    allowed = [
        stdout("limits", tmp_path / name, "--allow-python") for name in ("code.toml", "code.h5")
    ]
    assert allowed[0] == allowed[1]


# exit codes and words


def stance(com_x):
    feet = "".join(
        f"[[foot]]\nposition = [{x}, {y}, 0]\n" for x, y in ((1, 1), (1, -1), (-1, 1), (-1, -1))
    )
    return f"com = [{com_x}, 0, 1]\nfriction = 0.5\n{feet}"


@pytest.fixture
def robots(tmp_path, monkeypatch):
    """Return the working folder, with a robot that stands on level ground and one that tips."""
    monkeypatch.chdir(tmp_path)
    for name, com_x in (("stands", 0.02), ("tips", -3.0)):
        text = tripod().replace("com = [0.02,", f"com = [{com_x},")
        Path(f"{name}.toml").write_text(text.replace("[sweep]", f"{WHEEL}[sweep]", 1))
        Path(f"{name}_stance.toml").write_text(stance(com_x))
    Path("flat.csv").write_text("x,y,z\n0,0,0\n1,0,0\n2,0,0\n")
    return tmp_path


@pytest.mark.parametrize("command", VERDICTS)
def test_a_verdict_has_the_same_words_and_exit_code_in_every_command(command, robots):
    for name, code in (("stands", 0), ("tips", 3)):
        source = f"{name}_stance.toml" if command == "stance" else f"{name}.toml"
        data(command, source, *VERDICTS[command], code=code)
        result = run(command, source, *VERDICTS[command])
        # It is an answer and no error: printed whole, on stdout.
        assert (result.exit_code, "Error" in result.stderr) == (code, False)
        assert len(result.stdout.splitlines()) > 1
        words = {"stance": "does not hold"}.get(command, "tips over")
        tips = result.stdout.replace("tips over at 0 points", "").replace("before it tips over", "")
        assert (words in tips) is (code == 3)


def test_no_name_prints_another_line_or_what_a_terminal_obeys(tmp_path):
    for name in ("odd", r"a\nb\u001b[31m"):
        path = tmp_path / "odd.toml"
        path.write_text(tripod().replace('name = "tripod"', f'name = "{name}"', 1))
        lines = stdout("limits", path).splitlines()
        assert len(lines) == 13
        assert "\x1b" not in lines[0]


# --json


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_can_report_as_json_and_its_help_begins_with_an_example(name):
    flags = {flag for option in main.commands[name].params for flag in option.opts}
    # A schema is JSON without being asked.
    assert "--json" in flags or name == "schema"
    usage, empty, example, *_ = stdout(name, "-h").splitlines()
    assert usage.startswith(f"Usage: main {name}")
    assert (empty, example.split()[:2]) == ("", ["$", "lutgen"])
    assert stdout(name, "--help") == stdout(name, "-h")


# help and start-up


def imported(*arguments):
    """Run a command in a process of its own; return the modules that it has imported."""
    code = (
        "import sys\nfrom lutgen.cli import main\n"
        f"try:\n    main({[*map(str, arguments)]!r})\nexcept SystemExit as end:\n"
        "    assert not end.code\nprint(*sys.modules)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.splitlines()) > 1
    return set(done.stdout.splitlines()[-1].split())


@pytest.mark.parametrize("arguments", [["--help"], ["eval", "--help"], ["export", "-h"]])
def test_help_imports_nothing_heavy(arguments):
    assert not imported(*arguments) & {"numpy", "numba", "matplotlib", "pydantic", "scipy"}


def test_a_recipe_is_evaluated_without_what_only_maps_figures_and_compiling_need(place):
    # The first may have to compile.
    good("eval", place / "tripod.toml", *AT)
    modules = imported("eval", place / "tripod.toml", *AT)
    assert not modules & {"h5py", "matplotlib", "scipy.linalg"}


def test_the_command_offers_the_kinds_of_figures_that_there_are():
    offered = next(p.type for p in main.commands["plot"].params if p.name == "kind")
    assert isinstance(offered, click.Choice)
    assert set(offered.choices) == set(KINDS)
    assert stdout("--version") == f"lutgen, version {lutgen.__version__}\n"


def test_numbers_are_read_as_toml_reads_them(place):
    plain, parted = (run("eval", place / "tripod.toml", "-p", f"swing={x}") for x in ("10", "1_0"))
    assert plain.stdout == parted.stdout != ""


def test_a_console_without_a_character_shows_its_number(place, tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONIOENCODING", "cp1252")
    text = (place / "tripod.toml").read_text(encoding="utf-8")
    path = tmp_path / "arrow.toml"
    path.write_text(text.replace('"tripod"', '"a \u2192 b"'), encoding="utf-8")
    command = [sys.executable, "-m", "lutgen", "check", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.startswith("a \\u2192 b: ")

"""What all commands do alike: sources, answers as JSON, exit codes of verdicts, help, completion.

That the text of a command says the same as its JSON is what the guides print, line by line.
"""

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import lutgen
from lutgen.cli import main
from lutgen.plot import KINDS
from lutgen.quantities import CHANNELS
from tests.cli.test_refusals_cli import DITCH
from tests.fixtures.commands import data, good, run, stdout
from tests.fixtures.linkage import coded
from tests.fixtures.places import VECTORS
from tests.fixtures.recipes import tripod

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
# The exit code, the command, and in the lines after it the keys of the answer, in their order.
ANSWERS = """
0 | check r.toml
  name digest length_unit contacts kinds wheels forces axles posture posture_from mass com
  parameters chart channels nodes file_bytes seconds snapped warnings
0 | recipes
  recipes
0 | recipes absolem
  name source digest length_unit contacts parameters nodes description text
0 | new wheels -o new.toml
  kind recipe
0 | import rover.urdf -o rover.toml
  name mass com posture parameters coupled because contacts guessed left_out warnings
0 | sweep r.toml -o swept.h5
  robot digest map nodes channels bytes seconds
0 | info r.h5 --verify
  title format definition lutgen_version robot length_unit axes chart channels share_that_tips
  recipe_sha256 verified
0 | eval r.toml
  robot source length_unit standing sdg height tip_angle_deg margin energy_margin least_share facet
  status slope_deg slides_first least_stable_axis axes normal_forces normal_forces_kind
  normal_forces_range heuristic_forces_eq12 group_shares support com posture posture_from
0 | eval r.h5
  robot source length_unit on_chart standing sdg height tip_angle_deg margin energy_margin
  least_share facet status posture posture_from
3 | eval r.h5 -g 0,0,1
  robot source length_unit on_chart standing sdg height tip_angle_deg margin energy_margin
  least_share status posture posture_from
0 | limits r.toml --all --best --headings 4 --least-share front=0.1
  robot length_unit convention posture friction friction_angle_deg limits guaranteed_tilt_deg
  guaranteed_body_tilt_deg guaranteed_ground_tilt_deg guaranteed_ground_tip_deg
  ground_sliding_included worst_ground_heading_deg worst_ground_tilt_deg worst_ground_contacts
  ground_rolling_included forces_act stands_on_level_ground posture_from share_limits all_postures
  best_postures
0 | metrics r.toml --headings 4 --tilt 60
  robot length_unit tilt_deg level headings posture posture_from
0 | wheels r.toml
  robot length_unit standing structure velocity yaw_rate_deg_s possible slip nearest wheels posture
  posture_from
1 | wheels r.toml --velocity 0,1
  robot length_unit standing structure velocity yaw_rate_deg_s possible slip nearest wheels posture
  posture_from
0 | stance ditch.toml
  title length_unit gravity com holds margin axes region region_is_open feet
0 | optimum r.toml --method map
  robot length_unit method objective convention standing value evaluations parameters last
3 | optimum r.toml -g 0,5,-1
  robot length_unit method objective convention standing value evaluations parameters last
3 | path r.toml --points 3
  robot length_unit terrain method objective convention lag points length ground_tilt_deg path runs
0 | budget r.toml
  robot heading_deg turn_m bump_m budgets
0 | weigh r.toml --scales scales.csv
  robot length_unit mass mass_std recipe_mass com_shift com_std com_open readings next keys
0 | plot r.toml -o figure.svg --kind robot
  robot digest source kind figure bytes
0 | explore r.toml -o page.html
  robot digest source page bytes answers
"""
ROWS = re.split(r"\n(?=\d)", ANSWERS.strip())


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("alike")
    text = tripod(channels=CHANNELS, max_tilt=60.0).replace("[sweep]", f"{WHEEL}[sweep]", 1)
    (folder / "r.toml").write_text(text)
    lutgen.sweep(lutgen.parse_recipe(text), folder / "r.h5")
    shutil.copy(folder / "r.h5", folder / "r")
    shutil.copy(VECTORS / "rover.urdf", folder)
    (folder / "ditch.toml").write_text(DITCH)
    (folder / "scales.csv").write_text("front,left,right\n2.0,2.0,2.0\n")
    return folder


@pytest.mark.parametrize("command", RECIPES)
def test_a_map_given_for_a_recipe_answers_as_the_recipe_inside_it(command, place, tmp_path):
    answers = []
    for source in ("r.toml", "r.h5", "r"):
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
    (tmp_path / "code.toml").write_text(coded("stops").text)
    lutgen.sweep(coded("stops"), tmp_path / "code.h5")
    assert "--allow-python" in run("limits", tmp_path / "code.h5").stderr
    allowed = [
        stdout("limits", tmp_path / name, "--allow-python") for name in ("code.toml", "code.h5")
    ]
    assert allowed[0] == allowed[1]


@pytest.mark.parametrize("command", VERDICTS)
def test_a_verdict_has_the_same_words_and_exit_code_in_every_command(
    command, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    Path("flat.csv").write_text("x,y,z\n0,0,0\n1,0,0\n2,0,0\n")
    feet = "".join(f"[[foot]]\nposition = [{x}, {y}, 0]\n" for x in (1, -1) for y in (1, -1))
    for name, com_x, code in (("stands", 0.02, 0), ("tips", -3.0, 3)):
        text = tripod().replace("com = [0.02,", f"com = [{com_x},")
        text = text.replace("[sweep]", f"{WHEEL}[sweep]", 1)
        if command == "stance":
            text = f"com = [{com_x}, 0, 1]\nfriction = 0.5\n{feet}"
        Path(f"{name}.toml").write_text(text)
        data(command, f"{name}.toml", *VERDICTS[command], code=code)
        result = run(command, f"{name}.toml", *VERDICTS[command])
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


def numbers(value, name=""):
    """Return the names of all numbers of a report, at any depth, but of those without a unit."""
    if isinstance(value, dict):
        parts = [(key, part) for key, part in value.items() if key != "normalised"]
        return {one for key, part in parts for one in numbers(part, key)}
    if isinstance(value, list):
        return {one for part in value for one in numbers(part, name)}
    return {name} if isinstance(value, float) else set()


@pytest.mark.parametrize("row", ROWS, ids=[row.splitlines()[0] for row in ROWS])
def test_an_answer_has_its_exit_code_and_its_keys_and_angles_their_unit(row, place, monkeypatch):
    monkeypatch.chdir(place)
    head, *keys = row.splitlines()
    code, command = head.split(" | ")
    report = data(*shlex.split(command), code=int(code))
    assert list(report) == " ".join(keys).split()
    angles = {one for one in numbers(report) if re.search("angle|slope|tilt|heading|yaw", one)}
    assert [one for one in angles if not re.search("_(deg|rad)(_s)?$", one)] == []


@pytest.mark.parametrize("name", sorted(main.commands))
def test_the_help_of_a_command_begins_with_an_example(name):
    usage, empty, example, *_ = stdout(name, "-h").splitlines()
    assert usage.startswith(f"Usage: main {name}")
    assert (empty, example.split()[:2]) == ("", ["$", "lutgen"])
    assert stdout(name, "--help") == stdout(name, "-h")


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
    assert not imported(*arguments) & {"numpy", "numba", "h5py", "matplotlib", "pydantic", "scipy"}


def test_a_recipe_is_evaluated_without_what_only_maps_figures_and_compiling_need(place):
    # The first may have to compile.
    good("eval", place / "r.toml", *AT)
    modules = imported("eval", place / "r.toml", *AT)
    assert not modules & {"h5py", "matplotlib", "scipy.linalg"}


def test_the_command_offers_the_kinds_of_figures_that_there_are():
    offered = next(p.type for p in main.commands["plot"].params if p.name == "kind")
    assert set(offered.choices) == set(KINDS)
    assert stdout("--version") == f"lutgen, version {lutgen.__version__}\n"


def test_numbers_are_read_as_toml_reads_them(place):
    plain, parted = (run("eval", place / "r.toml", "-p", f"swing={x}") for x in ("10", "1_0"))
    assert plain.stdout == parted.stdout != ""


def test_a_console_without_a_character_shows_its_number(place, tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONIOENCODING", "cp1252")
    text = (place / "r.toml").read_text(encoding="utf-8")
    path = tmp_path / "arrow.toml"
    path.write_text(text.replace('"tripod"', '"a \u2192 b"'), encoding="utf-8")
    command = [sys.executable, "-m", "lutgen", "check", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.startswith("a \\u2192 b: ")

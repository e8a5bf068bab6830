"""Every answer as JSON: its exit code, its keys, which scripts rely on, and units in their names.

That the text of a command says the same is what the guides print, line by line.
"""

import re
import shlex
import shutil

import pytest

import lutgen
from lutgen.cli import main
from tests.cli.test_refusals_cli import DITCH
from tests.fixtures.commands import data
from tests.fixtures.places import VECTORS
from tests.fixtures.recipes import ALL_CHANNELS, tripod

WHEEL = '[[robot.wheel]]\ncontact = "front"\naxis = [0, 1, 0]\nradius = 0.1\n'
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
0 | metrics r.toml --headings 4
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
3 | path r.toml --points 3
  robot length_unit terrain method objective convention lag points length ground_tilt_deg path runs
0 | budget r.toml
  robot source heading_deg turn_m bump_m budgets
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
    """Return a folder with a recipe, its map, and a file of every other kind."""
    folder = tmp_path_factory.mktemp("answers")
    text = tripod(channels=ALL_CHANNELS, max_tilt=60.0).replace("[sweep]", f"{WHEEL}[sweep]", 1)
    (folder / "r.toml").write_text(text)
    lutgen.sweep(lutgen.parse_recipe(text), folder / "r.h5")
    shutil.copy(VECTORS / "rover.urdf", folder)
    (folder / "ditch.toml").write_text(DITCH)
    (folder / "scales.csv").write_text("front,left,right\n2.0,2.0,2.0\n")
    return folder


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


def test_every_command_is_in_the_table():
    # A schema is itself JSON; the others need an export or minutes, and have files of their own.
    listed = {row.split()[2] for row in ROWS}
    others = {"schema", "export", "policy", "control", "paper"}
    assert set(main.commands) == listed | others

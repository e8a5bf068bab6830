"""Whatever is wrong with a command is one sentence on stderr, and an exit code."""

import shlex
import shutil
import time

import click
import h5py
import pytest

import lutgen
from firmware_export.emit import package
from lutgen.cli import main
from lutgen.quantities import CHANNELS
from tests.fixtures.commands import run
from tests.fixtures.exports import tripod_export
from tests.fixtures.places import MAPS, VECTORS
from tests.fixtures.recipes import feet, rigid, tripod

# Within this everything is refused that is said to be refused before the work; seconds.
AT_ONCE = 10.0
SMALL = tripod("reach = 2, swing = 2", nodes=3)
DITCH = """com = [0.3, 0, 0.6]
friction = 0.5
[[foot]]
position = [-1, 0, 0]
normal = [1, 0, 1]
[[foot]]
name = "right"
position = [1, 0, 0]
normal = [-1, 0, 1]
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """Return a folder with sources of every kind, good and bad, which no test changes."""
    folder = tmp_path_factory.mktemp("refusals")
    text = tripod(channels=CHANNELS, max_tilt=60.0)
    lutgen.sweep(lutgen.parse_recipe(text), folder / "tripod.h5")
    with h5py.File(folder / "tripod.h5", "r") as file:
        at = file["margin"].id.get_offset()
    content = bytearray((folder / "tripod.h5").read_bytes())
    (folder / "half.h5").write_bytes(content[: len(content) // 2])
    content[at + 20] ^= 4
    (folder / "damaged.h5").write_bytes(content)
    for name, lines in {
        "tripod.toml": text,
        "bad.toml": text.replace("[[robot.contact]]", "[[robot.contcat]]", 1),
        "above.toml": rigid(feet([(1, 0, 1), (-1, 1, 1), (-1, -1, 1)])),
        "fixed.toml": rigid(feet([(1, 0, -1), (-1, 1, -1), (-1, -1, -1)])),
        "code.toml": rigid("", head='python = "cli_plugin:postures"'),
        "cli_plugin.py": "def postures(q):\n    return 'nothing'\n",
        "text.h5": "this is no HDF5",
        "ditch.toml": DITCH,
        **dict.fromkeys(("mine.toml", "mine.png", "mine.gif", "mine.csv", "mine.html"), "mine"),
    }.items():
        (folder / name).write_text(lines)
    for name in ("rover.urdf", "quadruped.urdf", "quadruped.srdf"):
        shutil.copy(VECTORS / name, folder)
    shutil.copy(VECTORS / "rover.urdf", folder / "rover.xacro")
    shutil.copy(MAPS / "paper_two.toml", folder / "two.toml")
    (folder / "folder.toml").mkdir()
    package.write(tripod_export(), folder / "firmware")
    shutil.copytree(folder / "firmware", folder / "changed")
    source = next((folder / "changed").glob("*.c"))
    source.write_text(source.read_text() + "/* changed */\n")
    return folder


# Bad input is exit code 2, a task that failed 1.
REFUSED = """
2 | bake | No such command 'bake'
2 | check | Missing argument 'RECIPE'
2 | check --fast tripod.toml | --fast
2 | check none.toml | none.toml: there is no such file
2 | check bad.toml | contcat
2 | check above.toml | stands in none
2 | check code.toml | --allow-python
2 | check code.toml --allow-python | got 'str'
2 | check text.h5 | is no HDF5 file
2 | check recipe:absolme | did you mean 'absolem'
2 | check recipe:../tests/zzz | choose from: absolem, articulated
2 | recipes tripod | choose from: absolem
2 | new track -o a.toml | (got 'track'); did you mean 'tracks'
2 | new wheels | needs a file to write (got none)
2 | new | needs a kind (got none)
2 | new wheels -o none/a.toml | choose a folder that exists
2 | new wheels -o mine.toml | mine.toml: is there already, without a mark
2 | sweep tripod.toml | --output
2 | sweep tripod.toml -o none/x.h5 | none/x.h5
2 | sweep tripod.toml -o '' | names nothing
2 | sweep tripod.toml -o tripod.toml | tripod.toml: is there already
2 | plot two.toml --kind robot -o mine.png | mine.png: is there already, without a mark
2 | limits two.toml -o mine.png | mine.png: is there already, without a mark
2 | path two.toml --points 2 --animate mine.gif | mine.gif: is there already, without a mark
2 | path two.toml --points 2 -o mine.csv | mine.csv: is there already
2 | explore two.toml -o mine.html | mine.html: is there already, without a mark
2 | sweep tripod.toml -o x.h5 --threads 2.5 | '2.5' is no whole number of plain digits
2 | sweep tripod.toml -o x.h5 --engine gpu | gpu
2 | info folder.toml | is a folder
2 | info tripod.toml | tripod.toml
2 | info damaged.h5 | damaged
1 | info damaged.h5 --verify | channel margin
2 | eval damaged.h5 | damaged
2 | eval tripod.h5 -p beta=1 | there is no parameter 'beta' (got -p beta=1); it has reach, swing
2 | eval tripod.h5 -p reach=0.1 -p reach=0.2 | given twice
2 | eval tripod.h5 -p reach=0.9 | parameter reach must lie in 0 to 0.6 m (got 0.9)
2 | eval tripod.toml -p swing=51 | swing must lie in -40 to 50 deg (got 51 deg
2 | eval tripod.h5 -p reach=far | 'reach=far' is no assignment; write for example alpha=30
2 | eval tripod.toml -p reach=1e300 | up to 1e12
2 | eval tripod.toml -p reach=\u0661 | up to 1e12
2 | eval tripod.h5 -g 0,0,0 | is no direction; write three numbers such as 0,0,-1
2 | eval tripod.h5 -g 0,0,nan | is no direction
2 | eval tripod.toml -a 1,2 | is no acceleration; write for example -2,0,0
2 | eval tripod.toml -a 0,0,-9.80665 | free fall
2 | eval firmware -p swnig=1 | no parameter 'swnig'
2 | eval folder.toml | is no folder of `lutgen export`
2 | eval changed | is not the file that was exported
2 | limits tripod.toml --headings 6 | must be a multiple of 4 (got 6)
2 | limits tripod.toml --best --headings 100000000 | beyond the limit of 36,000 headings
2 | limits tripod.toml -o limits.gif | unknown kind of picture
2 | limits tripod.toml -o missing/limits.png | cannot be written
2 | metrics tripod.toml --tilt 181 | 181 is not in the range: at least 0 and at most 180
2 | metrics tripod.toml --headings 1000000000 | is not in the range: at least 1 and at most 36,000
2 | optimum two.toml --bounds alpha=20 | is no range; write for example alpha=20:40
2 | optimum two.toml --bounds alpha=40:20 | must be below the upper one (got 40:20)
2 | optimum two.toml --bounds beta=1:2 | there is no parameter 'beta' (got --bounds beta=1:2)
2 | optimum two.toml --bounds alpha=1:2 -p alpha=1 | give it one -p or one --bounds
2 | optimum two.toml --start alpha=1 -p alpha=2 | give it one -p or one --start
2 | optimum two.toml --start alpha=60 --method nelder-mead | must lie within the bounds
2 | optimum two.toml -p alpha=1 -p gamma=2 | no geometry parameter to search
2 | optimum two.toml --objective facet | objective 'facet' is not understood
2 | optimum two.toml --levels 1000000 | 32 levels of a search
2 | weigh tripod.toml | --scales, --tilt: neither is given (got no file); give one of them
2 | weigh tripod.toml --scales none.csv | none.csv: there is no such file
2 | wheels two.toml --velocity 1 | '1' is no velocity; write two numbers such as 0.5,0
2 | wheels two.toml --yaw-rate fast | 'fast' is no number of plain digits up to 1e12
2 | wheels two.toml -g 0,0,1 | no support facet under this gravity
2 | wheels tripod.toml | the robot has no wheels (got no [[robot.wheel]]); add one
2 | path two.toml --points 1 | 1 is not in the range: at least 2 and at most 200,000
2 | path two.toml --terrain none.csv | none.csv: there is no such file
2 | path two.toml --terrain none.csv --points 5 | leave it out
2 | path two.toml --rate alpha=1 | need a speed
2 | path two.toml --rate alpha=1 --rate alpha=2 --speed 1 | given twice
2 | path two.toml --no-control --speed 1 | a shape that does not change has no rates
2 | path two.toml --lag -1 | -1 is not in the range: at least 0
2 | path two.toml --points 3 -o missing/run.csv | cannot be written
2 | path two.toml --points 2 --animate missing/film.gif | cannot be written
2 | path two.toml --points 2 --animate film.avi | unknown kind of film (got '.avi')
2 | path two.toml --points 2 --animate film | unknown kind of film (got 'no suffix')
2 | path fixed.toml | --no-control
2 | budget two.toml --slope 30:0:5 | --slope: at most 200 slopes FROM:TO:STEP from 0 to 80 deg
2 | budget two.toml --slope 0:30:0 | --slope
2 | budget two.toml --over beta=0:1 | there is no parameter 'beta' (got --over beta=0:1)
2 | budget two.toml --turn 0 | --turn': 0 is not in the range: above 0
2 | budget two.toml --bump -1 | -1 is not in the range: at least 0
2 | budget two.toml --headings 5 | their number must be a multiple of 4 (got 5)
2 | control folder.toml | no folder of `lutgen export`
2 | control firmware | without a policy
2 | control firmware --cycle 1 | a folder has its policy
2 | control two.toml --terrain none.csv | none.csv
2 | plot tripod.h5 -o x.png | --kind
2 | plot tripod.h5 -o x.png --kind contour --axes reach,beta | beta
2 | plot tripod.h5 -o x.png --kind contour --channel tilt | tilt
2 | plot tripod.h5 -o x.bmp --kind contour | bmp
2 | explore two.toml -o x.txt | end it in .html or .htm
2 | export tripod.h5 -o out --channels speed | 'speed'
2 | export tripod.h5 -o out --flash many | 'many' is no size
2 | export tripod.h5 -o out --max-error -1% | '-1%' is no error
2 | export tripod.h5 -o out --name int | keyword
1 | export tripod.h5 -o out --codec contacts --flash 100 | got 100 bytes of flash
1 | export tripod.h5 -o out --codec contacts --arithmetic integer | floating point
2 | export half.h5 -o out | half.h5
2 | export none.h5 -o text.h5 | is no folder
2 | export none.h5 -o folder.toml/.. | 'above.toml'
2 | paper -o text.h5/report | the report cannot be written
2 | policy two.toml -o out --nodes 1 | 1 is not in the range: at least 2 and at most 65
2 | policy two.toml -o out --rate beta=1 | there is no parameter 'beta' (got --rate beta=1)
2 | import none.urdf -o a.toml | there is no such file
2 | import rover.urdf -o rover.urdf | end it in .toml
2 | import rover.urdf -o none/a.toml | cannot be written
2 | import rover.urdf -o a.toml --name ' ' | --name: must not be empty
2 | import rover.urdf -o a.toml -c left_weel | did you mean 'left_wheel'
2 | import rover.urdf -o a.toml -c mast | has no collision sphere
2 | import rover.urdf -o a.toml -c mast=0,0,0,-1 | is no point of a link
2 | import rover.urdf -o a.toml -c mast=0,0,0 | needs 3 to 62 contacts (got 1)
2 | import rover.urdf -o a.toml -j arm | did you mean 'arms'
2 | import rover.urdf -o a.toml -j lens_mount | it is fixed
2 | import rover.urdf -o a.toml --arg a=b | is for xacro
2 | import -x rover.xacro -o a.toml --arg a | write NAME=VALUE
2 | import -x rover.xacro -o a.toml --package a | write NAME=DIR
2 | import -x rover.xacro -o a.toml --package =. | write NAME=DIR
2 | import -x rover.xacro -o a.toml --package a=/nowhere | is in no folder that there is
2 | import rover.urdf -o a.toml --srdf none.srdf | there is no such file
2 | import rover.urdf -o a.toml -p lens_mount=1 | no such moving joint
2 | import rover.urdf -o a.toml -p arms=90 | goes from -45.8366 to 45.8366 deg
2 | import rover.urdf -o a.toml -p arms=1 -p arms=2 | is given twice
2 | import rover.urdf -o a.toml -p arms | is no joint and value
2 | import rover.urdf -o a.toml --posture crouch | no SRDF file beside rover.urdf (got 'crouch')
2 | import rover.xacro -o a.toml | pass --xacro if you trust it
2 | import quadruped.urdf -o a.toml --posture standin | did you mean 'standing'
2 | import quadruped.urdf -o a.toml --couple hips=FL_hip | did you mean 'FL_hip_joint'
2 | import quadruped.urdf -o a.toml --couple haunches | names no joints that can move
2 | import quadruped.urdf -o a.toml --couple sdg=FL_hip_joint | is no name of a parameter
2 | import quadruped.urdf -o a.toml --couple a=FL_hip_joint,FL_hip_joint | is named twice
2 | import quadruped.urdf -o a.toml --couple a=FL_hip_joint,FL_knee* | are no mirror images
2 | import quadruped.urdf -o a.toml --couple a=0*FL_hip_joint | a factor is 0
"""


@pytest.fixture
def folder(place, monkeypatch):
    """Make the folder of sources the working one; whatever is refused leaves it as it is."""
    monkeypatch.chdir(place)
    # Python keeps what it compiled of a recipe's code, if it may.
    monkeypatch.setattr("sys.dont_write_bytecode", True)
    return place


@pytest.mark.parametrize("row", REFUSED.strip().splitlines())
def test_what_is_wrong_is_one_sentence_an_exit_code_and_nothing_left_behind(row, folder):
    code, command, said = row.split(" | ")
    before = sorted(path.name for path in folder.rglob("*"))
    start = time.process_time()
    result = run(*shlex.split(command))
    assert time.process_time() - start < AT_ONCE
    assert (result.exit_code, result.stdout) == (int(code), ""), result.output
    assert said in result.stderr
    sentences = [line for line in result.stderr.splitlines() if line.startswith("Error: ")]
    assert len(sentences) == 1
    assert "Traceback" not in result.stderr
    assert sorted(path.name for path in folder.rglob("*")) == before


# What a recipe or the file of `stance` says, changed; and the sentence about it.
WRONG_KEYS = [
    ("com =", "con =", "key `con`: is not a known key (got [0.3, 0, 0.6]); did you mean 'com'"),
    ("com = [0.3, 0, 0.6]\n", "", "key `com`: is missing"),
    (DITCH[DITCH.index("[[") :], "", "key `foot`: is missing"),
    ("normal = [1, 0, 1]", "friction = -2", "key `foot[1].friction`: must be 0 or more"),
    ("normal = [1, 0, 1]", "normal = [0, 0, 0]", "key `foot[1].normal`: must have a length"),
    ('"right"', '"P1"', "key `foot[2].name`: is given twice"),
    ("[-1, 0, 0]", "[1e200, 0, 0]", "must be 1,000,000,000,000 or less (got 1e+200)"),
]
TOO_LARGE = [
    (f"a = {'9' * 5000}", "Exceeds the limit (4300 digits)"),
    (f"a = 0x{'f' * 5000}", "a number of 6021 digits"),
    (f"a = {'[' * 100_000}", "more levels than can be read"),
    (f"{'.'.join('a' * 5000)} = 1", "4,999, at most 200 dots"),
    (SMALL.replace("reach = 2", f"reach = {10**9}"), "must be 1,000,000 or less"),
    (SMALL.replace("nodes = 3", "nodes = 15000"), "nodes`: must be 1,024 or less"),
    (SMALL.replace("[sweep]", "[[robot.force]]\n" * 10_001 + "[sweep]"), "at most 10,000 entries"),
    (
        SMALL.replace("reach = 2, swing = 2", "reach = 1000000, swing = 1000000").replace(
            '"cone"\nnodes = 3\nmax_tilt = 50.0', '"sphere"\nnodes = 1024'
        ),
        "4,611,686,018,427,387,904 nodes of a map",
    ),
]
FILES = [
    *(("stance", DITCH.replace(old, new, 1), said) for old, new, said in WRONG_KEYS),
    *(("check", text, said) for text, said in TOO_LARGE),
]


@pytest.mark.parametrize(("command", "text", "said"), FILES, ids=[said for *_, said in FILES])
def test_a_file_that_is_wrong_or_too_large_is_refused_at_once(command, text, said, tmp_path):
    (tmp_path / "r.toml").write_text(text)
    start = time.process_time()
    result = run(command, tmp_path / "r.toml")
    assert time.process_time() - start < AT_ONCE
    assert (result.exit_code, result.stdout) == (2, "")
    assert said in result.stderr.splitlines()[0]


def test_a_device_without_an_end_is_a_file_too_long(folder):
    assert "more than 4,194,304 bytes" in run("check", "/dev/zero").stderr
    said = run("path", "tripod.toml", "--terrain", "/dev/zero").stderr
    assert "67,108,864 bytes of a terrain" in said


def test_limits_of_more_postures_than_fit_are_refused_before_a_row_is_made(tmp_path):
    path = tmp_path / "r.toml"
    path.write_text(SMALL.replace("reach = 2, swing = 2", "reach = 99999, swing = 99999"))
    assert "50,000,000 postures times headings" in run("limits", path, "--all").stderr


def test_an_empty_text_is_no_path_to_any_command(tmp_path):
    paths = [
        one
        for command in main.commands.values()
        for one in command.params
        if isinstance(one.type, click.Path)
    ]
    for one in paths:
        with pytest.raises(click.BadParameter, match="names nothing"):
            one.type.convert("", one, None)
        assert one.type.convert(str(tmp_path), one, None) == str(tmp_path)
    assert len(paths) > len(main.commands)


@pytest.mark.parametrize(
    "command", ["check 'no\x1b[31m\n.toml'", "info 'no\x1b[31m\n.h5'", "check '--no\x1b[31m'"]
)
def test_a_name_that_a_terminal_would_obey_is_shown_as_an_escape(command):
    result = run(*shlex.split(command))
    assert result.exit_code == 2
    assert "\x1b" not in result.stderr
    said = [line for line in result.stderr.splitlines() if "x1b" in line]
    assert said == result.stderr.splitlines()[-1:]

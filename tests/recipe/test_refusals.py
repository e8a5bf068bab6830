"""Bad recipes: every fault at once, each with file, key, value and the way out."""

import re

import pytest

import lutgen
from lutgen.errors import RecipeError
from lutgen.search.objective import Objective
from tests.fixtures.every_key import CODED, EVERYTHING
from tests.fixtures.pulled import BOX, LEVEL, robot
from tests.fixtures.recipes import feet, rigid

# What is replaced, by what, and how the sentence of the first fault begins: a row for each rule.
# That every key has its type, range and name checked is what test_schema.py compares.
FAULTS = [
    ("friction =", "friktion =", "robot.friktion`: is not a known key (got 0.5); did you mean"),
    ("scale = -1.0", "scael = -1.0", "robot.link[2].joint.scael`: is not a known key (got -1.0);"),
    ('name = "everything"\n', "", "robot.name`: is missing (got nothing); write for example"),
    ('name = "everything"', 'name = "  "', "robot.name`: must not be empty (got '  '); write for"),
    ('length_unit = "m"', 'length_unit = "ft"', "robot.length_unit`: is unknown (got 'ft'); use"),
    ("friction = 0.5", "friction = 0", "robot.friction`: must be above 0 (got 0); write for"),
    ("friction = 0.5", "friction = nan", "robot.friction`: must be finite (got nan); write for"),
    ("rock_angle = 20.0", "rock_angle = -1", "robot.rock_angle`: must be 0 or more (got -1);"),
    ("{ lift = 20.0 }", "{ left = 20.0 }", "robot.home.left`: is not a parameter of the robot"),
    ("{ lift = 20.0 }", "{ lift = -10.1 }", "robot.home.lift`: lies outside the parameter's min"),
    ("{ lift = 20.0 }", "{ lift = 50.1 }", "robot.home.lift`: lies outside the parameter's min"),
    ("{ lift = 20.0 }", '{ lift = "up" }', "robot.home.lift`: must be a number (got 'up'); write"),
    ('name = "lift"\nmin', 'name = "a b"\nmin', "robot.parameter[1].name`: is not an"),
    ('name = "lift"\nmin', 'name = "u"\nmin', "robot.parameter[1].name`: is reserved for the"),
    ("max = 50.0", 'max = 50.0\njoint = "hip"', "robot.parameter[1].joint`: means nothing"),
    ("min = -10.0", "min = 50", "robot.parameter[1].min`: must be below max = 50 (got 50.0);"),
    ('unit = "deg"', 'unit = "mm"', "robot.parameter[1].unit`: is neither an angle nor the robot'"),
    ("mass = 5.0\n", "origin = [1, 0, 0]\nmass = 5.0\n", "robot.link[1].origin`: is not allowed"),
    ("mass = 5.0\n", "", "robot.link[1].com`: changes nothing without a mass (got [0.0, 0.0, 0.1]"),
    ('name = "leg"', 'name = "body"', "robot.link[2].name`: is given twice (got 'body'); choose"),
    ('parent = "body"\n', "", "robot.link[2].parent`: is missing (got nothing); write for"),
    ('parent = "body"', 'parent = "bdy"', "robot.link[2].parent`: is not a link of the robot"),
    ('parent = "body"', 'parent = "leg"', "robot.link[2].parent`: makes a loop of links (got"),
    ("origin = [0, 0, 0.1]", "origin = [0, 0.1]", "robot.link[2].origin`: needs 3 or more"),
    ('type = "revolute"', 'type = "none"', "robot.link[2].joint.axis`: means nothing for type"),
    ('type = "revolute"', 'type = "prismatic"', "robot.link[2].joint.parameter`: of a prismatic"),
    ("axis = [0, 1, 0], par", "axis = [0, 0, 0], par", "robot.link[2].joint.axis`: must have a"),
    ('parameter = "lift"', 'parameter = "left"', "robot.link[2].joint.parameter`: is not a"),
    ("scale = -1.0", "scale = 0", "robot.link[2].joint.scale`: must not be zero (got 0); write"),
    ('name = "c"', 'name = "b"', "robot.contact[3].name`: is given twice (got 'b'); choose"),
    ('link = "leg"', 'link = "arm"', "robot.contact[1].link`: is not a link of the robot (got"),
    (
        "-0.4]\n",
        "-0.4]\naxis = [0, 1, 0]\n",
        "robot.contact[3].axis`: needs a radius above 0 (got [0.0, 1.0, 0.0]);",
    ),
    (
        "-0.4]\n",
        "-0.4]\nrolling = true\n",
        "robot.contact[3].rolling`: needs a radius above 0 (got True);",
    ),
    ("-0.4]\n", "-0.4]\nwidth = 0.1\n", "robot.contact[3].width`: needs a disc (got 0.1);"),
    ("rolling = true", 'rolling = "yes"', "robot.contact[1].rolling`: must be true or false (got"),
    ('contact = "a"', 'contact = "d"', "robot.wheel[1].contact`: is not a contact of the robot"),
    ('contact = "b"', 'contact = "a"', "robot.wheel[2].contact`: carries a wheel already (got 'a'"),
    ('contact = "b"\naxis = [0, 1, 0]', 'contact = "b"', "robot.wheel[2].axis`: is missing (got"),
    ('"a"\naxis = [0, 1, 0]', '"a"\naxis = [0, 1, 1e-6]', "robot.wheel[1].axis`: is not along the"),
    ('"a"\naxis = [0, 1, 0]\nradius = 0.1', '"a"\nradius = 0.2', "robot.wheel[1].radius`: differs"),
    ("steered = true", "steered = true\nrollers = 0", "robot.wheel[1].rollers`: cannot be"),
    ("rollers = 45.0", "rollers = 90", "robot.wheel[2].rollers`: must be below 90 (got 90);"),
    ("force = [-1, 0, 0]", "force = -1", "robot.force[1].force`: must be a list (got -1); write"),
    ("samples = { lift = 3 }", "", "sweep.samples`: is missing (got nothing); give the nodes of"),
    ("{ lift = 3 }", "{ lift = 3, x = 2 }", "sweep.samples.x`: is not a parameter of the robot"),
    ("{ lift = 3 }", "{}", "sweep.samples.lift`: is missing (got nothing); give a number of"),
    ("{ lift = 3 }", "{ lift = 3.0 }", "sweep.samples.lift`: must be a whole number (got 3.0);"),
    ('contacts = ["a", "b"]', 'contacts = ["d"]', "robot.group[1].contacts[1]`: is not a contact"),
    ("{ lift = 3 }", "{ lift = [1, 2, 2] }", "sweep.samples.lift[3]`: does not increase (got 2.0)"),
    ("{ lift = 3 }", "{ lift = [0, 51] }", "sweep.samples.lift[2]`: lies outside the parameter's"),
    ('chart = "cone"', 'chart = "conic"', "sweep.gravity.chart`: is unknown (got 'conic'); did"),
    ('chart = "cone"', 'chart = "sphere"', "sweep.gravity.max_tilt`: belongs to the cone only"),
    ('"sdg", "tip_angle"]', '"sdg", "tip"]', "sweep.gravity.channels[2]`: is unknown (got 'tip');"),
    ('"sdg", "tip_angle"]', '"sdg", "sdg"]', "sweep.gravity.channels[2]`: is given twice (got"),
    ('"sdg", "tip_angle"]', "]", "sweep.gravity.channels`: needs 1 or more entries (got []);"),
    ('channels = ["sdg", "tip_angle"]\n', "", "sweep.gravity.channels`: is missing (got"),
    ('"sdg", "tip_angle"]', '"energy_margin"]', "sweep.gravity.channels[1]`: is not defined under"),
    ("[sweep]\n", '[sweep]\nchannels = ["sdg"]\n', "sweep.channels`: is given in"),
    ('"16KiB"', '"16 acres"', "export.flash`: is not a quantity above 0 (got '16 acres'); write"),
    ('"16KiB"', "0", 'export.flash`: must be 1 or more (got 0); write for example flash = "16KiB"'),
    ('"1%"', '"0.0%"', "export.max_error`: is not a quantity above 0 (got '0.0%'); write for"),
]
FREE = EVERYTHING.replace("home = { lift = 20.0 }", "")
FEET = "".join(
    f'[[robot.contact]]\nname = "x{i}"\nlink = "leg"\nposition = [0, 0, 0]\n' for i in range(60)
)


def refusal(text):
    with pytest.raises(RecipeError) as caught:
        lutgen.parse_recipe(text, "bad.toml")
    return str(caught.value)


@pytest.mark.parametrize(("old", "new", "said"), FAULTS)
def test_a_fault_is_refused_with_its_key(old, new, said):
    assert old in EVERYTHING
    first, *others = refusal(EVERYTHING.replace(old, new, 1)).split("\n")
    assert first.startswith(f"bad.toml: key `{said}")
    for line in (first, *others):
        assert re.fullmatch(r"bad\.toml: key `\S+`: .+ \(got .+\); .+\.", line)


def test_all_faults_are_said_at_once_those_of_types_before_those_of_names():
    text = EVERYTHING.replace("friction =", "friktion =").replace('"cone"', '"conic"')
    text = text.replace("max = 50.0", "max = true").replace('link = "leg"', 'link = "arm"')
    assert refusal(text).split("\n") == [
        "bad.toml: key `robot.friktion`: is not a known key (got 0.5); did you mean 'friction'.",
        "bad.toml: key `robot.parameter[1].max`: must be a number (got True); write for example "
        "max = 50.0.",
        "bad.toml: key `sweep.gravity.chart`: is unknown (got 'conic'); did you mean 'cone'.",
    ]
    text = EVERYTHING.replace('link = "leg"', 'link = "arm"').replace('parent = "body"\n', "")
    assert refusal(text).split("\n") == [
        "bad.toml: key `robot.link[2].parent`: is missing (got nothing); write for example "
        'parent = "body".',
        "bad.toml: key `robot.contact[1].link`: is not a link of the robot (got 'arm'); use one "
        "of: body, leg.",
    ]
    # Each payload lacks four keys, and has one that is not known.
    many = "".join(f"[[robot.payload]]\nnom{i} = 1\n" for i in range(10))
    *ten, last = refusal(EVERYTHING + many).split("\n")
    assert len(ten) == 10
    assert last == "bad.toml: and 40 more faults."


MASSLESS = '[[robot.link]]\nname = "body"\nmass = 0\n'


def weightless(kind, value):
    part = f'[[robot.{kind}]]\nname = "x"\nlink = "body"\nposition = [0, 0, 0]\n{value}\n'
    return rigid(feet(BOX) + part)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (weightless("payload", "mass = 1.0"), "robot.payload[1].mass`: counts for nothing on a"),
        (weightless("force", "force = [1, 0, 0]"), "robot.force[1].force`: counts for nothing"),
        ("", "robot`: is missing (got nothing); write a table [robot]."),
        ("robot = 3", "robot`: must be a table (got 3); write a table [robot]."),
        ("[robot]\nparameter = [1]", "robot.name`: is missing"),
        (f"{EVERYTHING}\n[sweep.x]", "sweep.x`: is not a known key (got {}); use one of: samples"),
        (EVERYTHING.replace("min = -10.0", f"min = {'1' * 4000}"), "robot.parameter[1].min`: is t"),
        (EVERYTHING.replace("min = -10.0", f"min = 0x{'f' * 9999}"), "robot.parameter[1].min`: is"),
        (
            re.sub("joint = .*", "", EVERYTHING),
            "robot.parameter[1].name`: is used by no joint (got",
        ),
        (rigid(feet(BOX) + MASSLESS), "robot.link`: masses are given but all are zero (got 0.0)"),
        (FREE.replace("max = 50.0", "max = -9.999999999999999"), "sweep.samples.lift`: has nodes"),
        (
            CODED.replace("[sweep", "[[robot.contact]]\nlink = 'a'\n[sweep"),
            "robot.contact`: cannot be",
        ),
        (
            f'{EVERYTHING}"a\\nb" = 1',
            r"export.a\nb`: is not a known key (got 1); use one of: flash",
        ),
        (EVERYTHING + FEET, "robot.contact`: a robot needs 3 to 62 contacts (got 63); keep those"),
    ],
)
def test_what_one_change_does_not_make_is_refused_too(text, said):
    assert refusal(text).startswith(f"bad.toml: key `{said}")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('[robot]\nname = "a\n', "is not TOML (got Illegal character '\\n' (at line 2,"),
        ("[robot", "is not TOML (got Expected ']' at the end of a table declaration (at line 1"),
        ("a = 1\nb = \n", "is not TOML (got Invalid value (at line 2,"),
        ("a = \u0661", "is not TOML (got Invalid value (at line 1,"),
    ],
)
def test_what_is_no_toml_is_refused_with_its_line(text, said):
    assert refusal(text).startswith(f"bad.toml: {said}")


def test_a_search_for_an_energy_margin_under_a_load_is_refused():
    with pytest.raises(lutgen.InputError, match="energy_margin is not defined"):
        Objective(robot(feet(BOX), rho=0.1), LEVEL, "energy_margin")

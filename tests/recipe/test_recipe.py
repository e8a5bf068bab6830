"""Recipes: what a good one becomes, and one bad recipe per rule."""

import hashlib
import math
import sys

import numpy as np
import pytest

from lutgen.errors import RecipeError
from lutgen.parts import Contact, Joint, Link, Parameter, Wheel
from lutgen.recipe.recipe import ExportDefaults, load_recipe, parse_recipe
from tests.fixtures.places import MAPS

GOOD = """
[robot]
name = "crab"
length_unit = "mm"
friction = 0.5
upright = 80.0
rock_angle = 20.0
[[robot.parameter]]
name = "lift"
min = -10
max = 50.0
unit = "deg"
[[robot.parameter]]
name = "reach"
min = 100.0
max = 200.0
unit = "mm"
[[robot.link]]
name = "foot"
parent = "leg"
joint = { type = "prismatic", axis = [2, 0, 0], parameter = "reach", offset = 5.0 }
[[robot.link]]
name = "leg"
parent = "body"
origin = [1, 2, 3]
rpy = [0, 0, 90]
joint = { type = "revolute", axis = [0, 3, 4], parameter = "lift", scale = -1.0, offset = 10.0 }
mass = 2.0
com = [7, 8, 9]
[[robot.contact]]
name = "tip"
link = "foot"
position = [0, 0, 0]
[[robot.contact]]
name = "ball"
link = "body"
position = [-50, 40, 0]
radius = 3
[[robot.contact]]
name = "wheel"
link = "body"
position = [-50, -40, 0]
radius = 4.5
axis = [0, -2, 0]
[sweep]
samples = { lift = 4, reach = [100, 110, 200.0] }
[sweep.gravity]
chart = "cone"
max_tilt = 60.0
nodes = 5
channels = ["sdg", "tip_angle"]
[export]
flash = "16KiB"
max_error = "1%"
"""

LINK = '[[robot.link]]\nname = "leg"\n'
CONTACTS = GOOD[GOOD.index("[[robot.contact]]") : GOOD.index("[sweep]")]
LINKS = GOOD[GOOD.index("[[robot.link]]") : GOOD.index("[[robot.contact]]")]
MANY = "".join(
    f'[[robot.contact]]\nname = "c{i}"\nlink = "body"\nposition = [{i}, 0, 0]\n' for i in range(63)
)
CHANNELS = 'channels = ["sdg", "tip_angle"]'

# (what is replaced, by what, the key named, the value received, the way out)
BAD = {
    "unknown key": ("friction =", "friktion =", "robot.friktion", "0.5", "did you mean 'friction'"),
    "unknown table": ("[export]", "[exports]", "exports", "16KiB", "did you mean 'export'"),
    "unknown link key": ("com = [7", "cog = [7", "robot.link[2].cog", "[7, 8, 9]", "'com'"),
    "unknown joint key": ("scale = -1", "scael = -1", "robot.link[2].joint.scael", "-1", "'scale'"),
    "robot missing": (GOOD, "", "robot", "nothing", "add a [robot] table"),
    "robot no table": (GOOD, "robot = 3", "robot", "3", "add a [robot] table"),
    "name missing": ('name = "crab"', "", "robot.name", "nothing", "name the robot"),
    "name empty": ('"crab"', '" "', "robot.name", "' '", "name the robot"),
    "name no string": ('"crab"', "7", "robot.name", "7", "name the robot"),
    "length unit": ('"mm"\nfr', '"ft"\nfr', "robot.length_unit", "'ft'", "use one of: m, cm, mm"),
    "friction zero": ("friction = 0.5", "friction = 0", "robot.friction", "0.0", "leave it out"),
    "friction bool": ("friction = 0.5", "friction = true", "robot.friction", "True", "write a num"),
    "friction nan": ("friction = 0.5", "friction = nan", "robot.friction", "nan", "write a num"),
    "friction text": ("friction = 0.5", 'friction = "0.5"', "robot.friction", "'0.5'", "write a n"),
    "upright zero": ("upright = 80.0", "upright = 0", "robot.upright", "0.0", "use 80"),
    "upright large": ("upright = 80.0", "upright = 180.5", "robot.upright", "180.5", "use 80"),
    "rock angle": ("rock_angle = 20.0", "rock_angle = -1", "robot.rock_angle", "-1.0", "30 is"),
    "rock angle large": ("rock_angle = 20.0", "rock_angle = 46", "robot.rock_angle", "46.0", "30"),
    "parameter no array": (GOOD, '[robot]\nname="a"\nlength_unit="m"\nparameter = 1',
        "robot.parameter", "1", "start each entry with [[robot.parameter]]"),
    "parameter no tables": (GOOD, '[robot]\nname="a"\nlength_unit="m"\nparameter = [1]',
        "robot.parameter[1]", "1", "start each entry with [[robot.parameter]]"),
    "parameter name": ('name = "lift"', 'name = "a b"', "robot.parameter[1].name", "'a b'", "use"),
    "parameter reserved": ('name = "lift"', 'name = "u"', "robot.parameter[1].name", "'u'",
        "choose another name"),
    "parameter twice": ('name = "reach"', 'name = "lift"', "robot.parameter[2].name", "'lift'",
        "choose another name"),
    "unit missing": ('unit = "deg"', "", "robot.parameter[1].unit", "nothing", "use one of: deg"),
    "unit other": ('0.0\nunit = "mm"', '0.0\nunit = "m"', "robot.parameter[2].unit", "'m'",
        "use one of: deg, rad, mm"),
    "min infinite": ("min = 100.0", "min = -inf", "robot.parameter[2].min", "-inf", "write a num"),
    "min huge": ("min = 100.0", "min = -1" + "0" * 400, "robot.parameter[2].min", "-1000",
        "write a number in mm"),
    "min above max": ("min = 100.0", "min = 300", "robot.parameter[2].min", "300.0", "swap"),
    "min equals max": ("min = 100.0", "min = 200", "robot.parameter[2].min", "200.0", "swap"),
    "link twice": ('name = "foot"', 'name = "leg"', "robot.link[2].name", "'leg'", "choose"),
    "link empty": ('name = "foot"', 'name = ""', "robot.link[1].name", "''", "name the link"),
    "link loop": ('parent = "body"', 'parent = "foot"', "robot.link[1].parent",
        "foot -> leg -> foot", "attach one of them to 'body'"),
    "parent unknown": ('parent = "leg"', 'parent = "lge"', "robot.link[1].parent", "'lge'", "leg"),
    "parent missing": ('parent = "leg"', "", "robot.link[1].parent", "nothing", "name the parent"),
    "root placed": ("[[robot.contact]]", '[[robot.link]]\nname = "body"\norigin = [1, 0, 0]\n'
        "[[robot.contact]]", "robot.link[3].origin", "[1, 0, 0]", "remove it"),
    "origin short": ("[1, 2, 3]", "[1, 2]", "robot.link[2].origin", "[1, 2]", "write [x, y, z]"),
    "origin bool": ("[1, 2, 3]", "[1, 2, true]", "robot.link[2].origin[3]", "True", "write [x, y"),
    "mass negative": ("mass = 2.0", "mass = -2.0", "robot.link[2].mass", "-2.0", "write a mass"),
    "mass zero": ("mass = 2.0", "mass = 0.0", "robot.link", "0.0", "remove the mass keys"),
    "com alone": ("mass = 2.0", "", "robot.link[2].com", "[7, 8, 9]", "give mass too"),
    "joint no table": ('joint = { type = "prismatic", axis = [2, 0, 0], parameter = "reach", '
        "offset = 5.0 }", "joint = 1", "robot.link[1].joint", "1", "write joint = {"),
    "joint type": ('"revolute"', '"revolut"', "robot.link[2].joint.type", "'revolut'", "mean 'rev"),
    "joint none": ('"revolute"', '"none"', "robot.link[2].joint.axis", "[0, 3, 4]", "remove it"),
    "joint axis zero": ("[0, 3, 4]", "[0, 0, 0]", "robot.link[2].joint.axis", "[0.0, 0.0, 0.0]",
        "write a direction"),
    "joint axis empty": ("[0, 3, 4]", "[]", "robot.link[2].joint.axis", "[]", "write a direction"),
    "joint parameter": ('parameter = "lift"', 'parameter = "left"',
        "robot.link[2].joint.parameter", "'left'", "did you mean 'lift'"),
    "joint scale zero": ("scale = -1.0", "scale = 0", "robot.link[2].joint.scale", "0.0", "use 1"),
    "revolute in mm": ('parameter = "lift"', 'parameter = "reach"',
        "robot.link[2].joint.parameter", "'reach'", "change the joint's type"),
    "prismatic in deg": ('parameter = "reach"', 'parameter = "lift"',
        "robot.link[1].joint.parameter", "'lift'", "change the joint's type"),
    "parameter unused": ('joint = { type = "prismatic", axis = [2, 0, 0], parameter = "reach", '
        "offset = 5.0 }", "", "robot.parameter[2].name", "'reach'", "use it in a joint or remove"),
    "contacts missing": (CONTACTS, "", "robot.contact", "0", "add contacts"),
    "contacts few": (CONTACTS, CONTACTS[: CONTACTS.rindex("[[")], "robot.contact", "2", "add cont"),
    "contacts many": (CONTACTS, MANY, "robot.contact", "63", "keep those that can touch"),
    "contact twice": ('name = "tip"', 'name = "ball"', "robot.contact[2].name", "'ball'", "choose"),
    "contact link": ('link = "foot"', 'link = "food"', "robot.contact[1].link", "'food'", "'foot'"),
    "position missing": ("position = [0, 0, 0]", "", "robot.contact[1].position", "nothing",
        "write [x, y, z] in the link's frame"),
    "radius negative": ("radius = 3", "radius = -3", "robot.contact[2].radius", "-3.0", "write a"),
    "axis alone": ("radius = 4.5", "", "robot.contact[3].axis", "[0, -2, 0]", "give the disc's"),
    "contact axis zero": ("[0, -2, 0]", "[0, 0, 0]", "robot.contact[3].axis", "[0.0, 0.0, 0.0]",
        "write a direction"),
    "sweep missing": (GOOD[GOOD.index("[sweep]") :], "", "sweep", "nothing", "add a [sweep] table"),
    "samples missing": (GOOD[GOOD.index("samples") : GOOD.index("[sweep.gr")], "",
        "sweep.samples", "nothing", "give the nodes of each parameter: lift, reach"),
    "samples no table": ("{ lift = 4, reach = [100, 110, 200.0] }", "4", "sweep.samples", "4",
        "write samples = {"),
    "samples unknown": ("lift = 4", "left = 4, lift = 4", "sweep.samples.left", "'left'", "'lift'"),
    "sample missing": ("lift = 4, ", "", "sweep.samples.lift", "nothing", "give a number of nodes"),
    "sample one": ("lift = 4", "lift = 1", "sweep.samples.lift", "1", "use 2 or more"),
    "sample fraction": ("lift = 4", "lift = 4.0", "sweep.samples.lift", "4.0", "give a number of"),
    "sample bool": ("lift = 4", "lift = true", "sweep.samples.lift", "True", "give a number of"),
    "sample alike": ("min = -10\nmax = 50.0", "min = 1\nmax = 1.0000000000000002",
        "sweep.samples.lift", "4", "move min and max apart"),
    "knot one": ("[100, 110, 200.0]", "[100]", "sweep.samples.reach", "[100]", "add knots"),
    "knots equal": ("[100, 110, 200.0]", "[100, 100]", "sweep.samples.reach[2]", "100.0", "sort"),
    "knots descend": ("[100, 110, 200.0]", "[100, 150, 120]", "sweep.samples.reach[3]", "120.0",
        "sort the knots"),
    "knot outside": ("[100, 110, 200.0]", "[99, 150]", "sweep.samples.reach[1]", "99.0", "widen"),
    "knot nan": ("[100, 110, 200.0]", "[nan, 150]", "sweep.samples.reach[1]", "nan", "give a numb"),
    "gravity missing": (GOOD[GOOD.index("[sweep.gr") : GOOD.index("[export]")], "",
        "sweep.gravity", "nothing", "add a [sweep.gravity] table"),
    "chart unknown": ('"cone"', '"conic"', "sweep.gravity.chart", "'conic'", "did you mean 'cone'"),
    "tilt missing": ("max_tilt = 60.0", "", "sweep.gravity.max_tilt", "nothing", "write the l"),
    "tilt zero": ("max_tilt = 60.0", "max_tilt = 0", "sweep.gravity.max_tilt", "0.0", "'sphere'"),
    "tilt large": ("max_tilt = 60.0", "max_tilt = 86", "sweep.gravity.max_tilt", "86.0", "sphere"),
    "tilt of sphere": ('"cone"', '"sphere"', "sweep.gravity.max_tilt", "60.0", "remove it"),
    "nodes zero": ("nodes = 5", "nodes = 0", "sweep.gravity.nodes", "0", "use more nodes"),
    "nodes of sphere": ('"cone"\nmax_tilt = 60.0\nnodes = 5', '"sphere"\nnodes = 1',
        "sweep.gravity.nodes", "1", "use more nodes"),
    "nodes fraction": ("nodes = 5", "nodes = 5.0", "sweep.gravity.nodes", "5.0", "write the nodes"),
    "channels missing": (CHANNELS, "", "sweep.gravity.channels", "nothing", "choose from: sdg"),
    "channels empty": (CHANNELS, "channels = []", "sweep.gravity.channels", "[]", "choose from"),
    "channel unknown": ('"tip_angle"]', '"tip"]', "sweep.gravity.channels[2]", "'tip'", "choose"),
    "channel number": ('"tip_angle"]', "3]", "sweep.gravity.channels[2]", "3", "choose from: sdg"),
    "channel twice": ('"tip_angle"]', '"sdg"]', "sweep.gravity.channels[2]", "'sdg'", "remove one"),
    "channels twice": ("[sweep.gravity]", f"{CHANNELS}\n[sweep.gravity]", "sweep.channels",
        "['sdg', 'tip_angle']", "keep one of them"),
    "flash unit": ('"16KiB"', '"16 acres"', "export.flash", "'16 acres'", "write bytes or '16KiB'"),
    "flash zero": ('"16KiB"', "0", "export.flash", "0", "write bytes or '16KiB'"),
    "flash bool": ('"16KiB"', "true", "export.flash", "True", "write bytes or '16KiB'"),
    "error negative": ('"1%"', "-0.01", "export.max_error", "-0.01", "write '1%' or 0.01"),
    "error zero": ('"1%"', '"0.0%"', "export.max_error", "'0.0%'", "write '1%' or 0.01"),
    "python refused": ("friction =", 'python = "a:b"\nfriction =', "robot.link", "name", "remove"),
}  # fmt: skip


@pytest.mark.parametrize("rule", BAD)
def test_a_bad_recipe_is_refused_with_file_key_value_and_way_out(rule):
    old, new, key, got, way_out = BAD[rule]
    assert old in GOOD
    with pytest.raises(RecipeError) as caught:
        parse_recipe(GOOD.replace(old, new, 1), "bad.toml")
    message = str(caught.value)
    what, _, rest = message.partition("; ")
    assert what.startswith(f"bad.toml: key `{key}`: ")
    assert got in what[what.index("(got ") :]
    assert way_out in rest
    assert message.endswith(".")
    assert "\n" not in message


def test_a_good_recipe_becomes_radians_and_unit_vectors():
    recipe = parse_recipe(GOOD, "crab.toml")
    assert (recipe.name, recipe.length_unit, recipe.friction) == ("crab", "mm", 0.5)
    assert (recipe.upright, recipe.rock_angle) == (math.radians(80), math.radians(20))
    assert recipe.parameters == (
        Parameter("lift", math.radians(-10), math.radians(50), "rad", "deg"),
        Parameter("reach", 100.0, 200.0, "mm", "mm"),
    )
    lift = Joint("revolute", (0.0, 0.6, 0.8), "lift", -1.0, math.radians(10))
    reach = Joint("prismatic", (1.0, 0.0, 0.0), "reach", 1.0, 5.0)
    zero = (0.0, 0.0, 0.0)
    rpy = (0.0, 0.0, math.radians(90))
    assert recipe.links == (
        Link("body"),
        Link("foot", "leg", zero, zero, reach),
        Link("leg", "body", (1.0, 2.0, 3.0), rpy, lift, 2.0, (7.0, 8.0, 9.0)),
    )
    assert recipe.contacts == (
        Contact("tip", "foot", zero),
        Contact("ball", "body", (-50.0, 40.0, 0.0), 3.0),
        Contact("wheel", "body", (-50.0, -40.0, 0.0), 4.5, (0.0, -1.0, 0.0)),
    )
    assert [contact.kind for contact in recipe.contacts] == ["point", "sphere", "disc"]
    assert recipe.contact_names == ("tip", "ball", "wheel")
    assert recipe.channels == ("sdg", "tip_angle")
    assert recipe.export == ExportDefaults("16KiB", "1%")
    assert (recipe.chart.kind, recipe.chart.nodes) == ("cone", 5)
    assert recipe.chart.max_tilt == math.radians(60)
    assert (recipe.python, recipe.source, recipe.text) == (None, "crab.toml", GOOD)
    assert recipe.digest == hashlib.sha256(GOOD.encode()).hexdigest()


def test_samples_are_even_nodes_with_both_ends_or_the_knots_as_listed():
    lift, reach = parse_recipe(GOOD).grid.axes
    # linspace in radians against the degrees one by one: the last place of 0.9.
    np.testing.assert_allclose(lift.knots, np.radians([-10, 10, 30, 50]), rtol=0, atol=2e-16)
    assert (lift.name, lift.unit, lift.knots[0], lift.knots[-1]) == (
        *("lift", "rad"),
        *(math.radians(-10), math.radians(50)),
    )
    assert (reach.name, reach.unit, reach.knots.tolist()) == ("reach", "mm", [100, 110, 200])


def test_what_is_optional_gets_its_documented_default():
    text = GOOD[: GOOD.index("[export]")]
    for line in ("friction = 0.5", "upright = 80.0", "rock_angle = 20.0", "mass = 2.0", "com = [7, 8, 9]"):  # fmt: skip  # noqa: E501
        text = text.replace(line, "")
    recipe = parse_recipe(text)
    assert recipe.friction is None
    assert (recipe.upright, recipe.rock_angle) == (math.radians(80), math.radians(30))
    assert recipe.export == ExportDefaults(None, None)
    assert all(link.mass == 0.0 for link in recipe.links)
    assert recipe.source == "<recipe>"


def test_a_parameter_may_be_in_radians():
    text = GOOD.replace('max = 50.0\nunit = "deg"', 'max = 1.5\nunit = "rad"')
    recipe = parse_recipe(text.replace("offset = 10.0", "offset = 0.25"))
    assert recipe.parameters[0] == Parameter("lift", -10.0, 1.5, "rad", "rad")
    assert recipe.links[2].joint.offset == 0.25


def test_channels_may_stand_in_sweep_instead_of_gravity():
    moved = GOOD.replace(CHANNELS, "").replace("[sweep]", f"[sweep]\n{CHANNELS}")
    assert parse_recipe(moved).channels == ("sdg", "tip_angle")


def test_a_joint_of_type_none_is_a_fixed_link():
    text = GOOD.replace("[[robot.contact]]", '[[robot.link]]\nname = "cap"\nparent = "body"\n'
                        'joint = { type = "none" }\n[[robot.contact]]', 1)  # fmt: skip
    assert parse_recipe(text).links[-1] == Link("cap", "body")


def test_the_root_link_may_be_declared_to_give_it_a_mass():
    text = GOOD.replace(
        "[[robot.link]]", '[[robot.link]]\nname = "body"\nmass = 3\n[[robot.link]]', 1
    )
    links = parse_recipe(text).links
    assert links[0] == Link("body", mass=3.0)
    assert [link.name for link in links] == ["body", "foot", "leg"]


def test_a_robot_without_parameters_has_a_map_over_gravity_alone():
    robot = MANY[: MANY.index('[[robot.contact]]\nname = "c3"')]
    gravity = GOOD[GOOD.index("[sweep]") : GOOD.index("[export]")]
    gravity = gravity.replace("samples = { lift = 4, reach = [100, 110, 200.0] }", "")
    recipe = parse_recipe(f'[robot]\nname = "cart"\nlength_unit = "m"\n{robot}{gravity}')
    assert (recipe.parameters, recipe.grid.shape, recipe.grid.size) == ((), (), 1)


@pytest.mark.parametrize(
    ("written", "kept"),
    [("16384", "16384"), ('"16 KiB"', "16 KiB"), ('"2MiB"', "2MiB"), ('"512"', "512")],
)
def test_flash_may_be_bytes_or_text(written, kept):
    assert parse_recipe(GOOD.replace('"16KiB"', written)).export.flash == kept


@pytest.mark.parametrize(
    ("written", "kept"), [("0.01", "0.01"), ("1", "1"), ('"0.5 %"', "0.5 %"), ("1e-3", "0.001")]
)
def test_the_largest_error_may_be_a_number_or_a_percentage(written, kept):
    assert parse_recipe(GOOD.replace('"1%"', written)).export.max_error == kept


def test_recipes_are_equal_and_hashable_by_content():
    assert parse_recipe(GOOD) == parse_recipe(GOOD)
    assert hash(parse_recipe(GOOD)) == hash(parse_recipe(GOOD))
    other = parse_recipe(GOOD.replace("mass = 2.0", "mass = 2.5"))
    assert other != parse_recipe(GOOD)
    assert other.digest != parse_recipe(GOOD).digest


@pytest.mark.parametrize(
    ("text", "got"),
    [('[robot]\nname = "a\n', "line 2"), ("[robot", "line 1"), ("a = 1\nb = \n", "line 2")],
)
def test_a_toml_mistake_is_refused_with_its_line(text, got):
    with pytest.raises(RecipeError, match=rf"^bad\.toml: is not TOML \(got .*{got}.*\); correct"):
        parse_recipe(text, "bad.toml")


def test_a_file_is_read_with_its_name_for_messages(tmp_path):
    path = tmp_path / "crab.toml"
    path.write_text(GOOD, encoding="utf-8-sig")
    recipe = load_recipe(path)
    assert recipe.source == str(path)
    # A byte order mark belongs to the file, not to the recipe.
    assert recipe.digest == parse_recipe(GOOD).digest


def test_a_missing_file_is_refused_with_its_name(tmp_path):
    with pytest.raises(RecipeError, match=r"none\.toml: there is no such file; check the path\."):
        load_recipe(tmp_path / "none.toml")


def test_a_folder_is_refused_with_the_system_s_reason(tmp_path):
    with pytest.raises(RecipeError, match=r"cannot be read \(got .*directory\); check the path\."):
        load_recipe(tmp_path)


def test_a_file_that_is_not_utf8_is_refused_with_line_and_byte(tmp_path):
    path = tmp_path / "latin.toml"
    path.write_bytes(b'[robot]\nname = "h\xe9"\n')
    with pytest.raises(RecipeError, match=r"line 2 is not UTF-8 \(got byte 0xe9\); save the file"):
        load_recipe(path)


PYTHON = """
[robot]
name = "coded"
length_unit = "m"
python = "MODULE:FUNCTION"
[[robot.parameter]]
name = "spread"
min = 1.0
max = 3.0
unit = "m"
[sweep]
samples = { spread = 3 }
[sweep.gravity]
chart = "sphere"
nodes = 3
channels = ["sdg"]
"""
CODE = """
import numpy as np
def feet(q):
    one = np.ones_like(q[:, 0])
    x = np.stack([q[:, 0], -one, -one], axis=1)
    y = np.stack([0 * one, one, -one], axis=1)
    return np.stack([x, y, -np.ones_like(x)], axis=2), np.zeros((len(q), 3)) + [0, 0, 0.5]
def flat(q): return np.zeros((len(q), 3)), np.zeros((len(q), 3))
def pair(q): return np.zeros((len(q), 2, 3)), np.zeros((len(q), 3))
def lone(q): return np.zeros((len(q), 3, 3))
def lost(q): return np.full((len(q), 3, 3), np.nan), np.zeros((len(q), 3))
number = 3
"""


@pytest.fixture
def coded(tmp_path):
    """Return a reader of recipes beside a module; the module is forgotten afterwards."""

    def read(function, allow_python=True, module="coded_robot"):
        (tmp_path / "coded_robot.py").write_text(CODE)
        path = tmp_path / "coded.toml"
        path.write_text(PYTHON.replace("MODULE:FUNCTION", f"{module}:{function}"))
        return load_recipe(path, allow_python)

    yield read
    sys.modules.pop("coded_robot", None)


def test_a_robot_given_by_code_is_refused_unless_the_caller_allows_it(coded):
    with pytest.raises(RecipeError, match=r"`robot\.python`: runs code .*pass --allow-python"):
        coded("feet", allow_python=False)
    assert "coded_robot" not in sys.modules


def test_a_robot_given_by_code_is_found_beside_its_recipe_and_has_numbered_points(coded):
    before = list(sys.path)
    recipe = coded("feet")
    assert sys.path == before
    assert recipe.python == "coded_robot:feet"
    assert recipe.contact_names == ("P1", "P2", "P3")
    assert {contact.kind for contact in recipe.contacts} == {"point"}
    contacts, com = recipe.function(np.array([[2.0]]))
    assert contacts[0, 0].tolist() == [2.0, 0.0, -1.0]
    assert com.tolist() == [[0.0, 0.0, 0.5]]


@pytest.mark.parametrize(
    ("function", "what"),
    [
        ("flat", r"must return contacts \(m, n, 3\) and com \(m, 3\) \(got \[\(1, 3\)"),
        ("pair", r"must return 3 to 62 contacts \(got 2\)"),
        ("lone", r"must return contacts and com \(got 'ndarray'\)"),
        ("lost", r"NaN or infinity at the middle posture"),
        ("none", r"module has no function none"),
        ("number", r"module has no function number"),
    ],
)
def test_code_that_returns_something_else_is_refused(coded, function, what):
    with pytest.raises(RecipeError, match=rf"coded\.toml: key `robot\.python`: .*{what}.*; .+\."):
        coded(function)


def test_a_module_that_is_not_there_is_refused(coded):
    with pytest.raises(RecipeError, match=r"cannot be imported: No module named 'not_there'"):
        coded("feet", module="not_there")


def test_a_module_that_hides_behind_another_of_its_name_is_refused(coded, tmp_path):
    (tmp_path / "json.py").write_text(CODE)
    with pytest.raises(RecipeError, match=r"is loaded already from .*; rename the file"):
        coded("feet", module="json")


@pytest.mark.parametrize("name", ["coded_robot", ":feet", "coded_robot:"])
def test_python_without_module_and_function_is_refused(tmp_path, name):
    text = PYTHON.replace("MODULE:FUNCTION", name)
    with pytest.raises(RecipeError, match=r"must be module:function \(got '.*'\); write for ex"):
        parse_recipe(text, str(tmp_path / "coded.toml"), allow_python=True)


def test_links_or_contacts_beside_python_are_refused(tmp_path):
    wheel = '[[robot.wheel]]\ncontact = "P1"\n'
    for table in ('[[robot.link]]\nname = "a"\n', '[[robot.contact]]\nname = "a"\n', wheel):
        text = PYTHON.replace("[sweep]", f"{table}[sweep]")
        with pytest.raises(RecipeError, match=r"cannot be combined with `robot\.python`"):
            parse_recipe(text, str(tmp_path / "coded.toml"), allow_python=True)


def test_every_recipe_of_the_project_reads_and_is_named_after_its_file():
    paths = sorted(MAPS.glob("*.toml"))
    assert {path.stem for path in paths} >= {
        *("absolem", "paper_one", "paper_two", "three_leg_sphere")
    }
    for path in paths:
        assert load_recipe(path).name == path.stem


WHEELS = """
[[robot.wheel]]
contact = "tip"
axis = [0, 3, 4]
radius = 7
steered = true
[[robot.wheel]]
contact = "ball"
axis = [0, 0, -2]
radius = 3.5
rollers = -45
[[robot.wheel]]
contact = "wheel"
"""
ROLLING = GOOD.replace("[sweep]", f"{WHEELS}[sweep]", 1)


def test_wheels_have_unit_axles_and_those_on_discs_are_the_discs():
    assert parse_recipe(ROLLING).wheels == (
        Wheel("tip", (0.0, 0.6, 0.8), 7.0, True),
        Wheel("ball", (0.0, 0.0, -1.0), 3.5, False, math.radians(-45)),
        Wheel("wheel", (0.0, -1.0, 0.0), 4.5),
    )
    assert parse_recipe(GOOD).wheels == ()


def test_a_wheel_on_a_disc_may_repeat_its_radius_and_turn_its_axle_round():
    repeated = 'contact = "wheel"\nradius = 4.5\naxis = [0, 5, 0]'
    recipe = parse_recipe(ROLLING.replace('contact = "wheel"', repeated))
    assert recipe.wheels[2] == Wheel("wheel", (0.0, 1.0, 0.0), 4.5)
    assert recipe.contacts == parse_recipe(GOOD).contacts


BAD_WHEELS = {
    "unknown key": ("steered =", "stered =", "[1].stered", "True", "did you mean 'steered'"),
    "contact missing": ('contact = "tip"', "", "[1].contact", "nothing", "name the contact"),
    "contact unknown": ('contact = "tip"', 'contact = "tipp"', "[1].contact", "'tipp'", "'tip'"),
    "contact twice": ('"ball"\na', '"tip"\na', "[2].contact", "'tip'", "give each contact one"),
    "axis missing": ("axis = [0, 3, 4]", "", "[1].axis", "nothing", "write the axle's direction"),
    "axis zero": ("[0, 3, 4]", "[0, 0, 0]", "[1].axis", "[0.0, 0.0, 0.0]", "write the axle's"),
    "radius missing": ("radius = 7", "", "[1].radius", "nothing", "write the rolling radius"),
    "radius zero": ("radius = 7", "radius = 0", "[1].radius", "0.0", "write the rolling radius"),
    "radius negative": ("radius = 7", "radius = -7", "[1].radius", "-7.0", "write the rolling"),
    "steered no bool": ("= true", "= 1", "[1].steered", "1", "write steered = true"),
    "rollers no number": ("= -45", "= true", "[2].rollers", "True", "write an angle in deg"),
    "rollers across": ("= -45", "= 90", "[2].rollers", "90.0", "use 0 for an omniwheel"),
    "rollers steered": ("= -45", "= 0\nsteered = true", "[2].rollers", "0.0", "remove one"),
    "disc's axis": ('"wheel"', '"wheel"\naxis = [0, 1, 1e-6]', "[3].axis", "[0, 1, 1e-06]", "remo"),
    "disc's radius": ('"wheel"', '"wheel"\nradius = 4.6', "[3].radius", "4.6", "remove it"),
    "disc's radius zero": ('"wheel"', '"wheel"\nradius = 0', "[3].radius", "0.0", "write the roll"),
}


@pytest.mark.parametrize("rule", BAD_WHEELS)
def test_a_bad_wheel_is_refused_with_file_key_value_and_way_out(rule):
    old, new, key, got, way_out = BAD_WHEELS[rule]
    assert old in WHEELS
    text = GOOD.replace("[sweep]", f"{WHEELS.replace(old, new, 1)}[sweep]", 1)
    with pytest.raises(RecipeError) as caught:
        parse_recipe(text, "bad.toml")
    what, _, rest = str(caught.value).partition("; ")
    assert what.startswith(f"bad.toml: key `robot.wheel{key}`: ")
    assert got in what[what.index("(got ") :]
    assert way_out in rest
    assert rest.endswith(".")

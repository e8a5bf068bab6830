"""Recipes: what a good one becomes, where it is read from, and robots given by code."""

import hashlib
import math
import sys

import numpy as np
import pytest

import lutgen
from lutgen.errors import RecipeError
from lutgen.parts import Contact, Joint, Link, Parameter, Wheel
from lutgen.recipe import HDF5
from lutgen.recipe.recipe import ExportDefaults, load_recipe, parse_recipe
from tests.fixtures.every_key import CODED
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import feet, rigid

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

CHANNELS = 'channels = ["sdg", "tip_angle"]'


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


def test_keys_for_figures_are_kept_and_change_nothing_else():
    text = GOOD.replace("friction =", 'title = "A crab"\nfriction =')
    text = text.replace("min = -10", 'meaning = "0: flat"\nmin = -10')
    text = text.replace("mass = 2.0", "shape = [3, 2, 1]\nmass = 2.0")
    text = text.replace("radius = 4.5", 'radius = 4.5\nwidth = 2\nbelt = "left"')
    plain, drawn = parse_recipe(GOOD), parse_recipe(text)
    assert (drawn.title, drawn.parameters[0].meaning) == ("A crab", "0: flat")
    assert drawn.links[2].shape == (3.0, 2.0, 1.0)
    assert (drawn.contacts[2].width, drawn.contacts[2].belt) == (2.0, "left")
    params, down = [[0.1, 150.0]], [[0.1, 0.2, -1.0]]
    one, other = (lutgen.evaluate(recipe, params, down)["tip_angle"] for recipe in (plain, drawn))
    assert one == other != 0.0


def test_what_may_be_written_otherwise():
    text = GOOD.replace('max = 50.0\nunit = "deg"', 'max = 1.5\nunit = "rad"')
    text = text.replace("offset = 10.0", "offset = 0.25").replace('"crab"', '"$1 crab"')
    text = text.replace(CHANNELS, "").replace("[sweep]", f"[sweep]\n{CHANNELS}")
    body = '[[robot.link]]\nname = "body"\nmass = 3\n'
    fixed = '[[robot.link]]\nname = "cap"\nparent = "body"\njoint = { type = "none" }\n'
    recipe = parse_recipe(text.replace("[[robot.link]]", f"{fixed}{body}[[robot.link]]", 1))
    assert recipe.parameters[0] == Parameter("lift", -10.0, 1.5, "rad", "rad")
    assert recipe.links[:2] == (Link("cap", "body"), Link("body", mass=3.0))
    assert recipe.links[3].joint.offset == 0.25
    assert recipe.channels == ("sdg", "tip_angle")
    assert repr(recipe) == "<Recipe '$1 crab': 3 contacts, lift, reach, <recipe>>"


def test_a_robot_without_parameters_has_a_map_over_gravity_alone():
    recipe = parse_recipe(rigid(feet([(0, 0, 0), (1, 0, 0), (2, 0, 0)])))
    assert (recipe.parameters, recipe.grid.shape, recipe.grid.size) == ((), (), 1)


@pytest.mark.parametrize(
    ("flash", "error", "kept"),
    [
        ("16384", "0.01", ("16384", "0.01")),
        ('"16 KiB"', "1", ("16 KiB", "1")),
        ('" 2MiB"', '"0.5 %"', ("2MiB", "0.5 %")),
        ('"512"', "1e-3", ("512", "0.001")),
    ],
)
def test_quantities_may_be_numbers_or_texts(flash, error, kept):
    text = GOOD.replace('"16KiB"', flash).replace('"1%"', error)
    assert parse_recipe(text).export == ExportDefaults(*kept)


def test_recipes_are_equal_and_hashable_by_content():
    assert parse_recipe(GOOD) == parse_recipe(GOOD)
    assert hash(parse_recipe(GOOD)) == hash(parse_recipe(GOOD))
    other = parse_recipe(GOOD.replace("mass = 2.0", "mass = 2.5"))
    assert other != parse_recipe(GOOD)
    assert other.digest != parse_recipe(GOOD).digest


def test_a_file_is_read_with_its_name_for_messages(tmp_path):
    path = tmp_path / "crab.toml"
    path.write_text(GOOD, encoding="utf-8-sig")
    recipe = load_recipe(path)
    assert recipe.source == str(path)
    # A byte order mark belongs to the file, not to the recipe.
    assert recipe.digest == parse_recipe(GOOD).digest


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("none.toml", r"none\.toml: there is no such file; check the path\."),
        (".", r"cannot be read \(got .*directory\); check the path\."),
        ("latin.toml", r"line 2 is not UTF-8 \(got byte 0xe9\); save the file as UTF-8\."),
        ("map.h5", r"is no text \(got HDF5, as maps are\); the recipe inside a map is"),
        ("long.toml", r"is too long \(got more than 4,194,304 bytes of a recipe"),
    ],
)
def test_what_is_no_text_of_a_recipe_is_refused(tmp_path, name, said):
    (tmp_path / "latin.toml").write_bytes(b'[robot]\nname = "h\xe9"\n')
    (tmp_path / "map.h5").write_bytes(HDF5 + b"x")
    (tmp_path / "long.toml").write_text("#" * (1 << 22) + "\n")
    with pytest.raises(RecipeError, match=said):
        load_recipe(tmp_path / name)


SPREAD = '[[robot.parameter]]\nname = "spread"\nmin = 1.0\nmax = 3.0\nunit = "m"\n'
CODED_TEXT = CODED.replace("[sweep.", f"{SPREAD}[sweep]\nsamples = {{ spread = 3 }}\n[sweep.")
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

    def read(name, allow_python=True):
        for module in ("coded_robot", "json"):
            (tmp_path / f"{module}.py").write_text(CODE)
        path = tmp_path / "coded.toml"
        path.write_text(CODED_TEXT.replace("rover:postures", name))
        return load_recipe(path, allow_python)

    yield read
    sys.modules.pop("coded_robot", None)


def test_a_robot_given_by_code_is_found_beside_its_recipe_and_has_numbered_points(coded):
    with pytest.raises(RecipeError, match=r"`robot\.python`: runs code .*pass --allow-python"):
        coded("coded_robot:feet", allow_python=False)
    assert "coded_robot" not in sys.modules
    before = list(sys.path)
    recipe = coded("coded_robot:feet")
    assert sys.path == before
    assert recipe.contact_names == ("P1", "P2", "P3")
    assert {contact.kind for contact in recipe.contacts} == {"point"}
    contacts, com = recipe.function(np.array([[2.0]]))
    assert contacts[0, 0].tolist() == [2.0, 0.0, -1.0]
    assert com.tolist() == [[0.0, 0.0, 0.5]]


@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("coded_robot:flat", r"must return contacts \(m, n, 3\) and com \(m, 3\) \(got \[\(1, 3\)"),
        ("coded_robot:pair", r"must return 3 to 62 contacts \(got 2\)"),
        ("coded_robot:lone", r"must return contacts and com \(got 'ndarray'\)"),
        ("coded_robot:lost", r"NaN or infinity at the middle posture"),
        ("coded_robot:none", r"module has no function none"),
        ("coded_robot:number", r"module has no function number"),
        ("not_there:feet", r"cannot be imported: No module named 'not_there'"),
        ("json:feet", r"is loaded already from .*; rename the file"),
        ("coded_robot", r"must be module:function \(got '.*'\); write for ex"),
        (":feet", r"must be module:function"),
        ("coded_robot:", r"must be module:function"),
    ],
)
def test_code_that_is_no_robot_is_refused(coded, name, what):
    with pytest.raises(RecipeError, match=rf"coded\.toml: key `robot\.python`: .*{what}.*\."):
        coded(name)


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

"""Recipes: what a good one becomes, where it is read from, and robots given by code."""

import hashlib
import math
import re
import sys

import numpy as np
import pytest

import lutgen
from lutgen.errors import InputError, RecipeError
from lutgen.parts import Contact, Force, Joint, Link, Parameter, Wheel
from lutgen.recipe import HDF5, forward
from lutgen.recipe.recipe import ExportDefaults, load_recipe, parse_recipe
from tests.fixtures.every_key import CODED, EVERYTHING

CHANNELS = 'channels = ["sdg", "tip_angle"]'
ZERO = (0.0, 0.0, 0.0)


def test_a_good_recipe_becomes_radians_and_unit_vectors():
    text = EVERYTHING.replace("axis = [0, 1, 0], par", "axis = [0, 3, 4], par")
    recipe = parse_recipe(
        text.replace("axis = [0, 1, 0]\nrolling", "axis = [0, -2, 0]\nrolling"), "e"
    )
    assert (recipe.name, recipe.title) == ("everything", "Everything, at once")
    assert (recipe.length_unit, recipe.friction, recipe.com_uncertainty) == ("m", 0.5, 0.01)
    assert recipe.com_offset == (0.0, 0.0, 0.25)
    assert (recipe.upright, recipe.rock_angle) == (math.radians(80), math.radians(20))
    assert (recipe.rest_width, recipe.contact_tolerance) == (0.01, 0.001)
    low, high = math.radians(-10), math.radians(50)
    assert recipe.parameters == (Parameter("lift", low, high, "rad", "deg", "0: level"),)
    assert recipe.home == {"lift": math.radians(20)}
    lift = Joint("revolute", (0.0, 0.6, 0.8), "lift", -1.0, math.radians(5))
    rpy, box = (0.0, 0.0, math.radians(10)), ((0.5, 0.4, 0.1), (0.1, 0.0, 0.0))
    assert recipe.links == (
        Link("body", None, ZERO, ZERO, None, 5.0, (0.0, 0.0, 0.1), *box),
        Link("leg", "body", (0.0, 0.0, 0.1), rpy, lift, 1.0, (0.1, 0.0, 0.0)),
        Link("load", "body", (0.0, 0.0, 0.2), mass=1.0),
    )
    assert recipe.contacts == (
        Contact("a", "leg", (0.5, 0.3, -0.3), 0.1, (0.0, -1.0, 0.0), True, 0.05, "left"),
        Contact("b", "body", (-0.5, 0.3, -0.3), 0.1),
        Contact("c", "body", (0.0, -0.3, -0.4)),
    )
    assert [contact.kind for contact in recipe.contacts] == ["disc", "sphere", "point"]
    assert recipe.wheels == (
        Wheel("a", (0.0, 1.0, 0.0), 0.1, True),
        Wheel("b", (0.0, 1.0, 0.0), 0.1, False, math.radians(45)),
    )
    force = Force("rope", "body", (0.0, 0.0, 0.2), (-1.0, 0.0, 0.0), (0.0, 0.1, 0.0))
    assert recipe.forces == (force,)
    assert recipe.channels == ("sdg", "tip_angle")
    assert recipe.export == ExportDefaults("16KiB", "1%")
    chart = recipe.chart
    assert (chart.kind, chart.nodes, chart.max_tilt) == ("cone", 5, math.radians(60))
    (axis,) = recipe.grid.axes
    assert (axis.name, axis.unit) == ("lift", "rad")
    # linspace in radians against the degrees one by one: the last place of 0.9.
    np.testing.assert_allclose(axis.knots, np.radians([-10, 20, 50]), rtol=0, atol=2e-16)
    assert repr(recipe) == "<Recipe 'everything': 3 contacts, lift, e>"


def test_what_is_left_out_gets_its_documented_default():
    drop = r"^(title|friction|upright|rock_angle|rest_width|contact_tolerance|com_\w+|home|mass"
    drop += r"|com|shape(_at)?|origin|rpy|rolling|width|belt|meaning) = .*\n"
    drop += r"|\[\[robot.(force|payload)"
    text = re.sub(r"\[\[robot\.(payload|wheel)(.|\n)*(?=\[sweep\])", "", EVERYTHING)
    recipe = parse_recipe(re.sub(drop, "", text.partition("[export]")[0], flags=re.MULTILINE))
    assert (recipe.title, recipe.friction, recipe.rest_width) == (None, None, None)
    assert (recipe.contact_tolerance, recipe.com_uncertainty, recipe.home) == (None, 0.0, {})
    assert recipe.com_offset == ZERO
    assert (recipe.upright, recipe.rock_angle) == (math.radians(80), math.radians(30))
    assert (recipe.links[0], recipe.links[1].com, recipe.links[1].rpy) == (Link("body"), ZERO, ZERO)
    assert (recipe.wheels, recipe.forces, len(recipe.links)) == ((), (), 2)
    assert recipe.contacts[0] == Contact("a", "leg", (0.5, 0.3, -0.3), 0.1, (0.0, 1.0, 0.0))
    assert recipe.export == ExportDefaults(None, None)
    assert recipe.source == "<recipe>"


def test_what_may_be_written_otherwise():
    text = EVERYTHING.replace('max = 50.0\nunit = "deg"', 'max = 1.5\nunit = "rad"')
    text = text.replace("lift = 20.0", "lift = 1.0").replace('"everything"', '"$1 crab"')
    text = text.replace('"16KiB"', "16384").replace('"1%"', "0.01")
    text = text.replace(CHANNELS, "").replace("[sweep]", f"[sweep]\n{CHANNELS}")
    text = text.replace("lift = 3", "lift = [-10, 1, 1.5]")
    text = text.replace('contact = "a"\naxis = [0, 1, 0]\nradius = 0.1', 'contact = "a"')
    fixed = '[[robot.link]]\nname = "cap"\nparent = "body"\njoint = { type = "none" }\n'
    recipe = parse_recipe(text.replace("[[robot.link]]", f"{fixed}[[robot.link]]", 1))
    assert recipe.parameters[0] == Parameter("lift", -10.0, 1.5, "rad", "rad", "0: level")
    assert recipe.links[0] == Link("cap", "body")
    assert recipe.links[2].joint.offset == 5.0
    assert recipe.grid.axes[0].knots.tolist() == [-10.0, 1.0, 1.5]
    assert recipe.wheels[0] == Wheel("a", (0.0, 1.0, 0.0), 0.1, True)
    assert recipe.channels == ("sdg", "tip_angle")
    assert recipe.export == ExportDefaults("16384", "0.01")
    assert repr(recipe) == "<Recipe '$1 crab': 3 contacts, lift, <recipe>>"


def test_keys_for_figures_change_no_number():
    drawn = parse_recipe(EVERYTHING)
    keys = r"^(title|meaning|shape(_at)?|width|belt) = .*\n"
    plain = parse_recipe(re.sub(keys, "", EVERYTHING, flags=re.MULTILINE))
    assert (plain.title, plain.contacts[0].width, plain.contacts[0].belt) == (None, 0.0, "")
    one, other = (
        lutgen.evaluate(recipe, [[0.1]], [[0.1, 0.2, -1.0]])["tip_angle"]
        for recipe in (plain, drawn)
    )
    assert one == other != 0.0


def test_recipes_are_equal_and_hashable_by_content_and_a_file_names_its_messages(tmp_path):
    path = tmp_path / "everything.toml"
    path.write_text(EVERYTHING, encoding="utf-8-sig")
    one, same, read = parse_recipe(EVERYTHING), parse_recipe(EVERYTHING), load_recipe(path)
    assert one == same
    assert hash(one) == hash(same)
    assert read.source == str(path)
    # A byte order mark belongs to the file, not to the recipe.
    assert one.digest == read.digest == hashlib.sha256(EVERYTHING.encode()).hexdigest()
    other = parse_recipe(EVERYTHING.replace("mass = 5.0", "mass = 5.5"))
    assert other != one
    assert other.digest != one.digest


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("latin.toml", r"line 2 is not UTF-8 \(got byte 0xe9\); save the file as UTF-8\."),
        ("map.h5", r"is no text \(got HDF5, as maps are\); the recipe inside a map is"),
    ],
)
def test_what_is_no_text_of_a_recipe_is_refused(tmp_path, name, said):
    (tmp_path / "latin.toml").write_bytes(b'[robot]\nname = "h\xe9"\n')
    (tmp_path / "map.h5").write_bytes(HDF5 + b"x")
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
def late(q): return feet(q) if len(q) == 1 and q[0, 0] < 9.0 else (np.zeros((2, 3, 3)), q)
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
    assert forward(recipe, [[2.0]]).centres[0, 0].tolist() == [2.0, 0.0, -1.5]
    late = coded("coded_robot:late")
    assert forward(late, [[3.0]]).com.tolist() == [[0.0, 0.0, 0.5]]
    with pytest.raises(InputError, match=r"must return contacts \(8, 3, 3\)"):
        forward(late, np.zeros((8, 1)))


@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("coded_robot:flat", r"must return contacts \(1, n, 3\) and com \(1, 3\) \(got \[\(1, 3\)"),
        ("coded_robot:pair", r"must return 3 to 62 contacts \(got 2\)"),
        ("coded_robot:lone", r"must return contacts and com \(got 'ndarray'\)"),
        ("coded_robot:lost", r"must return finite numbers"),
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

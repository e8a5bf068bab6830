"""Forward kinematics against hand-worked places and an independent matrix oracle."""

import math
import os
import subprocess
import sys

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lutgen.errors import InputError
from lutgen.recipe.kinematics import forward, postures, radii_and_kinds
from lutgen.recipe.recipe import load_recipe, parse_recipe
from tests.fixtures.places import MAPS

SWEEP = """
[sweep.gravity]
chart = "cone"
max_tilt = 30.0
nodes = 3
channels = ["sdg"]
"""

# A leg to the front: shoulder at (1, 0, 2), turned 90 deg to the left, then a hip about y,
# then a telescope along x whose foot is 3 beyond it.  The leg weighs 1, the body 3.
LEG = """
[robot]
name = "leg"
length_unit = "m"
[[robot.parameter]]
name = "reach"
min = 0.0
max = 1.0
unit = "m"
[[robot.parameter]]
name = "hip"
min = -90.0
max = 90.0
unit = "deg"
[[robot.link]]
name = "shin"
parent = "thigh"
joint = { type = "prismatic", axis = [1, 0, 0], parameter = "reach", scale = 2.0, offset = 0.5 }
[[robot.link]]
name = "thigh"
parent = "body"
origin = [1, 0, 2]
rpy = [0, 0, 90]
joint = { type = "revolute", axis = [0, 1, 0], parameter = "hip" }
mass = 1.0
com = [4, 0, 0]
[[robot.link]]
name = "body"
mass = 3.0
com = [0, 0, 1]
[[robot.contact]]
name = "foot"
link = "shin"
position = [3, 0, 0]
[[robot.contact]]
name = "wheel"
link = "thigh"
position = [0, 0, 0]
radius = 0.5
axis = [1, 0, 0]
[[robot.contact]]
name = "ball"
link = "body"
position = [-1, 0, 0]
radius = 0.25
[sweep]
samples = { reach = 2, hip = 2 }
"""


def leg():
    return parse_recipe(LEG + SWEEP, "leg.toml")


def test_a_leg_ends_where_it_does_on_paper():
    # Row 0: straight; the foot is 3 + 0.5 along +y of the shoulder.
    # Row 1: hip 90 deg about the leg's y, so that the leg points down; reach 1 adds 2.
    result = forward(leg(), [[0.0, 0.0], [1.0, math.pi / 2]])
    com = np.array([[0.25, 1.0, 1.25], [0.25, 0.0, 0.25]])
    feet = np.array([[1.0, 3.5, 2.0], [1.0, 0.0, 2.0 - 5.5]])
    # Sines and cosines of right angles are off by 6e-17, times lengths of at most 6.
    close = {"rtol": 0, "atol": 2e-15}
    np.testing.assert_allclose(result.com, com, **close)
    np.testing.assert_allclose(result.centres[:, 0] + com, feet, **close)
    np.testing.assert_allclose(result.centres[:, 1] + com, [[1, 0, 2], [1, 0, 2]], **close)
    np.testing.assert_allclose(result.centres[:, 2] + com, [[-1, 0, 0], [-1, 0, 0]], **close)
    np.testing.assert_allclose(result.axes[:, 1], [[0, 1, 0], [0, 0, -1]], **close)


def test_only_discs_have_an_axis():
    result = forward(leg(), [[0.3, 0.4]])
    assert not result.axes[0, [0, 2]].any()
    # One rotation of a unit vector.
    assert np.linalg.norm(result.axes[0, 1]) == pytest.approx(1.0, abs=1e-15)
    radius, kind = radii_and_kinds(leg())
    assert (radius.tolist(), kind.tolist()) == ([0.0, 0.5, 0.25], [0, 2, 1])
    assert (radius.dtype, kind.dtype) == (np.float64, np.int64)


def test_values_outside_the_limits_are_computed_and_not_clamped():
    inside, outside = forward(leg(), [[1.0, 0.0], [7.0, 0.0]]).centres[:, 0]
    # The foot moves 2 (scale) for each unit of reach, and so not at all if it were clamped.
    np.testing.assert_allclose(outside - inside, [0.0, 12.0, 0.0], rtol=0, atol=1e-14)


def test_postures_are_the_centres_and_the_com_of_forward():
    params = [[0.1, 0.2], [0.3, -0.4]]
    contacts, com = postures(leg(), params)
    result = forward(leg(), params)
    np.testing.assert_array_equal(contacts, result.centres)
    np.testing.assert_array_equal(com, result.com)


def test_no_postures_in_gives_no_postures_out():
    assert forward(leg(), np.empty((0, 2))).centres.shape == (0, 3, 3)


def random_tree(seed):
    """Return the text of a robot with a random tree of 7 links, and its tables."""
    rng = np.random.default_rng(seed)

    def vector():
        return rng.uniform(-1.0, 1.0, 3).round(6).tolist()

    links, contacts = [], []
    for i in range(7):
        kind = ("revolute", "prismatic", None)[i % 3]
        links.append(
            {
                "name": f"l{i}",
                "parent": "body" if i < 2 else f"l{rng.integers(i)}",
                "origin": vector(),
                "rpy": (180.0 * np.array(vector())).tolist(),
                "joint": kind,
                "axis": vector(),
                "scale": float(rng.choice([-1.0, 0.5])),
                "offset": 0.25 * i,
                "mass": float(i),
                "com": vector(),
            }
        )
        contacts.append({"name": f"c{i}", "link": f"l{i}", "position": vector(), "axis": vector()})
    text = '[robot]\nname = "tree"\nlength_unit = "cm"\n'
    for name, unit in (("turn", "rad"), ("slide", "cm")):
        text += f'[[robot.parameter]]\nname = "{name}"\nmin = -3\nmax = 3\nunit = "{unit}"\n'
    # Children before parents: the order in the file must not matter.
    for link in reversed(links):
        text += "[[robot.link]]\n"
        for key in ("name", "parent", "origin", "rpy", "mass", "com"):
            value = link[key]
            text += f'{key} = "{value}"\n' if isinstance(value, str) else f"{key} = {value}\n"
        if link["joint"]:
            name = "turn" if link["joint"] == "revolute" else "slide"
            text += (
                f'joint = {{ type = "{link["joint"]}", axis = {link["axis"]}, '
                f'parameter = "{name}", scale = {link["scale"]}, offset = {link["offset"]} }}\n'
            )
    for contact in contacts:
        text += f'[[robot.contact]]\nname = "{contact["name"]}"\nlink = "{contact["link"]}"\n'
        text += f"position = {contact['position']}\nradius = 0.1\naxis = {contact['axis']}\n"
    return f"{text}[sweep]\nsamples = {{ turn = 2, slide = 2 }}\n{SWEEP}", links, contacts


def oracle(links, contacts, turn, slide):
    """Return (centres, axes, com) by products of 4 x 4 matrices, one link at a time."""

    def matrix(rotation, shift):
        result = np.eye(4)
        result[:3, :3] = rotation.as_matrix()
        result[:3, 3] = shift
        return result

    none = Rotation.identity()
    place = {"body": np.eye(4)}
    for link in links:
        roll, pitch, yaw = link["rpy"]
        # Lower-case "xyz": turns about fixed axes, x first, which is what URDF means.
        here = matrix(Rotation.from_euler("xyz", [roll, pitch, yaw], degrees=True), link["origin"])
        axis = np.array(link["axis"]) / np.linalg.norm(link["axis"])
        if link["joint"] == "revolute":
            angle = link["scale"] * turn + link["offset"]
            here = here @ matrix(Rotation.from_rotvec(axis * angle), np.zeros(3))
        elif link["joint"] == "prismatic":
            here = here @ matrix(none, axis * (link["scale"] * slide + link["offset"]))
        place[link["name"]] = place[link["parent"]] @ here
    mass = np.array([link["mass"] for link in links])
    coms = np.array([(place[link["name"]] @ [*link["com"], 1.0])[:3] for link in links])
    com = mass @ coms / mass.sum()
    centres = [(place[c["link"]] @ [*c["position"], 1.0])[:3] - com for c in contacts]
    axes = [place[c["link"]][:3, :3] @ c["axis"] / np.linalg.norm(c["axis"]) for c in contacts]
    return np.array(centres), np.array(axes), com


@pytest.mark.parametrize("seed", range(8))
def test_random_trees_agree_with_products_of_homogeneous_matrices(seed):
    text, links, contacts = random_tree(seed)
    recipe = parse_recipe(text)
    params = np.random.default_rng(100 + seed).uniform(-3.0, 3.0, (5, 2))
    result = forward(recipe, params)
    for row, (turn, slide) in enumerate(params):
        centres, axes, com = oracle(links, contacts, turn, slide)
        # At most 7 links of rotations in a row, places up to about 20.
        close = {"rtol": 0, "atol": 1e-13}
        np.testing.assert_allclose(result.centres[row], centres, **close)
        np.testing.assert_allclose(result.axes[row], axes, **close)
        np.testing.assert_allclose(result.com[row], com, **close)


def test_a_posture_has_the_same_bits_alone_and_among_others():
    recipe = parse_recipe(random_tree(0)[0])
    params = np.random.default_rng(3).uniform(-3.0, 3.0, (257, 2))
    together = forward(recipe, params)
    for row in (0, 1, 100, 256):
        alone = forward(recipe, params[row : row + 1])
        for one, all_of_them in zip(alone, together, strict=True):
            np.testing.assert_array_equal(one[0], all_of_them[row])


MIRROR = """
[robot]
name = "mirror"
length_unit = "m"
[[robot.parameter]]
name = "roll"
min = -90
max = 90
unit = "deg"
[[robot.link]]
name = "left"
parent = "body"
origin = [0, 1, 0]
joint = { type = "revolute", axis = [1, 0, 0], parameter = "roll", offset = 10 }
[[robot.link]]
name = "right"
parent = "body"
origin = [0, -1, 0]
joint = { type = "revolute", axis = [1, 0, 0], parameter = "roll", scale = -1, offset = -10 }
[[robot.contact]]
name = "left"
link = "left"
position = [0.5, 1, 0.25]
[[robot.contact]]
name = "right"
link = "right"
position = [0.5, -1, 0.25]
[[robot.contact]]
name = "tail"
link = "body"
position = [-1, 0, 0]
[sweep]
samples = { roll = 2 }
"""


def test_a_joint_of_scale_minus_one_moves_as_the_mirror_image():
    recipe = parse_recipe(MIRROR + SWEEP)
    centres, com = postures(recipe, np.linspace(-2.0, 2.0, 9)[:, None])
    np.testing.assert_array_equal(centres[:, 1], centres[:, 0] * [1.0, -1.0, 1.0])
    assert np.ptp(centres[:, 0, 2]) > 1.0
    assert not com.any()


@pytest.mark.parametrize(
    ("params", "shape"), [([0.0, 0.0], "(2,)"), ([[0.0]], "(1, 1)"), ([[0.0] * 3], "(1, 3)")]
)
def test_params_of_another_shape_are_refused_with_the_columns_wanted(params, shape):
    with pytest.raises(InputError) as caught:
        forward(leg(), params)
    assert str(caught.value) == (
        f"leg.toml: params must have shape (m, 2) (got {shape}); "
        "give one row per posture with the columns: reach, hip."
    )


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_a_parameter_that_is_not_finite_is_refused_with_its_name_and_row(bad):
    with pytest.raises(InputError, match=rf"parameter `hip` must be finite \(got {bad} in row 1\)"):
        forward(leg(), [[0.0, 0.0], [0.0, bad]])


def paper_vector(elevation, azimuth):
    """Return P(elevation) of the paper at the radius sqrt(20^2 + 12^2), angles in rad."""
    flat = math.cos(elevation)
    place = [flat * math.cos(azimuth), flat * math.sin(azimuth), -math.sin(elevation)]
    return math.hypot(20.0, 12.0) * np.array(place)


def test_the_paper_s_wheels_are_at_their_elevations_below_the_body():
    nominal = math.atan(0.6)
    alpha, gamma = 0.2, 0.7
    third = 2.0 * math.pi / 3.0
    wheels = [paper_vector(alpha, 0), paper_vector(gamma, third), paper_vector(nominal, 2 * third)]
    two, com = postures(load_recipe(MAPS / "paper_two.toml"), [[alpha, gamma]])
    # The recipe's constants have 17 digits; lengths up to 24.
    np.testing.assert_allclose(two[0], wheels, rtol=0, atol=1e-13)
    assert not com.any()
    one, _ = postures(load_recipe(MAPS / "paper_one.toml"), [[alpha]])
    wheels[1] = paper_vector(nominal, third)
    np.testing.assert_allclose(one[0], wheels, rtol=0, atol=1e-13)


def test_absolem_weighs_29_kg_and_has_its_published_com_with_the_flippers_up():
    recipe = load_recipe(MAPS / "absolem.toml")
    # Sum of decimal numbers.
    assert sum(link.mass for link in recipe.links) == pytest.approx(29.360, abs=1e-12)
    up = forward(recipe, [[math.pi / 2, math.pi / 2]])
    # The reference is printed to 0.1 mm.
    np.testing.assert_allclose(up.com, [[-0.0322, -0.0057, 0.0988]], rtol=0, atol=1e-4)


def test_absolem_flippers_point_outward_at_zero_and_rise_with_a_positive_angle():
    recipe = load_recipe(MAPS / "absolem.toml")
    tips = [i for i, name in enumerate(recipe.contact_names) if name.endswith("_tip")]
    names = [recipe.contact_names[i] for i in tips]
    side = np.array([1.0 if "left" in name else -1.0 for name in names])
    end = np.array([1.0 if "front" in name else -1.0 for name in names])
    result = forward(recipe, [[0.0, 0.0], [math.pi / 2, 0.0], [0.0, math.pi / 2]])
    places = (result.centres + result.com[:, None])[:, tips]
    level = np.stack([0.58 * end, 0.272 * side, np.full(4, 0.0195)], axis=1)
    # Lengths below 1, one rotation.
    np.testing.assert_allclose(places[0], level, rtol=0, atol=1e-15)
    for row, moved in ((1, end > 0), (2, end < 0)):
        raised = np.stack([0.25 * end, 0.272 * side, np.full(4, 0.3495)], axis=1)
        wanted = np.where(moved[:, None], raised, level)
        np.testing.assert_allclose(places[row], wanted, rtol=0, atol=1e-15)


def test_absolem_discs_keep_their_axes_across_the_robot():
    result = forward(load_recipe(MAPS / "absolem.toml"), [[0.7, -2.0]])
    # One or two rotations about y, and a yaw of half a turn.
    np.testing.assert_allclose(np.abs(result.axes[0]), [[0, 1, 0]] * 12, rtol=0, atol=1e-15)


def test_the_tripod_s_lean_moves_its_com_and_its_first_foot_sideways():
    recipe = load_recipe(MAPS / "three_leg_sphere.toml")
    straight, left = forward(recipe, [[0.8, 0.0], [0.8, 0.5]]).com
    # Straight: the three legs cancel; 0.4 of 3.2 kg swings by 0.125 cos(0.8) sin(0.5).
    assert straight[:2] == pytest.approx([0.0, 0.0], abs=1e-15)
    assert left[1] == pytest.approx(0.4 / 3.2 * 0.125 * math.cos(0.8) * math.sin(0.5), abs=1e-15)


def test_a_robot_given_by_code_is_shifted_to_its_com(tmp_path):
    (tmp_path / "stool.py").write_text(
        "import numpy as np\n"
        "def feet(q):\n"
        "    contacts = np.zeros((len(q), 3, 3))\n"
        "    contacts[:, 0, 0] = q[:, 0]\n"
        "    contacts[q[:, 0] > 8.0] = np.nan\n"
        "    return contacts[: 7], np.ones((len(q), 3))\n"
    )
    head = '[robot]\nname = "stool"\nlength_unit = "m"\npython = "stool:feet"\n'
    parameter = '[[robot.parameter]]\nname = "x"\nmin = 0\nmax = 2\nunit = "m"\n'
    text = f"{head}{parameter}[sweep]\nsamples = {{ x = 2 }}\n{SWEEP}"
    try:
        recipe = parse_recipe(text, str(tmp_path / "stool.toml"), allow_python=True)
    finally:
        sys.modules.pop("stool", None)
    result = forward(recipe, [[5.0], [6.0]])
    assert result.centres[:, 0].tolist() == [[4.0, -1.0, -1.0], [5.0, -1.0, -1.0]]
    assert result.com.tolist() == [[1.0] * 3] * 2
    assert not result.axes.any()
    with pytest.raises(InputError, match=r"`stool:feet` must return contacts \(8, 3, 3\)"):
        forward(recipe, np.zeros((8, 1)))
    with pytest.raises(InputError, match=r"`stool:feet` must return finite numbers"):
        forward(recipe, [[9.0]])


def test_plain_python_gives_the_same_postures_as_the_compiled_kernel():
    script = (
        "import sys, numpy as np\n"
        "from lutgen.recipe.recipe import load_recipe\n"
        "from lutgen.recipe.kinematics import forward\n"
        "result = forward(load_recipe(sys.argv[1]), [[0.3, -1.2]])\n"
        "print(*np.concatenate([part.ravel() for part in result]).tolist())\n"
    )
    path = MAPS / "absolem.toml"
    plain = subprocess.run(
        [sys.executable, "-c", script, str(path)],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        cwd=MAPS.parent,
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    compiled = np.concatenate([p.ravel() for p in forward(load_recipe(path), [[0.3, -1.2]])])
    # The compiler may fuse a product and a sum: the last place of numbers below 1.
    np.testing.assert_allclose([float(x) for x in plain.split()], compiled, rtol=0, atol=1e-15)

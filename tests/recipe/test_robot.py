"""Forward kinematics against hand-worked places and an independent matrix oracle."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lutgen.errors import InputError
from lutgen.recipe.kinematics import forward, postures, radii_and_kinds
from lutgen.recipe.recipe import load_recipe, parse_recipe
from proofs.toml import toml_text
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import sweep_part

# A leg to the front: shoulder at (1, 0, 2), turned 90 deg to the left, then a hip about y,
# then a telescope along x whose foot is 3 beyond it.  The leg weighs 1, the body 3.
LEG = """
[robot]
name = "leg"
length_unit = "m"
parameter = [
    { name = "reach", min = 0.0, max = 1.0, unit = "m" },
    { name = "hip", min = -90.0, max = 90.0, unit = "deg" },
]
contact = [
    { name = "foot", link = "shin", position = [3, 0, 0] },
    { name = "wheel", link = "thigh", position = [0, 0, 0], radius = 0.5, axis = [1, 0, 0] },
    { name = "ball", link = "body", position = [-1, 0, 0], radius = 0.25 },
]
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
"""


def leg():
    return parse_recipe(LEG + sweep_part("reach = 2, hip = 2"), "leg.toml")


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
    # Only discs have an axis.
    assert not result.axes[:, [0, 2]].any()
    radius, kind = radii_and_kinds(leg())
    assert (radius.tolist(), kind.tolist()) == ([0.0, 0.5, 0.25], [0, 2, 1])


def test_postures_are_those_of_forward_also_beyond_the_limits_and_of_none():
    params = [[0.1, 0.2], [1.0, 0.0], [7.0, 0.0]]
    contacts, com = postures(leg(), params)
    result = forward(leg(), params)
    assert np.array_equal(contacts, result.centres)
    assert np.array_equal(com, result.com)
    # The foot moves 2 (scale) for each unit of reach, and so not at all if it were clamped.
    assert contacts[2, 0] - contacts[1, 0] == pytest.approx([0.0, 12.0, 0.0], abs=1e-14)
    assert forward(leg(), np.empty((0, 2))).centres.shape == (0, 3, 3)


def random_tree(seed):
    """Return the text of a robot with a random tree of 7 links, and its tables."""
    rng = np.random.default_rng(seed)

    def vector(scale=1.0):
        return (scale * rng.uniform(-1.0, 1.0, 3)).round(6).tolist()

    links, contacts = [], []
    for i in range(7):
        parent = "body" if i < 2 else f"l{rng.integers(i)}"
        link = {"name": f"l{i}", "parent": parent, "origin": vector(), "rpy": vector(180.0)}
        link |= {"mass": float(i), "com": vector()}
        if i % 3 < 2:
            kind, name = (("revolute", "turn"), ("prismatic", "slide"))[i % 3]
            scale = float(rng.choice([-1.0, 0.5]))
            link["joint"] = {"type": kind, "axis": vector(), "parameter": name, "scale": scale}
            link["joint"]["offset"] = 0.25 * i
        links.append(link)
        place = {"position": vector(), "radius": 0.1, "axis": vector()}
        contacts.append({"name": f"c{i}", "link": f"l{i}", **place})
    names = (("turn", "rad"), ("slide", "cm"))
    parameters = [{"name": name, "min": -3, "max": 3, "unit": unit} for name, unit in names]
    # Children before parents: the order in the file must not matter.
    robot = {"name": "tree", "length_unit": "cm", "parameter": parameters, "link": links[::-1]}
    text = toml_text({"robot": robot | {"contact": contacts}})
    return f"{text}{sweep_part('turn = 2, slide = 2')}", links, contacts


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
        if joint := link.get("joint"):
            turns = joint["type"] == "revolute"
            value = joint["scale"] * (turn if turns else slide) + joint["offset"]
            along = np.array(joint["axis"]) * (value / np.linalg.norm(joint["axis"]))
            here @= (
                matrix(Rotation.from_rotvec(along), np.zeros(3)) if turns else matrix(none, along)
            )
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


@pytest.mark.parametrize(
    ("params", "said"),
    [
        ([0.0, 0.0], r"must have shape \(m, 2\) \(got \(2,\)\).* with the columns: reach, hip"),
        ([[0.0] * 3], r"must have shape \(m, 2\) \(got \(1, 3\)\)"),
        ([[0.0, 0.0], [0.0, math.nan]], r"`hip` must be finite \(got nan in row 1\)"),
        ([[-math.inf, 0.0]], r"`reach` must be finite \(got -inf in row 0\)"),
    ],
)
def test_params_that_are_no_postures_are_refused(params, said):
    with pytest.raises(InputError, match=rf"^leg\.toml: .*{said}"):
        forward(leg(), params)


def test_absolem_has_its_published_mass_and_com_and_flippers_that_rise():
    recipe = load_recipe(MAPS / "absolem.toml")
    # Sum of decimal numbers.
    assert sum(link.mass for link in recipe.links) == pytest.approx(29.360, abs=1e-12)
    up = forward(recipe, [[math.pi / 2, math.pi / 2]])
    # The reference is printed to 0.1 mm.
    np.testing.assert_allclose(up.com, [[-0.0322, -0.0057, 0.0988]], rtol=0, atol=1e-4)
    tips = [i for i, name in enumerate(recipe.contact_names) if name.endswith("_tip")]
    front = np.array(["front" in recipe.contact_names[i] for i in tips])
    result = forward(recipe, [[0.0, 0.0], [math.pi / 2, 0.0], [0.0, math.pi / 2]])
    heights = (result.centres + result.com[:, None])[:, tips, 2]
    # Lengths below 1, one rotation.
    assert heights[0] == pytest.approx(0.0195, abs=1e-15)
    assert heights[1] == pytest.approx(np.where(front, 0.3495, 0.0195), abs=1e-15)
    assert heights[2] == pytest.approx(np.where(front, 0.0195, 0.3495), abs=1e-15)

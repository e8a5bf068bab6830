"""Forward kinematics against an independent matrix oracle, and published places."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lutgen.errors import InputError
from lutgen.recipe import forward, load_recipe, parse_recipe, postures
from proofs.toml import toml_text
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import sweep_part, tripod


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
    # Also beyond the limits, where nothing is clamped.
    params = np.random.default_rng(100 + seed).uniform(-9.0, 9.0, (5, 2))
    result = forward(recipe, params)
    for one, other in zip(postures(recipe, params), (result.centres, result.com), strict=True):
        assert np.array_equal(one, other)
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
    assert forward(recipe, np.empty((0, 2))).centres.shape == (0, 7, 3)


@pytest.mark.parametrize(
    ("params", "said"),
    [
        ([0.0, 0.0], r"must have shape \(m, 2\) \(got \(2,\)\).* with the columns: reach, swing"),
        ([[0.0] * 3], r"must have shape \(m, 2\) \(got \(1, 3\)\)"),
        ([[0.0, 0.0], [0.0, math.nan]], r"`swing` must be finite \(got nan in row 1\)"),
        ([[-math.inf, 0.0]], r"`reach` must be finite \(got -inf in row 0\)"),
    ],
)
def test_params_that_are_no_postures_are_refused(params, said):
    with pytest.raises(InputError, match=rf"^legs\.toml: .*{said}"):
        forward(parse_recipe(tripod(), "legs.toml"), params)


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

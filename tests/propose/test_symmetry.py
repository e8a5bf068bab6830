"""Which joints are alike, and which sign makes one the mirror image of another."""

import re

import numpy as np

from lutgen.propose import Coupling, import_urdf
from lutgen.recipe.kinematics import forward
from lutgen.urdf.read import load_urdf, parse_urdf
from lutgen.urdf.srdf import load_srdf
from tests.fixtures.places import VECTORS

QUADRUPED = (VECTORS / "quadruped.urdf").read_text(encoding="utf-8")
STANDING = load_srdf(VECTORS / "quadruped.srdf", load_urdf(VECTORS / "quadruped.urdf")).postures[
    "standing"
]
LEGS = ("FL", "FR", "RL", "RR")


def axis(text, joint, turned):
    pattern = rf'(name="{joint}".*?axis xyz=")[^"]*'
    found, count = re.subn(pattern, rf"\g<1>{turned}", text, count=1, flags=re.DOTALL)
    assert count == 1
    return found


def proposed(robot, posture=None):
    """Return the signs of each proposed parameter, in the order of the legs."""
    found = import_urdf(robot, posture=posture or STANDING).couples
    return {name: list(joints.values()) for name, joints in found.items()}


def test_the_sign_comes_from_the_axis_and_not_from_the_name():
    # A hip turned about -x and a thigh about -y: as many builders have their right side.
    text = axis(axis(QUADRUPED, "FR_hip_joint", "-1 0 0"), "RL_thigh_joint", "0 -1 0")
    posture = STANDING | {"RL_thigh_joint": -0.7}
    text = re.sub(
        r'(name="RL_thigh_joint".*?)lower="-1" upper="3"',
        r'\1lower="-3" upper="1"',
        text,
        flags=re.DOTALL,
    )
    assert proposed(parse_urdf(text), posture) == {
        "hip": [1.0, 1.0, 1.0, -1.0],
        "thigh": [1.0, 1.0, -1.0, 1.0],
        "knee": [1.0, 1.0, 1.0, 1.0],
    }


def test_a_joint_about_another_axis_is_not_one_of_them():
    found = proposed(parse_urdf(axis(QUADRUPED, "RR_hip_joint", "0 0 1")))
    assert found["hip"] == [1.0, -1.0, 1.0]
    assert len(found) == 3


def test_numbered_legs_are_found_by_where_they_are():
    text = QUADRUPED
    for number, leg in enumerate(LEGS, 1):
        text = re.sub(rf"{leg}_(\w+)_joint", rf"j_\1_{number}", text)
    posture = {
        f"j_{name[3:-6]}_{LEGS.index(name[:2]) + 1}": value for name, value in STANDING.items()
    }
    assert proposed(parse_urdf(text), posture) == {
        "j_hip": [1.0, -1.0, 1.0, -1.0],
        "j_thigh": [1.0] * 4,
        "j_knee": [1.0] * 4,
    }


def test_joints_in_a_row_of_one_name_are_not_coupled():
    # Left and right are words of these names, but the second hangs from the first.
    text = QUADRUPED.replace("FR_knee_joint", "left_bend").replace("FR_thigh_joint", "right_bend")
    found = import_urdf(parse_urdf(text)).couples
    assert not any({"left_bend", "right_bend"} & set(joints) for joints in found.values())


def test_coupled_by_proposal_the_com_stays_in_the_middle_of_a_symmetric_robot():
    recipe = import_urdf(parse_urdf(QUADRUPED), posture=STANDING).recipe
    rng = np.random.default_rng(3)
    low, high = zip(*((p.minimum, p.maximum) for p in recipe.parameters), strict=True)
    found = forward(recipe, rng.uniform(low, high, (200, 3)))
    # 1e-12: the recipe is rounded to picometres.
    assert np.abs(found.com[:, 1]).max() < 1e-12
    # The feet are mirror images, left of right, and they do move.
    feet = found.centres + found.com[:, None]
    left, right = feet[:, [0, 2]], feet[:, [1, 3]]
    assert np.allclose(left, right * [1, -1, 1], rtol=0, atol=1e-12)
    assert np.ptp(left[:, 0, 1]) > 0.1
    # The same with every sign 1 would not be: a sway.
    sway = import_urdf(
        parse_urdf(QUADRUPED), posture=STANDING, coupling=Coupling(("hips=+*_hip_joint",))
    ).recipe
    assert abs(forward(sway, [[0.3]]).com[0, 1]) > 1e-3

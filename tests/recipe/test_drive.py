"""Recipes that name a description and drive several of its joints by one parameter."""

import math

import pytest

import lutgen
from lutgen.errors import RecipeError
from lutgen.recipe import forward
from tests.fixtures.places import VECTORS
from tests.fixtures.recipes import sweep_part

# Without the mimic of the right arm, which turns about -y.
LOOSE = (VECTORS / "rover.urdf").read_text(encoding="utf-8")
LOOSE = LOOSE.replace('<mimic joint="arms" multiplier="-1"/>', "")
TIPS = "".join(
    f'[[robot.contact]]\nname = "{side}"\nlink = "{side}_arm"\nposition = [0.2, 0, 0]\n'
    for side in ("left", "right")
)
TIPS += '[[robot.contact]]\nname = "tail"\nlink = "chassis"\nposition = [-0.3, 0, -0.1]\n'


def recipe_text(drive, low=-40.0, high=40.0, unit="deg"):
    """Return a recipe whose parameter `reach` has these further lines."""
    return (
        '[robot]\nname = "rover"\nlength_unit = "m"\nurdf = "rover.urdf"\n[[robot.parameter]]\n'
        f'name = "reach"\nmin = {low}\nmax = {high}\nunit = "{unit}"\n'
        f"{drive}\n{TIPS}{sweep_part('reach = 3')}"
    )


def test_each_joint_is_at_its_scale_times_the_parameter_plus_its_offset():
    drive = "drive = { arms = 1.0, right_arm_joint = { scale = -0.5, offset = 10.0 } }"
    recipe = lutgen.parse_recipe(recipe_text(drive), urdf=LOOSE)
    angle = math.radians(24.0)
    found = forward(recipe, [[angle]])
    left, right, _ = found.centres[0] + found.com[0]
    # By hand.  Left: 24 deg about y takes its tip down.  Right: -12 + 10 = -2 deg about -y, which
    # is 2 deg about y.
    out, down = 0.25 + 0.2 * math.cos(angle), -0.2 * math.sin(angle)
    assert left.tolist() == pytest.approx([out, 0.25, down], abs=1e-15)
    angle = math.radians(2.0)
    out, down = 0.25 + 0.2 * math.cos(angle), -0.2 * math.sin(angle)
    assert right.tolist() == pytest.approx([out, -0.25, down], abs=1e-15)
    # A slide is driven in m: the mast is 2 of 26 kg, and goes up by 0.4 m.
    drive = "drive = { lift = { scale = 2.0, offset = 0.1 } }"
    slide = lutgen.parse_recipe(recipe_text(drive, 0.0, 0.2, "m"), urdf=LOOSE)
    low, high = forward(slide, [[0.0], [0.2]]).com[:, 2]
    assert high - low == pytest.approx(0.4 * 2 / 26)


AGAIN = (
    '[[robot.parameter]]\nname = "a"\nmin = 0.0\nmax = 1.0\nunit = "deg"\n'
    "drive = { right_arm_joint = 1.0, arms = 1.0 }"
)
ROOM = "the limits of 'arms', 'right_arm_joint'"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (recipe_text("drive = { arm = 1.0 }"), "1].drive.arm`: is no moving joint of the descrip"),
        (
            recipe_text("drive = { lens_mount = 1.0 }"),
            "drive.lens_mount`: is no moving",
        ),
        (recipe_text("drive = { arms = 0 }"), "drive.arms`: must not be zero"),
        (recipe_text("drive = { arms = { scale = 0.0 } }"), "drive.arms.scale`: must not be zero"),
        (recipe_text('drive = { arms = "1" }'), "drive.arms`: must be a number"),
        (recipe_text("drive = { arms = { scale = 1, shift = 2 } }"), "use one of: scale, offset"),
        (recipe_text("drive = { }"), "drive`: needs 1 or more entries"),
        (recipe_text("drive = 1"), "drive`: must be a table"),
        (recipe_text('joint = "arms"\ndrive = { arms = 1.0 }'), "cannot be combined with `drive`"),
        (recipe_text("drive = { arms = 1.0, lift = 1.0 }"), "'reach' drives joints that turn and"),
        # The second joint bounds it: -2 p within -0.8 to 0.8.
        (recipe_text("drive = { arms = 1.0, right_arm_joint = -2.0 }"), "within -0.4 to 0.4 rad"),
        (recipe_text("drive = { arms = 1.0, right_arm_joint = -2.0 }"), ROOM),
        (
            recipe_text("drive = { arms = 1, right_arm_joint = { offset = 100 } }"),
            "leave 'reach' no range",
        ),
        (
            recipe_text(f"drive = {{ arms = 1.0 }}\n{AGAIN}").replace(
                "reach = 3", "reach = 3, a = 2"
            ),
            "parameter[2].drive.arms`: is the joint of another parameter already",
        ),
    ],
)
def test_a_drive_that_the_description_cannot_follow_is_refused(text, said):
    with pytest.raises(RecipeError, match=r"^r\.toml: .*\.$") as caught:
        lutgen.parse_recipe(text, "r.toml", urdf=LOOSE)
    assert said in str(caught.value)

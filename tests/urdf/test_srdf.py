"""Postures: read from SRDF, chosen by name, given by joint, and what stands in them."""

import math
from pathlib import Path
from xml.etree.ElementTree import fromstring

import pytest

import lutgen
from lutgen.errors import InputError, RecipeError
from lutgen.urdf.read import parse_urdf
from lutgen.urdf.srdf import joint_groups, joint_values, load_srdf, srdf_beside
from tests.fixtures.commands import data
from tests.fixtures.commands import stdout as good
from tests.fixtures.robots import collision, joint, link, robot

LEGS = ("lf", "rf", "lh", "rh")
KNEE = '<axis xyz="0 1 0"/><limit lower="-2.5" upper="-0.5"/>'
HIP = '<axis xyz="0 1 0"/><limit lower="-1.5" upper="1.5"/>'


def quadruped(thigh=0.3, shank=0.3):
    """Return a robot of four legs, each with a rotor at the hip and a head with a sensor."""
    parts = [link("base", 10.0, "0 0 0.02")]
    for i, leg in enumerate(LEGS):
        place = f"{0.25 if i < 2 else -0.25} {0.15 if i % 2 == 0 else -0.15} 0"
        rotor = collision('cylinder radius="0.03" length="0.02"', "0 0 -0.05")
        parts += [
            link(f"{leg}_thigh", 1.0, f"0 0 {-thigh / 2}", rotor),
            joint(f"{leg}_hip", "revolute", "base", f"{leg}_thigh", HIP, place),
            link(
                f"{leg}_foot", 0.2, "0 0 -0.1", collision('sphere radius="0.02"', f"0 0 {-shank}")
            ),
            joint(f"{leg}_knee", "revolute", f"{leg}_thigh", f"{leg}_foot", KNEE, f"0 0 {-thigh}"),
        ]
    parts += [
        link("lidar", 0.5, inside=collision('cylinder radius="0.05" length="0.1"')),
        joint("lidar_mount", "fixed", "base", "lidar", xyz="0.3 0 -0.02"),
    ]
    return robot(*parts, name="quadruped")


def state(name, hip, knee, more=""):
    values = "".join(
        f'<joint name="{leg}_hip" value="{hip}"/><joint name="{leg}_knee" value="{knee}"/>'
        for leg in LEGS
    )
    return f'<group_state name="{name}" group="all">{values}{more}</group_state>'


def srdf(*states):
    head = '<?xml version="1.0"?>\n<robot name="quadruped"><group name="all"/>'
    return f"{head}{''.join(states)}</robot>"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "dog.urdf").write_text(quadruped(), encoding="utf-8")
    free = '<joint name="root_joint" value="0 0 1 0 0 0 1"/>'
    text = srdf(state("sit", 1.2, -2.4), state("standing", 0.6, -1.2, free))
    (tmp_path / "dog.srdf").write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def imported(*more):
    return data("import", "dog.urdf", "-o", "dog.toml", "--force", *more)


def test_an_srdf_beside_the_description_says_how_the_robot_stands(folder):
    report = imported()
    assert report["posture"] == "standing of dog.srdf"
    recipe = lutgen.load_recipe("dog.toml")
    # 12 digits of a degree are 2e-14 rad.
    assert recipe.home == pytest.approx(
        {f"{leg}_{part}": value for leg in LEGS for part, value in (("hip", 0.6), ("knee", -1.2))},
        abs=1e-13,
    )
    assert recipe.home_params == tuple(recipe.home[p.name] for p in recipe.parameters)
    # Contacts are those near the ground, and the others are listed.
    assert report["contacts"] == [f"{leg}_foot" for leg in LEGS]
    away = ", ".join(f"{leg}_thigh" for leg in LEGS)
    assert f"spheres and cylinders away from the ground: {away}, lidar" in report["left_out"]
    # By hand, about the y axis: a thigh of 1 kg 0.15 m below the hip turned by 0.6, a shank of
    # 0.2 kg 0.1 m below the knee turned by -0.6.
    x = 4 * (-1.0 * 0.15 * math.sin(0.6) + 0.2 * (-0.3 * math.sin(0.6) + 0.1 * math.sin(0.6)))
    z = 10 * 0.02 - 4 * (0.15 * math.cos(0.6) + 0.2 * 0.4 * math.cos(0.6)) - 0.5 * 0.02
    total = 10 + 4 * 1.2 + 0.5
    # 1e-15: sums of a dozen products.
    assert report["com"] == pytest.approx([(x + 0.5 * 0.3) / total, 0.0, z / total], abs=1e-15)


def test_what_the_robot_would_lie_on_is_named(folder):
    keel = link("keel", inside=collision('box size="0.1 0.1 1.1"'))
    mount = joint("keel_mount", "fixed", "base", "keel")
    Path("dog.urdf").write_text(quadruped().replace("</robot>", f"{keel}{mount}</robot>"))
    lies = "shapes below all contacts, on which it lies in this posture: keel"
    # Feet reach 0.6 cos(0.6) + 0.02 = 0.515 m below the hips, the keel 0.55 m.
    assert lies in imported()["left_out"]
    # 0.6 cos(15 deg) + 0.02 = 0.600 m.
    straight = [f"-p{leg}_{part}" for leg in LEGS for part in ("hip=15", "knee=-30")]
    assert lies not in imported(*straight)["left_out"]


def test_where_the_com_is_not_above_what_is_near_the_ground_all_below_it_are_contacts(folder):
    # On its fore legs alone, the hind ones up: no ground is level in the frame of the root.
    up = [f"-p{leg}_{part}" for leg in LEGS[2:] for part in ("hip=80", "knee=-140")]
    assert {f"{leg}_foot" for leg in LEGS} <= set(imported(*up)["contacts"])


def test_a_name_and_values_choose_another_posture(folder):
    good("import", "dog.urdf", "-o", "sit.toml", "--posture", "sit")
    assert lutgen.load_recipe("sit.toml").home["lf_hip"] == pytest.approx(1.2, abs=1e-13)
    said = good("import", "dog.urdf", "-o", "own.toml", "-p", "lf_hip=10", "-p", "rf_hip=-5")
    assert "posture: lf_hip, rf_hip as given; else standing of dog.srdf" in said
    home = lutgen.load_recipe("own.toml").home
    found = [math.degrees(home[name]) for name in ("lf_hip", "rf_hip", "lh_hip")]
    assert found == pytest.approx([10.0, -5.0, math.degrees(0.6)])


def test_without_a_name_that_stands_the_joints_are_at_zero_and_the_reason_is_said(folder):
    Path("dog.srdf").write_text(srdf(state("folded", 1.0, -2.0)))
    said = good("import", "dog.urdf", "-o", "dog.toml", "--force")
    zero = "posture: joints at zero, or at their limit nearest to it"
    assert f"{zero} (dog.srdf names none to stand in: folded)" in said
    # Knees end at -0.5 rad.
    assert lutgen.load_recipe("dog.toml").home["lf_knee"] == pytest.approx(-0.5, abs=1e-13)
    Path("dog.srdf").unlink()
    assert f"{zero} (no SRDF file names one)" in good(
        "import", "dog.urdf", "-o", "dog.toml", "--force"
    )


def test_values_beyond_the_limits_stand_at_the_limit_and_are_listed(folder):
    Path("dog.srdf").write_text(srdf(state("stand", 0.6, -2.7)))
    beyond = "joint lf_knee: at its limit, beyond which the posture is"
    assert beyond in imported()["left_out"]
    assert lutgen.load_recipe("dog.toml").home["lf_knee"] == pytest.approx(-2.5, abs=1e-13)


@pytest.mark.parametrize(
    ("names", "chosen"),
    [
        (("home", "Standing", "stand"), "Standing"),
        (("folded", "half_sitting"), "half_sitting"),
        (("half-sitting", "t_pose"), "half-sitting"),
        (("low_stand", "lie"), "low_stand"),
        (("lie", "fly"), None),
        ((), None),
    ],
)
def test_the_likeliest_name_is_chosen(names, chosen, tmp_path):
    file = tmp_path / "a.srdf"
    file.write_text(srdf(*(state(name, 0.0, -1.0) for name in names)))
    assert load_srdf(file, parse_urdf(quadruped())).standing() == chosen


def test_one_posture_of_several_groups_has_the_joints_of_all(tmp_path):
    file = tmp_path / "a.srdf"
    file.write_text(
        srdf(
            '<group_state name="home" group="a"><joint name="lf_hip" value="0.1"/></group_state>',
            '<group_state name="home" group="b"><joint name="rf_hip" value="0.2"/>'
            '<joint name="nowhere" value="9"/><joint name="lh_hip" value="1 2"/></group_state>',
        )
    )
    found = load_srdf(file, parse_urdf(quadruped()))
    assert found.posture("home") == {"lf_hip": 0.1, "rf_hip": 0.2}
    with pytest.raises(InputError, match="use one of: home"):
        found.posture("away")


@pytest.mark.parametrize("place", ["", "srdf", "../srdf"])
def test_the_srdf_is_found_beside_the_description_and_in_the_folders_of_its_name(place, tmp_path):
    file = tmp_path / "robots" / "dog_v2.urdf"
    (file.parent / place).mkdir(parents=True, exist_ok=True)
    file.parent.mkdir(exist_ok=True)
    assert srdf_beside(file) is None
    (file.parent / place / "cat.srdf").touch()
    assert srdf_beside(file) is None
    for name in ("dog.srdf", "d.srdf"):
        (file.parent / place / name).touch()
    found = srdf_beside(file)
    assert found.name == "dog.srdf"


@pytest.mark.parametrize(
    "text",
    [
        *("", "<robot>", "<urdf/>", "<!DOCTYPE a><robot/>", "\0", "\xff"),
        *(srdf(state(" ", 0, 0)), srdf(state("a", math.nan, 0)), srdf(state("a", 1e300, 0))),
        srdf(state("a", 0, 0)).replace('value="0"', 'value="x"', 1),
        srdf(state("a", 0, 0)).replace('value="0"', "", 1),
    ],
)
def test_an_srdf_with_a_fault_is_refused_in_a_sentence(text, tmp_path):
    file = tmp_path / "a.srdf"
    file.write_text(text, encoding="latin-1")
    with pytest.raises(RecipeError, match=rf"\A{file}: .*\.\Z"):
        load_srdf(file, parse_urdf(quadruped()))


def test_a_joint_that_follows_another_is_not_given_by_hand():
    mimic = '<axis xyz="0 0 1"/><mimic joint="a"/>'
    described = parse_urdf(
        robot(*STAR).replace(BARE, joint("b", "continuous", "base", "l_b", mimic))
    )
    assert joint_values(described, [("a", 720.0)]) == {"a": pytest.approx(4 * math.pi)}
    with pytest.raises(InputError, match="follows 'a'"):
        joint_values(described, [("b", 1.0)])


BARE = joint("b", "continuous", "base", "l_b")
STAR = (
    *(link(name) for name in ("base", "l_a", "l_b", "l_slide", "l_weld")),
    joint("a", "continuous", "base", "l_a"),
    BARE,
    joint("slide", "prismatic", "base", "l_slide"),
    joint("weld", "fixed", "base", "l_weld"),
)


def test_groups_in_a_circle_unknown_parts_and_broken_chains_add_nothing():
    root = fromstring(
        '<robot><group name="x"><group name="y"/><link name="l_a"/><group name="none"/></group>'
        '<group name="y"><group name="x"/><joint name="b"/><joint name="none"/>'
        '<joint name="weld"/><chain base_link="l_a" tip_link="l_slide"/></group>'
        '<group name=" "><joint name="a"/></group><group name="empty"/></robot>'
    )
    assert joint_groups(root, parse_urdf(robot(*STAR))) == {
        "x": ("a", "b"),
        "y": ("a", "b"),
        "empty": (),
    }

"""Whole descriptions on meshes: which links stand, on what, and what the recipe then says."""

import json
import math
from pathlib import Path

import pytest

from lutgen.errors import RecipeError
from lutgen.propose import import_urdf
from lutgen.urdf.meshes import Meshes
from lutgen.urdf.read import load_urdf
from lutgen.urdf.sources import Sources
from tests.fixtures.commands import stdout as good
from tests.fixtures.meshes import box, capsule, cylinder, write, written
from tests.fixtures.robots import collision, joint, link, robot

WHEELS = {"fl": (0.3, 0.2), "fr": (0.3, -0.2), "rl": (-0.3, 0.2), "rr": (-0.3, -0.2)}
AXLE = '<axis xyz="0 1 0"/>'
HULL = written("hull.stl", "0 0 0.1")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    for suffix in (".stl", ".obj", ".dae"):
        write(tmp_path / f"wheel{suffix}", cylinder(0.1, 0.05, 24))
    write(tmp_path / "hull.stl", box(0.6, 0.3, 0.1))
    write(tmp_path / "sole.stl", box(0.2, 0.1, 0.02))
    write(tmp_path / "leg.stl", capsule(0.02, 0.3))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def car(shape, kind="continuous"):
    parts = [link("base", 10.0, "0 0 0.1", HULL)]
    for name, (x, y) in WHEELS.items():
        parts += [
            link(name, 1.0, inside=shape),
            joint(f"{name}_axle", kind, "base", name, AXLE, f"{x} {y} 0"),
        ]
    return robot(*parts, name="car")


def imported(text, contacts=None):
    Path("a.urdf").write_text(text, encoding="utf-8")
    made = import_urdf(load_urdf("a.urdf"), contacts, meshes=Meshes(Sources(Path())))
    return made.recipe, made


def test_wheels_that_are_meshes_give_the_recipe_of_wheels_that_are_cylinders(folder):
    recipe, made = imported(car(written("wheel.stl")))
    turned = f"{0.5 * math.pi!r} 0 0"
    wanted, _ = imported(car(collision('cylinder radius="0.1" length="0.05"', "0 0 0", turned)))
    # The outer rims of four wheels, whichever of the two is called the first.
    assert len(recipe.contacts) == len(wanted.contacts) == 4
    places = [
        sorted((c.link, *c.position, c.radius) for c in one.contacts) for one in (recipe, wanted)
    ]
    for (a, *mine), (b, *theirs) in zip(*places, strict=True):
        assert a == b
        assert mine == pytest.approx(theirs, abs=1e-6)
    # 100 mm (1 - cos(180 / 24 deg)) = 0.86 mm.
    assert made.guessed == (
        "fl, fr, rl, rr: a wheel of radius 100.00 mm and width 50.00 mm, off by at most 0.86 mm up "
        "to 30 deg of lean",
    )
    # Three formats, and the first once more, give the same text.
    for suffix in (".obj", ".dae", ".stl"):
        assert imported(car(written(f"wheel{suffix}")))[1].text == made.text


def test_the_recipe_has_the_guess_as_numbers_with_its_sentence(folder):
    Path("car.urdf").write_text(car(written("wheel.stl")), encoding="utf-8")
    said = good("import", "car.urdf", "-o", "car.toml")
    note = "a wheel of radius 100.00 mm and width 50.00 mm, off by at most 0.86 mm"
    assert f"guessed:\n  fl, fr, rl, rr: {note}" in said
    text = Path("car.toml").read_text(encoding="utf-8")
    assert text.count(f'# Guessed from the mesh of "fl": {note}') == 1
    assert text.count("radius = 0.1\n") == 4
    # Left and right 0.225 m from the com at a height of 0.1 + (1 + 0) * 10 / 14 * 0.1.
    table = json.loads(good("limits", "car.toml", "--json"))
    height = 0.1 + 0.1 * 10 / 14
    left = {row["name"]: row["tilt_deg"] for row in table["limits"]}["left side down"]
    assert left == pytest.approx(math.degrees(math.atan(0.225 / height)), abs=0.01)


def test_wheels_on_fixed_joints_are_discs_and_looks_serve_where_there_is_nothing_else(folder):
    recipe, made = imported(car(written("wheel.stl"), "fixed"))
    assert {contact.kind for contact in recipe.contacts} == {"disc"}
    assert made.guessed[0].startswith("fl, fr, rl, rr: a disc of radius 100.00 mm")
    look = written("wheel.stl").replace("collision", "visual")
    recipe, made = imported(car(look))
    assert {contact.link for contact in recipe.contacts} == set(WHEELS)
    assert made.guessed[0].endswith("a visual mesh, as there is no collision shape")
    # Beside a sphere that it stands on they do not.
    recipe, made = imported(car(collision('sphere radius="0.1"') + look))
    assert {contact.kind for contact in recipe.contacts} == {"sphere"}
    assert made.guessed == ()


def walker(foot):
    """Return a robot on two legs of 0.4 m with feet, and a sensor on a shank."""
    parts = [link("base", 5.0, inside=written("hull.stl", "0 0 0.3"))]
    for side, y in (("left", 0.1), ("right", -0.1)):
        limit = '<axis xyz="0 1 0"/><limit lower="-1" upper="1"/>'
        parts += [
            link(f"{side}_shank", 1.0, inside=written("leg.stl", "0 0 -0.2")),
            joint(f"{side}_hip", "revolute", "base", f"{side}_shank", limit, f"0 {y} 0"),
            link(f"{side}_foot", 0.5, inside=foot),
            joint(f"{side}_ankle", "revolute", f"{side}_shank", f"{side}_foot", limit, "0 0 -0.4"),
        ]
    return robot(*parts, name="walker")


def test_two_soles_are_eight_corners_and_the_shanks_are_none(folder):
    recipe, made = imported(walker(written("sole.stl", "0.03 0 0")))
    assert [c.link for c in recipe.contacts] == ["left_foot"] * 4 + ["right_foot"] * 4
    assert sorted(c.position for c in recipe.contacts[:4]) == [
        (x, y, -0.01) for x in (-0.07, 0.13) for y in (-0.05, 0.05)
    ]
    assert "the corners of a flat sole" in made.guessed[0]
    # In figures the body is the box about its mesh, wherever its centre of mass is.
    base = next(link for link in recipe.links if link.mass == 5.0)
    assert (*base.shape, *base.shape_at) == pytest.approx((0.6, 0.3, 0.1, 0.0, 0.0, 0.3))


def test_a_ball_beside_a_mesh_is_what_the_wheel_stands_on(folder):
    recipe, made = imported(car(collision('sphere radius="0.099"') + written("wheel.stl")))
    assert {c.radius for c in recipe.contacts} == {0.099}
    assert made.guessed == ()
    # A ball that the mesh reaches well beyond counts beside it.
    recipe, made = imported(car(collision('sphere radius="0.09"') + written("wheel.stl")))
    assert {c.radius for c in recipe.contacts} == {0.09, 0.1}


def test_what_is_named_is_opened_wherever_it_is(folder):
    names = [*WHEELS, "base"]
    recipe, _ = imported(car(written("wheel.stl")), contacts=names)
    hull = [contact for contact in recipe.contacts if contact.link == "body"]
    assert sorted(c.position for c in hull) == [
        (x, y, 0.05) for x in (-0.3, 0.3) for y in (-0.15, 0.15)
    ]


@pytest.mark.parametrize(
    ("name", "said"), [("none.stl", "there is no such file"), ("broken.stl", "has no triangle")]
)
def test_a_mesh_that_is_not_needed_is_named_and_refuses_nothing(name, said, folder):
    (folder / "broken.stl").write_bytes(b"\0" * 84)
    cylinders = collision('cylinder radius="0.1" length="0.05"', rpy=f"{0.5 * math.pi!r} 0 0")
    recipe, made = imported(car(cylinders).replace("hull.stl", name))
    assert len(recipe.contacts) == 4
    assert made.left_out[-1] == f"meshes that were not opened: base: {name}: {said}"
    with pytest.raises(RecipeError, match=rf"fl, fr, rl, rr: {name}: {said}"):
        imported(car(written(name)))


def arm(base, length):
    """Return an arm of 3 kg on a root of 1 kg, which hangs out to one side."""
    limit = '<axis xyz="0 0 1"/><limit lower="-3" upper="3"/>'
    return robot(
        link("base", 1.0, inside=base),
        link("arm", 3.0, f"{length} 0 0.3", written("leg.stl", f"{length} 0 0.4")),
        joint("turn", "revolute", "base", "arm", limit),
        name="arm",
    )


def test_an_arm_that_is_bolted_down_is_refused_with_the_reason(folder):
    with pytest.raises(RecipeError) as caught:
        imported(arm(written("sole.stl"), 0.5))
    assert (
        "nothing stands on the ground: the centre of mass is not above what is lowest in this "
        "posture (got base), as of an arm or a hand that is bolted down"
    ) in str(caught.value)
    # On a pedestal that is wide enough it stands, and so it does where somebody says so.
    write(folder / "sole.stl", box(1.0, 1.0, 0.02))
    assert len(imported(arm(written("sole.stl"), 0.5))[0].contacts) == 4
    write(folder / "sole.stl", box(0.2, 0.1, 0.02))
    assert len(imported(arm(written("sole.stl"), 0.5), contacts=["base"])[0].contacts) == 4

"""Recipes that name a robot description: what they mean, which files they may name, and maps."""

import math
import os
import shutil
import time
from pathlib import Path

import h5py
import numpy as np
import pytest

import lutgen
from lutgen.errors import MapFileError, RecipeError
from lutgen.propose.proposal import import_urdf
from lutgen.recipe import forward, recipe_digest
from lutgen.urdf.read import parse_urdf
from tests.fixtures.commands import data
from tests.fixtures.places import VECTORS
from tests.fixtures.recipes import contact, sweep_part

VECTOR = VECTORS / "rover.urdf"
ROVER = VECTOR.read_text(encoding="utf-8")
ARMS = '[[robot.parameter]]\nname = "arms"\nmin = -45.0\nmax = 45.0\nunit = "deg"\n'
LIFT = '[[robot.parameter]]\nname = "mast"\njoint = "lift"\nmin = 0.1\nmax = 0.5\nunit = "m"\n'


def on(link, name=""):
    """Return a contact that is derived from its link."""
    return f'[[robot.contact]]\nlink = "{link}"\n' + (f'name = "{name}"\n' if name else "")


WHEELS = on("left_arm") + on("right_arm") + on("left_wheel", "rear") + on("right_wheel")
SWEEP = sweep_part("arms = 3, mast = 2", nodes=5)
ARMS_ONLY = sweep_part("arms = 3")


def recipe_text(
    urdf="rover.urdf",
    parameters=ARMS + LIFT,
    contacts=WHEELS,
    head='length_unit = "m"',
    sweep=SWEEP,
):
    robot = f'[robot]\nname = "rover"\n{head}\nurdf = {urdf!r}\n'
    return robot + parameters + contacts + sweep


@pytest.fixture
def path(tmp_path):
    shutil.copy(VECTOR, tmp_path / "rover.urdf")
    file = tmp_path / "rover.toml"
    file.write_text(recipe_text(), encoding="utf-8")
    return file


def refusal(text, urdf=ROVER):
    with pytest.raises(RecipeError) as caught:
        lutgen.parse_recipe(text, "r.toml", urdf=urdf)
    said = str(caught.value)
    assert all(line.startswith("r.toml: ") and line.endswith(".") for line in said.split("\n"))
    return said


def test_links_masses_and_contacts_come_from_the_description(path):
    recipe = lutgen.load_recipe(path)
    assert recipe.contact_names == (
        *("left_arm_1", "left_arm_2", "right_arm_1", "right_arm_2"),
        *("rear_1", "rear_2", "right_wheel_1", "right_wheel_2"),
    )
    angle, lift = 0.3, 0.2
    found = forward(recipe, [[angle, lift]])
    # By hand: 26 kg; arms of 1 kg 0.1 m out, turned down by 0.3 rad at x = 0.25; wheels at -0.25;
    # 2 kg at 0.2 + lift + 0.3 m.
    x = (2 * (0.25 + 0.1 * math.cos(angle)) - 2 * 0.25) / 26
    z = (20 * 0.1 - 2 * 0.1 * math.sin(angle) + 2 * (0.5 + lift)) / 26
    assert found.com[0].tolist() == pytest.approx([x, 0.0, z], abs=1e-15)
    places = found.centres[0] + found.com[0]
    out, down = 0.25 + 0.2 * math.cos(angle), -0.2 * math.sin(angle)
    want = [[out, 0.23, down], [out, 0.27, down], [out, -0.27, down], [out, -0.23, down]]
    want += [[-0.25, y, 0.0] for y in (0.23, 0.27, -0.27, -0.23)]
    assert np.allclose(places, want, rtol=0, atol=1e-15)


def test_an_imported_recipe_and_one_that_names_the_description_are_the_same_robot():
    imported = import_urdf(parse_urdf(ROVER), joints=("arms", "lift")).recipe
    named = lutgen.parse_recipe(recipe_text(), urdf=ROVER)
    rng = np.random.default_rng(1)
    params = rng.uniform([-0.7, 0.1], [0.7, 0.5], (50, 2))
    ours, theirs = forward(imported, params), forward(named, params)
    # 1e-12: the imported one is rounded to a picometre.
    assert np.allclose(ours.com, theirs.com, rtol=0, atol=1e-12)
    column = [
        named.contact_names.index(name.replace("left_wheel", "rear"))
        for name in imported.contact_names
    ]
    assert np.allclose(ours.centres, theirs.centres[:, column], rtol=0, atol=2e-12)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            {"head": 'length_unit = "mm"', "parameters": ARMS, "sweep": ARMS_ONLY},
            "description is m",
        ),
        ({"head": 'length_unit = "m"\npython = "a:b"'}, "cannot be combined"),
        ({"contacts": '[[robot.link]]\nname = "x"\n' + WHEELS}, "cannot be combined"),
        ({"parameters": ARMS.replace('"arms"', '"arm"') + LIFT}, "did you mean"),
        ({"parameters": ARMS + LIFT.replace('"lift"', '"arms"')}, "of another parameter already"),
        ({"parameters": ARMS + LIFT.replace('"lift"', '"lens_mount"')}, "is no moving joint"),
        ({"parameters": ARMS + LIFT.replace('"lift"', '"right_arm_joint"')}, "follows 'arms'"),
        ({"parameters": ARMS.replace("45.0", "46.0") + LIFT}, "must lie within -0.8 to 0.8 rad"),
        ({"parameters": ARMS + LIFT.replace('"m"', '"deg"')}, "must be a length"),
        ({"contacts": WHEELS + on("left_wheell")}, "did you mean 'left_wheel'"),
        ({"contacts": WHEELS + on("body")}, "`robot.contact[5].link`: is not a link of the robot"),
        ({"contacts": WHEELS + on("mast")}, "has no collision sphere, cylinder or box"),
        ({"contacts": WHEELS + on("left_arm")}, "is given twice"),
        (
            {"contacts": WHEELS + on("chassis") + "radius = 0.1\n"},
            "means nothing without a position",
        ),
        ({"contacts": on("left_arm")}, "needs 3 to 62 contacts"),
        ({"contacts": on("chassis") * 5}, "is given twice"),
        ({"urdf": ""}, "must not be empty"),
    ],
)
def test_what_does_not_fit_the_description_is_refused(change, said):
    assert said in refusal(recipe_text(**change))


def test_a_fault_in_the_description_names_both_files_and_without_one_no_key_names_a_joint():
    assert refusal(recipe_text(), "<robot/>").startswith("r.toml: rover.urdf: <robot>: needs 1")
    text = '[robot]\nname = "a"\nlength_unit = "m"\n' + LIFT + sweep_part("mast = 2")
    assert "means nothing without `robot.urdf`" in refusal(text, None)


@pytest.mark.parametrize(
    "name",
    [
        *("/etc/hostname", "../rover.urdf", "folder/../../rover.urdf", "..", ".", "folder"),
        *("out.urdf", "out/rover.urdf", "loop.urdf", "pipe", "nothing.urdf", "..\\rover.urdf"),
        *("rover.urdf/x", "n" * 5000, "/dev/zero"),
    ],
)
def test_files_outside_the_recipes_folder_and_what_is_no_file_are_never_opened(
    name, tmp_path, monkeypatch
):
    folder = tmp_path / "inside"
    (folder / "folder").mkdir(parents=True)
    shutil.copy(VECTOR, tmp_path / "rover.urdf")
    shutil.copy(VECTOR, folder / "rover.urdf")
    (folder / "out.urdf").symlink_to(tmp_path / "rover.urdf")
    (folder / "out").symlink_to(tmp_path)
    (folder / "loop.urdf").symlink_to(folder / "loop.urdf")
    os.mkfifo(folder / "pipe")
    opened = []
    before = Path.open

    def spy(self, *arguments, **options):
        opened.append(self)
        return before(self, *arguments, **options)

    text = recipe_text().replace("'rover.urdf'", f"'{name}'")
    monkeypatch.setattr(Path, "open", spy)
    with pytest.raises(RecipeError, match=r"robot\.urdf") as caught:
        lutgen.parse_recipe(text, str(folder / "r.toml"))
    assert opened == []
    assert "copy the file beside the recipe" in str(caught.value)


def test_a_file_in_a_folder_below_and_a_link_within_it_are_read(path):
    (path.parent / "models").mkdir()
    shutil.move(path.parent / "rover.urdf", path.parent / "models" / "real.urdf")
    (path.parent / "rover.urdf").symlink_to("models/real.urdf")
    digest = lutgen.load_recipe(path).digest
    path.write_text(recipe_text("models/real.urdf"), encoding="utf-8")
    assert lutgen.load_recipe(path).digest != digest


def test_a_map_reads_back_alone_when_the_description_is_gone(path):
    recipe = lutgen.load_recipe(path)
    file = path.with_suffix(".h5")
    lutgen.sweep(recipe, file)
    (path.parent / "rover.urdf").unlink()
    path.unlink()
    found = lutgen.load_map(file)
    assert found.recipe.digest == recipe.digest
    assert found.attributes["urdf"] == ROVER
    # The recipe inside still computes postures.
    want = lutgen.evaluate(recipe, [[0.1, 0.2]], [[0, 0, -1]])
    got = lutgen.evaluate(found.recipe, [[0.1, 0.2]], [[0, 0, -1]])
    assert got["tip_angle"] == want["tip_angle"]
    assert found.channel("tip_angle").shape == (3, 2, 1, 5, 5)


HEAVIER = ROVER.replace('value="20"', 'value="21"')
PLAIN_DIGEST = recipe_digest(recipe_text())


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"urdf": None}, "does not match its digest"),
        ({"urdf": HEAVIER}, "does not match its digest"),
        # No file is opened even where the digest fits.
        ({"urdf": None, "recipe_sha256": PLAIN_DIGEST}, "not stored beside the recipe"),
    ],
)
def test_a_map_whose_description_is_missing_or_changed_is_refused(path, changes, said):
    file = path.with_suffix(".h5")
    lutgen.sweep(lutgen.load_recipe(path), file)
    content = file.read_bytes()
    file.write_bytes(content.replace(b"lutgen-digest-3", b"another-digest-"))
    with h5py.File(file, "r+") as data:
        for key, value in changes.items():
            del data.attrs[key]
            if value is not None:
                data.attrs[key] = value
    with pytest.raises(MapFileError, match=said):
        lutgen.load_map(file, unsealed=True)


def test_ten_thousand_links_in_a_recipe_are_checked_in_seconds():
    links = "".join(
        f'[[robot.link]]\nname = "l{i}"\nparent = "{f"l{i - 1}" if i else "body"}"\n'
        for i in range(10_000)
    )
    points = "".join(contact(f"P{i}", (i, i * i, 0.0), link="l9999") for i in range(3))
    text = '[robot]\nname = "long"\nlength_unit = "m"\n' + links + points + sweep_part()
    begin = time.process_time()
    recipe = lutgen.parse_recipe(text)
    # Measured 0.6 s, most of it in the TOML reader; checks quadratic in the depth take minutes.
    assert time.process_time() - begin < 10.0
    assert len(recipe.links) == 10_001


def test_check_warns_of_what_looks_like_a_mistake_in_the_description(path, caplog):
    assert data("check", path)["warnings"] == []
    degrees = ROVER.replace('lower="-0.8" upper="0.8"', 'lower="-45" upper="45"')
    (path.parent / "rover.urdf").write_text(degrees, encoding="utf-8")
    (words,) = data("check", path)["warnings"]
    assert words.startswith("joint 'arms', 'right_arm_joint': limits are in rad")
    assert words in caplog.text


# Without the mimic of the right arm, which turns about -y.
LOOSE = ROVER.replace('<mimic joint="arms" multiplier="-1"/>', "")
TIPS = "".join(
    f'[[robot.contact]]\nname = "{side}"\nlink = "{side}_arm"\nposition = [0.2, 0, 0]\n'
    for side in ("left", "right")
)
TIPS += '[[robot.contact]]\nname = "tail"\nlink = "chassis"\nposition = [-0.3, 0, -0.1]\n'


def driving(drive, low=-40.0, high=40.0, unit="deg"):
    return (
        '[robot]\nname = "rover"\nlength_unit = "m"\nurdf = "rover.urdf"\n[[robot.parameter]]\n'
        f'name = "reach"\nmin = {low}\nmax = {high}\nunit = "{unit}"\n'
        f"{drive}\n{TIPS}{sweep_part('reach = 3')}"
    )


def test_each_joint_is_at_its_scale_times_the_parameter_plus_its_offset():
    drive = "drive = { arms = 1.0, right_arm_joint = { scale = -0.5, offset = 10.0 } }"
    recipe = lutgen.parse_recipe(driving(drive), urdf=LOOSE)
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
    slide = lutgen.parse_recipe(driving(drive, 0.0, 0.2, "m"), urdf=LOOSE)
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
        (driving("drive = { arm = 1.0 }"), "1].drive.arm`: is no moving joint of the descrip"),
        (
            driving("drive = { lens_mount = 1.0 }"),
            "drive.lens_mount`: is no moving",
        ),
        (driving("drive = { arms = 0 }"), "drive.arms`: must not be zero"),
        (driving("drive = { arms = { scale = 0.0 } }"), "drive.arms.scale`: must not be zero"),
        (driving('drive = { arms = "1" }'), "drive.arms`: must be a number"),
        (driving("drive = { arms = { scale = 1, shift = 2 } }"), "use one of: scale, offset"),
        (driving("drive = { }"), "drive`: needs 1 or more entries"),
        (driving("drive = 1"), "drive`: must be a table"),
        (driving('joint = "arms"\ndrive = { arms = 1.0 }'), "cannot be combined with `drive`"),
        (driving("drive = { arms = 1.0, lift = 1.0 }"), "'reach' drives joints that turn and"),
        # The second joint bounds it: -2 p within -0.8 to 0.8.
        (driving("drive = { arms = 1.0, right_arm_joint = -2.0 }"), "within -0.4 to 0.4 rad"),
        (driving("drive = { arms = 1.0, right_arm_joint = -2.0 }"), ROOM),
        (
            driving("drive = { arms = 1, right_arm_joint = { offset = 100 } }"),
            "leave 'reach' no range",
        ),
        (
            driving(f"drive = {{ arms = 1.0 }}\n{AGAIN}").replace("reach = 3", "reach = 3, a = 2"),
            "parameter[2].drive.arms`: is the joint of another parameter already",
        ),
    ],
)
def test_a_drive_that_the_description_cannot_follow_is_refused(text, said):
    assert said in refusal(text, LOOSE)

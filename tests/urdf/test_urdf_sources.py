"""Where packages are looked for, xacro files that include over them, and files with faults."""

import json
import re
import shutil

import pytest
from hypothesis import given

import lutgen
from lutgen.errors import LutgenError, RecipeError
from lutgen.propose import import_urdf
from lutgen.urdf.read import load_urdf
from lutgen.urdf.sources import Sources, load_xacro
from lutgen.urdf.srdf import load_srdf
from proofs.fuzzing.values import mutated
from tests.fixtures.commands import run
from tests.fixtures.commands import stdout as good
from tests.fixtures.places import VECTORS

SHARE = VECTORS / "xacro" / "share"
ROBOTS = VECTORS / "xacro" / "robots"
NAMES = ("wheels_common", "legs_description", "arm_description")
PACKAGES = {name: SHARE / name for name in NAMES}
GIVEN = [part for name in NAMES for part in ("--package", f"{name}={SHARE / name}")]
# Mass in kg and moving joints, by hand from the macros.
EXPECTED = {
    "crane": (10 + 4 + 4 + 0.5, 5),
    "choice": (10 + 4, 4),
    "quadruped": (10 + 4 * 1.3, 8),
    "sized": (6 + 4 * 1.3, 8),
    "named_apart": (10 + 2 + 0.3, 2),
    "meshes_apart": (10 + 4 + 2, 4),
    "everything": (10 + 2 + 1.3 + 4 + 0.5, 5),
}


@pytest.fixture(autouse=True)
def no_ros(monkeypatch):
    for name in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH", "ROS_ROOT"):
        monkeypatch.delenv(name, raising=False)


@pytest.mark.parametrize("name", EXPECTED)
def test_files_are_imported_with_their_packages_given(name, tmp_path):
    file, recipe = ROBOTS / f"{name}.xacro", tmp_path / "robot.toml"
    report = json.loads(good("import", "-x", file, "-o", recipe, *GIVEN, "--json"))
    mass, joints = EXPECTED[name]
    assert report["mass"] == pytest.approx(mass, rel=1e-12)
    robot = load_xacro(file, PACKAGES)
    assert sum(joint.kind != "fixed" for joint in robot.joints) == joints
    assert lutgen.load_recipe(recipe).name == name


def test_without_them_the_environment_or_the_folders_above_are_enough_or_a_sentence_names_one(
    tmp_path, monkeypatch
):
    file = ROBOTS / "everything.xacro"
    result = run("import", "-x", file, "-o", tmp_path / "robot.toml")
    assert result.exit_code == 2
    (said,) = result.stderr.splitlines()
    assert "package 'wheels_common' was not found" in said
    assert "--package wheels_common=FOLDER" in said
    # A workspace as it is checked out: the file in one package, the others beside that.
    shutil.copytree(SHARE, tmp_path / "src")
    above = tmp_path / "src" / "legs_description" / "robots" / "robot.xacro"
    above.parent.mkdir()
    shutil.copy(file, above)
    found = [load_xacro(above)]
    for name in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
        with monkeypatch.context() as patch:
            patch.setenv(name, f"/nowhere:{VECTORS / 'xacro'}")
            found.append(load_xacro(file))
    for robot in found:
        assert sum(link.mass for link in robot.links) == pytest.approx(17.8, rel=1e-12)


def test_arguments_choose_what_conditionals_leave(tmp_path):
    def links(name, **arguments):
        found = load_xacro(ROBOTS / f"{name}.xacro", PACKAGES, arguments)
        return {link.name for link in found.links}

    assert links("six_wheels") - links("six_wheels", wheels="4") == {"ml", "mr"}
    assert links("crane") - links("crane", tool="none") == {"hook"}
    assert {"front_foot", "left_foot"} <= links("choice", on="legs")
    said = good(
        *("import", "-x", ROBOTS / "choice.xacro", "-o", tmp_path / "robot.toml", *GIVEN),
        *("--arg", "on=legs"),
    )
    assert "front_foot" in said


def test_what_is_given_comes_before_what_is_found(tmp_path, monkeypatch):
    for place in ("given", "ros/a", "ament/share/a", "a"):
        (tmp_path / place).mkdir(parents=True)
        (tmp_path / place / "package.xml").write_text("<package><name>a</name></package>")
    start = tmp_path / "a" / "urdf"
    start.mkdir()
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "ament"))
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "ros"))
    assert Sources(start, {"a": tmp_path / "given"}).package("a") == tmp_path / "given"
    assert Sources(start).package("a") == tmp_path / "ros" / "a"
    monkeypatch.delenv("ROS_PACKAGE_PATH")
    assert Sources(start).package("a") == tmp_path / "ament" / "share" / "a"
    monkeypatch.delenv("AMENT_PREFIX_PATH")
    assert Sources(start).package("a") == tmp_path / "a"


def test_a_package_is_known_by_its_file_or_by_the_name_of_a_folder_above(tmp_path):
    (tmp_path / "checkout-of-a" / "urdf").mkdir(parents=True)
    xml = tmp_path / "checkout-of-a" / "package.xml"
    xml.write_text("<package><name> a </name></package>")
    assert Sources(xml.parent / "urdf").package("a") == xml.parent
    # Without a package.xml that says so, a folder above the file is what it is called.
    assert Sources(xml.parent / "urdf").package("checkout-of-a") == xml.parent
    for content in ("", "<package>", "<package/>", "\0"):
        xml.write_text(content)
        assert Sources(xml.parent / "urdf").package("a") is None
    for name in ("", ".", "..", "a/b", "../urdf"):
        assert Sources(xml.parent / "urdf").package(name) is None


def test_what_a_file_includes_is_found_beside_it(tmp_path, monkeypatch):
    inner = "<link name='a'><inertial><mass value='2'/></inertial></link>"
    (tmp_path / "sub").mkdir()
    for name, inside in (("top", "<xacro:include filename='in.xacro'/>"), ("in", inner)):
        text = f'<robot name="a" xmlns:xacro="http://www.ros.org/wiki/xacro">{inside}</robot>'
        (tmp_path / "sub" / f"{name}.xacro").write_text(text)
    monkeypatch.chdir(tmp_path)
    assert load_xacro("sub/top.xacro").links[0].mass == 2.0


@pytest.mark.parametrize("prefix", ["xacro", "x"])
def test_macros_that_were_not_expanded_are_named_under_any_prefix(prefix, tmp_path):
    file = tmp_path / "robot.urdf"
    macro = f"<{prefix}:if value='1'><link name='b'/></{prefix}:if>"
    uri = "http://www.ros.org/wiki/xacro"
    file.write_text(f'<robot name="a" xmlns:{prefix}="{uri}"><link name="a"/>{macro}</robot>')
    with pytest.raises(RecipeError, match=f"was not expanded .got '<{prefix}:if>'.; pass --xacro"):
        load_urdf(file)
    # The library knows one prefix.
    with pytest.raises(RecipeError, match=r"links without a parent|binds xacro to another prefix"):
        load_xacro(file)


def test_a_macro_that_fails_is_refused_with_its_cause(tmp_path):
    file = tmp_path / "robot.xacro"
    for inside, said in {
        "<xacro:include filename='none.xacro'/>": "none.xacro",
        "<xacro:nothing/>": "nothing",
        "<link name='${length + 1}'/>": "name 'length' is not defined",
        "<link name='$(arg side)'/>": "side",
        "<xacro:if value='maybe'/>": "maybe",
        "<xacro:include filename='$(find ..)/a'/>": "package '..' was not found",
    }.items():
        uri = "http://www.ros.org/wiki/xacro"
        file.write_text(f'<robot name="a" xmlns:xacro="{uri}">{inside}</robot>')
        with pytest.raises(RecipeError, match=said):
            load_xacro(file)


def stand(file):
    robot = load_urdf(VECTORS / "quadruped.urdf")
    found = load_srdf(file, robot)
    name = found.standing()
    import_urdf(robot, posture=found.posture(name) if name else None)


@pytest.mark.parametrize(
    ("sound", "read"),
    [
        (VECTORS / "rover.urdf", lambda file: import_urdf(load_urdf(file))),
        (VECTORS / "quadruped.srdf", stand),
        (ROBOTS / "crane.xacro", lambda file: import_urdf(load_xacro(file, PACKAGES))),
    ],
    ids=["urdf", "srdf", "xacro"],
)
def test_a_file_with_faults_is_read_or_refused_in_a_sentence(sound, read, tmp_path, capfd):
    file, said = tmp_path / "broken", []

    @given(mutated(sound.read_text()))
    def tried(content):
        file.write_bytes(content)
        try:
            read(file)
        except LutgenError as error:
            said.append(str(error))

    tried()
    # Both happen, or the faults are too harsh or too mild to show anything.
    assert 8 < len(said) < 100
    assert [words for words in said if not re.fullmatch(r".*broken.*\.", words)] == []
    assert capfd.readouterr().err == ""

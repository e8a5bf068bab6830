"""Loads on the command line and in exports, and the page of the documents."""

import math
from pathlib import Path

import pytest

import lutgen
from firmware_export.certify.answers import device
from firmware_export.certify.certificate import Effort, certify
from firmware_export.contacts import codec as contacts
from firmware_export.grid import lookup, table
from firmware_export.protocol import Export
from firmware_export.truth.model import Model
from tests.fixtures.commands import data, good, run
from tests.fixtures.documents import blocks
from tests.fixtures.recipes import feet, rigid, rover, tripod

CART = feet([(0.3, 0.3, -0.4), (-0.3, 0.3, -0.4), (-0.3, -0.3, -0.4), (0.3, -0.3, -0.4)])
MASS = '[[robot.link]]\nname = "body"\nmass = 10.0\n'
PULL = (
    '[[robot.force]]\nname = "rope"\nlink = "body"\nposition = [0, 0, 0]\n'
    "force = [49.03325, 0, 0]\n"
)


@pytest.fixture
def cart(tmp_path: Path) -> Path:
    """Return the recipe of a box of 10 kg."""
    path = tmp_path / "cart.toml"
    path.write_text(rigid(CART + MASS, name="cart"))
    return path


@pytest.fixture
def roped(tmp_path: Path) -> Path:
    """Return the same box pulled ahead with half its weight, its com known to 5 cm."""
    path = tmp_path / "roped.toml"
    path.write_text(rigid(CART + MASS + PULL, name="roped", head="com_uncertainty = 0.05"))
    return path


def test_an_acceleration_is_read_as_the_gravity_that_an_accelerometer_would_show(
    cart: Path,
) -> None:
    braking = data("eval", cart, "-a", "-4.903325,0,0")
    assert braking == data("eval", cart, "-g", "0.5,0,-1")
    assert braking["tip_angle_deg"] == pytest.approx(
        math.degrees(math.atan2(0.3, 0.4) - math.atan2(1, 2))
    )
    assert data("eval", cart, "-a", "0,0,0") == data("eval", cart)
    fall = run("eval", cart, "-a", "0,0,-9.80665")
    assert fall.exit_code == 2
    assert "free fall" in fall.stderr
    assert run("eval", cart, "-a", "1,2").exit_code == 2


def test_a_load_is_said_in_the_report(roped: Path, cart: Path) -> None:
    report = data("eval", roped)
    assert report["com_uncertainty"] == 0.05
    assert report["resultant_over_weight"] == pytest.approx([0.5, 0.0, -1.0])
    assert report["energy_margin"] is None
    text = good("eval", roped).stdout
    assert "for any com    within 0.05 m" in text
    assert "resultant      1.11803 of the weight" in text
    assert "resultant" not in good("eval", cart).stdout


def test_a_pull_of_half_the_weight_reads_like_braking_but_for_the_ball(
    roped: Path, tmp_path: Path, cart: Path
) -> None:
    alone = tmp_path / "alone.toml"
    alone.write_text(rigid(CART + MASS + PULL, name="alone"))
    braking = data("eval", cart, "-a", "-4.903325,0,0")
    assert data("eval", alone)["sdg"] == pytest.approx(braking["sdg"])
    assert data("eval", alone)["margin"] == pytest.approx(braking["margin"])
    # A horizontal part of the com's error moves the weight alone: 1 / |F| of it counts.
    loss = 0.05 / math.hypot(1.0, 0.5)
    assert data("eval", roped)["margin"] == pytest.approx(braking["margin"] - loss)  # type: ignore[operator]


def test_an_export_refuses_forces_with_one_sentence(roped: Path, tmp_path: Path) -> None:
    result = run("export", roped, "-o", tmp_path / "out")
    assert result.exit_code == 2
    assert "knows the weight and no other force (got rope)" in result.stderr
    assert not (tmp_path / "out").exists()


def test_no_export_of_an_uncertain_com_calls_a_robot_safe_that_some_com_tips() -> None:
    for text, lost in (
        (tripod(head="friction = 0.8\ncom_uncertainty = 0.03"), 0.1),
        (rover().replace('name = "rover"', 'name = "rover"\ncom_uncertainty = 0.03'), 0.1),
    ):
        recipe = lutgen.parse_recipe(text)
        model = Model(recipe)
        assert "com_uncertainty" in str(table.INFO.refusal(model, "integer"))
        assert "com_uncertainty" in str(lookup.INFO.refusal(model, "integer"))
        tables = contacts.INFO.encode(model, ("sdg", "tip_angle"), contacts.Spec())
        export = Export(
            *("robot", recipe, model, "contacts", "float", ("sdg", "tip_angle"), tables),
            certificate={},
            pareto=[],
        )
        found = certify(device(export), ("sdg", "tip_angle"), effort=Effort(20_000, 20, 25))
        assert found.false_safe == 0
        assert found.false_tip < lost
        assert "a com anywhere in its ball" in tables.guard_text


def test_everything_on_the_page_runs_and_prints_what_it_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (recipe,) = blocks("docs/guide/load.md", "toml")
    Path("tractor.toml").write_text(recipe)
    commands, shown = blocks("docs/guide/load.md", "sh"), blocks("docs/guide/load.md", "text")
    assert len(commands) == len(shown) == 2
    for command, text in zip(commands, shown, strict=True):
        program, *arguments = command.split()
        assert program == "lutgen"
        assert good(*arguments).stdout == text


def test_a_picture_of_a_loaded_robot_names_its_force_and_its_ball(
    roped: Path, tmp_path: Path
) -> None:
    picture = tmp_path / "robot.svg"
    good("plot", roped, "-o", picture, "--kind", "robot")
    text = picture.read_text()
    for words in ("force", "com anywhere within 0.05 m", "weight and forces together"):
        assert words in text

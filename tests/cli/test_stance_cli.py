"""`lutgen stance`: what it prints, its exit codes, and its figure."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

from tests.fixtures.commands import data, good, run

FEET = """com = [0.3, 0, 0.6]
friction = 0.5
[[foot]]
position = [-1, 0, 0]
normal = [1, 0, 1]
[[foot]]
name = "right"
position = [1, 0, 0]
normal = [-1, 0, 1]
"""


@pytest.fixture
def ditch(tmp_path: Path) -> Path:
    """Return the file of two feet on walls of 45 deg."""
    path = tmp_path / "ditch.toml"
    path.write_text(FEET)
    return path


def changed(path: Path, old: str, new: str) -> Path:
    """Replace a text in a file, which must be in it."""
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    return path


def test_json_has_the_verdict_the_region_and_forces_that_balance(ditch: Path) -> None:
    report = data("stance", ditch)
    assert report["holds"] is True
    assert report["margin"] == 0.0
    assert sorted(x for x, _ in report["region"]) == pytest.approx([-0.8, 0.8])
    assert report["region_is_open"] is False
    assert report["axes"] == [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    left, right = report["feet"]
    assert (left["name"], right["name"]) == ("P1", "right")
    total = [a + b for a, b in zip(left["force"], right["force"], strict=True)]
    assert total == pytest.approx([0.0, 0.0, 1.0], abs=1e-6)
    # The lever's shares, and the normal of 45 deg.
    assert right["force"][2] == pytest.approx(0.65)
    assert right["normal_force"] == pytest.approx(
        (right["force"][2] - right["force"][0]) / math.sqrt(2.0)
    )
    assert 0.0 <= left["friction_used"] <= 1.0 + 1e-6


@pytest.mark.parametrize(
    ("x", "code", "said"),
    [
        ("0.8", 0, "ditch: holds"),
        ("0.9", 3, "ditch: does not hold"),
        ("0.80001", 3, "ditch: undecided, at the limit of friction"),
    ],
)
def test_the_exit_code_is_3_unless_it_holds(ditch: Path, x: str, code: int, said: str) -> None:
    path = changed(ditch, "com = [0.3", f"com = [{x}")
    result = run("stance", path)
    assert result.exit_code == code
    assert result.stdout.splitlines()[0] == said
    report = data("stance", path, code=code)
    assert report["holds"] is {"holds": True, "does not hold": False}.get(said[7:])
    assert (report["feet"][0]["force"] is None) is (code == 3)


def test_gravity_comes_from_the_option_the_file_or_is_down(ditch: Path) -> None:
    level, steep = data("stance", ditch), data("stance", ditch, "-g", "0.3,0,-1")
    assert data("stance", ditch, "-g", "0,0,-9.81")["region"] == level["region"]
    assert steep["axes"][0] == pytest.approx(
        [1.0 / math.hypot(1, 0.3), 0, 0.3 / math.hypot(1, 0.3)]
    )
    changed(ditch, "friction", "gravity = [0.6, 0, -2]\nfriction")
    from_file = data("stance", ditch)
    # The direction is the same to the last bits.
    np.testing.assert_allclose(from_file["region"], steep["region"], atol=1e-6)
    # Level it is 1.6.
    assert np.ptp(from_file["region"], axis=0)[0] < 1.59
    assert data("stance", ditch, "-g", "0,0,-1")["region"] == level["region"]


def test_a_foot_stands_upright_where_it_has_no_normal_also_in_a_turned_frame(
    tmp_path: Path,
) -> None:
    path = tmp_path / "turned.toml"
    # Gravity along x: the feet are level along y, and friction is not needed.
    path.write_text(
        "com = [-1, 0.5, 0]\ngravity = [2, 0, 0]\nfriction = 0\n"
        "[[foot]]\nposition = [0, 0, 0]\n[[foot]]\nposition = [0.2, 1, 0]\n"
    )
    report = data("stance", path)
    assert report["holds"] is True
    assert report["axes"] == [[0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]
    assert [foot["normal_force"] for foot in report["feet"]] == pytest.approx([0.5, 0.5])
    assert [foot["friction_used"] for foot in report["feet"]] == [0.0, 0.0]


def test_a_weight_that_nothing_can_hold_has_no_region(ditch: Path) -> None:
    changed(ditch, "friction = 0.5", "friction = 0")
    changed(ditch, "normal = [-1, 0, 1]", "normal = [1, 0, 1]")
    text = run("stance", ditch)
    assert text.exit_code == 3
    assert re.search(r"^margin +-$", text.stdout, re.M)
    assert re.search(r"^region +none$", text.stdout, re.M)
    report = data("stance", ditch, code=3)
    assert (report["margin"], report["region"]) == (None, [])


def test_the_figure_repeats_to_the_byte(ditch: Path, tmp_path: Path) -> None:
    for name in ("a.png", "b.png"):
        good("stance", ditch, "-o", tmp_path / name)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")

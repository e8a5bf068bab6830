"""`lutgen weigh` and its page, and what it refuses; `lutgen import` of MuJoCo's format."""

import json
import math
import re
from pathlib import Path

import pytest

from tests.fixtures.commands import run, stdout
from tests.fixtures.places import blocks

PAGE = "docs/guide/weigh.md"


@pytest.fixture
def rover(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    stdout("new", "wheels", "-o", "rover.toml")
    Path("scales.csv").write_text(*blocks(PAGE, "csv"))


def test_what_level_scales_leave_open_is_null_and_no_uncertainty_is_claimed(rover):
    lines = Path("scales.csv").read_text().splitlines()
    Path("level.csv").write_text("\n".join([*lines[:3], ""]))
    report = json.loads(stdout("weigh", "rover.toml", "--scales", "level.csv", "--json"))
    assert report["com_open"] == ["z"]
    assert report["com_std"][2] is None
    assert "com_uncertainty" not in report["keys"]
    assert "com z  not determined" in stdout("weigh", "rover.toml", "--scales", "level.csv")
    Path("tilts.csv").write_text("heading_deg,slope_deg\n0,51\n180,49\n")
    both = ("--scales", "level.csv", "--tilt", "tilts.csv")
    assert json.loads(stdout("weigh", "rover.toml", *both, "--json"))["com_open"] == []


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("front_left,wing\n1,2\n", "unknown column 'wing' .* of front_left, front_right, "),
        ("spread,slope_deg\n0,2\n", "names no scale"),
        ("front_left\n", "there is no weighing"),
        ("front_left\n-3\n", "a scale reads 0 kg or more .*-3"),
        ("front_left,slope_deg\n3,95\n", "slope_deg: must lie from 0 to 90"),
        ("front_left,spread\n3,9\n", "spread must lie in 0 to 0.15 m"),
    ],
)
def test_files_that_cannot_be_used_are_refused(rover, text, said):
    Path("bad.csv").write_text(text)
    result = run("weigh", "rover.toml", "--scales", "bad.csv")
    assert (result.exit_code, result.stdout) == (2, "")
    assert re.search(said, result.stderr)


def test_import_reads_mujocos_format(tmp_path, monkeypatch):
    pytest.importorskip("mujoco")
    monkeypatch.chdir(tmp_path)
    feet = "".join(
        f'<geom type="sphere" size=".05" pos="{x} {y} -.2"/>'
        for x in (0.3, -0.3)
        for y in (0.2, -0.2)
    )
    Path("cart.xml").write_text(
        '<mujoco><worldbody><body name="cart"><freejoint/><geom type="box" size=".4 .3 .1"/>'
        f"{feet}</body></worldbody></mujoco>"
    )
    printed = stdout("import", "cart.xml", "-o", "cart.toml")
    assert "contacts (4)" in printed
    # A box of 96 kg, and four balls 0.2 m below it that weigh 0.52 kg each.
    balls = 4.0 * 1000.0 * 4.0 / 3.0 * math.pi * 0.05**3
    height = 0.25 - 0.2 * balls / (96.0 + balls)
    report = json.loads(stdout("limits", "cart.toml", "--json"))
    tilt = math.degrees(math.atan2(0.2, height))
    assert report["guaranteed_body_tilt_deg"] == pytest.approx(tilt, abs=1e-4)

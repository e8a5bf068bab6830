"""What commands say of a robot that rocks: neither that it stands nor that it tips over."""

from pathlib import Path

import pytest

import lutgen
from tests.fixtures.commands import data, good, run
from tests.fixtures.recipes import ALL_CHANNELS, rocker

# Nose down by so much it rocks, stands on its front wheels, and tips over them.
SEEN = {"rocks": "0,0,-1", "stands": "0.36,0,-1", "tips": "1.5,0,-1"}
# The exit code says whether it tips, so that a script need not read.
EXIT = {"rocks": 0, "stands": 0, "tips": 3}


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the recipe of a robot that rocks, and maps of it."""
    folder = tmp_path_factory.mktemp("rocker")
    for name, channels in (("rocker", ALL_CHANNELS), ("alone", ("status",))):
        text = rocker(channels=channels, nodes=33, max_tilt=60.0)
        (folder / f"{name}.toml").write_text(text)
        lutgen.sweep(lutgen.parse_recipe(text), folder / f"{name}.h5")
    return folder


@pytest.mark.parametrize("status", SEEN)
def test_eval_of_a_recipe_says_which_of_the_three_it_is(place: Path, status: str) -> None:
    asked = "eval", place / "rocker.toml", "-g", SEEN[status]
    report = data(*asked, code=EXIT[status])
    assert report["status"] == status
    assert report["standing"] is (status != "tips")
    result = run(*asked)
    assert result.exit_code == EXIT[status]
    first, second, *_ = result.stdout.splitlines()
    assert first == f"rocker (exact): {'tips over' if status == 'tips' else status}"
    assert second.split() == ["status", status]


@pytest.mark.parametrize("name", ["rocker", "alone"])
@pytest.mark.parametrize("status", SEEN)
def test_eval_of_a_map_that_holds_it_says_so_too(place: Path, name: str, status: str) -> None:
    asked = "eval", place / f"{name}.h5", "-g", SEEN[status]
    report = data(*asked, code=EXIT[status])
    assert report["status"] == status
    assert report["standing"] is (status != "tips")
    text = run(*asked).stdout
    assert "the worst of the nodes around" in text
    assert text.startswith(f"rocker (interpolated): {'tips over' if status == 'tips' else status}")


def test_off_the_chart_a_map_knows_no_status(place: Path) -> None:
    # What nobody can tell is not a 0 that lets a script go on.
    report = data("eval", place / "alone.h5", "-g", "0,0,1", code=3)
    assert report["status"] is None
    assert report["standing"] is None


def test_metrics_tell_headings_in_which_it_rocks_from_those_in_which_it_stands(place: Path) -> None:
    report = data("metrics", place / "rocker.toml", "--tilt", 10, "--headings", 4)
    assert report["level"]["status"] == "rocks"
    found = [entry["status"] for entry in report["headings"]]
    assert found == ["stands", "rocks", "stands", "rocks"]
    text = good("metrics", place / "rocker.toml", "--tilt", 10, "--headings", 4).stdout
    verdicts = [line.split()[1] for line in text.splitlines()[2:]]
    assert verdicts == ["rocks", *found]


def test_info_says_which_words_a_map_of_them_holds(place: Path) -> None:
    assert "  status: stands to tips\n" in good("info", place / "alone.h5").stdout
    assert 0.1 < data("info", place / "alone.h5")["share_that_tips"] < 0.9  # type: ignore[operator]

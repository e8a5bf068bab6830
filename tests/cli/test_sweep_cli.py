"""`lutgen sweep` and `lutgen info`, and that no command replaces what lutgen did not make."""

import math
import shutil
from pathlib import Path

import numpy as np
import pytest

import lutgen
from lutgen.files import is_ours
from lutgen.mapping.compute import Computer
from tests.fixtures.commands import data, good, run
from tests.fixtures.recipes import ALL_CHANNELS, tripod

MINE = b"my thesis"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Return a folder with a recipe, made the working folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "r.toml").write_text(tripod("reach = 2, swing = 2", nodes=3))
    return tmp_path


# sweep and info


def test_a_sweep_prints_nothing_on_stdout_and_goes_on_after_an_interruption(monkeypatch):
    result = good("sweep", "r.toml", "-o", "a.h5", "--threads", 1)
    assert (result.stdout, "a.h5" in result.stderr) == ("", True)
    assert good("-q", "sweep", "r.toml", "-o", "a.h5").output == ""

    def interrupt(self, block):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(Computer, "compute", interrupt)
        result = run("sweep", "r.toml", "-o", "b.h5")
    assert (result.exit_code, "--resume" in result.stderr) == (1, True)
    assert sorted(path.name for path in Path().iterdir()) == ["a.h5", "b.h5.part", "r.toml"]
    good("sweep", "r.toml", "-o", "b.h5", "--resume")
    assert Path("a.h5").read_bytes() == Path("b.h5").read_bytes()


def test_info_tells_axes_ranges_and_provenance_of_the_stored_values():
    Path("tripod.toml").write_text(tripod(channels=ALL_CHANNELS, max_tilt=60.0))
    good("sweep", "tripod.toml", "-o", "tripod.h5")
    assert "checksums: all good" in good("info", "tripod.h5", "--verify").stdout
    assert "checksums" not in good("info", "tripod.h5").stdout
    report = data("info", "tripod.h5", "--verify")
    stability_map = lutgen.load_map("tripod.h5")
    assert (report["verified"], report["robot"], report["definition"]) == (True, "tripod", 3)
    channels = {entry["name"]: entry for entry in report["channels"]}
    assert list(channels) == list(ALL_CHANNELS)
    words = channels.pop("status")
    assert (words["min"], words["max"], words["unit"]) == ("stands", "tips", "")
    for name, entry in channels.items():
        values = stability_map.channel(name)
        scale = 180.0 / math.pi if name == "tip_angle" else 1.0
        finite = values[np.isfinite(values)]
        assert entry["min"] == pytest.approx(float(finite.min()) * scale, rel=1e-12)
        assert entry["max"] == pytest.approx(float(finite.max()) * scale, rel=1e-12)
    assert {name: entry["unit"] for name, entry in channels.items()} == {
        **dict.fromkeys(("sdg", "height", "margin", "energy_margin"), "m"),
        "tip_angle": "deg",
        "least_share": "1",
        "facet": "1",
    }
    assert 0.0 < report["share_that_tips"] < 1.0


# what is replaced


def refused(name, *arguments):
    """Run a command that must refuse to replace a file, and leave it as it is."""
    before, names = Path(name).read_bytes(), sorted(path.name for path in Path().iterdir())
    result = run(*arguments)
    assert result.exit_code == 2, result.stderr
    assert name in result.stderr
    assert Path(name).read_bytes() == before
    assert sorted(path.name for path in Path().iterdir()) == names


def test_a_sweep_replaces_maps_and_nothing_else():
    Path("thesis.txt").write_bytes(MINE)
    refused("thesis.txt", "sweep", "r.toml", "-o", "thesis.txt")
    for _ in range(2):
        good("sweep", "r.toml", "-o", "a.h5")
    good("sweep", "r.toml", "-o", "thesis.txt", "--force")
    assert is_ours("thesis.txt")
    Path("link.h5").symlink_to("r.toml")
    refused("link.h5", "sweep", "r.toml", "-o", "link.h5", "--force")


def test_unfinished_work_is_neither_thrown_away_without_a_word_nor_followed():
    def stop(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        lutgen.sweep(lutgen.load_recipe("r.toml"), "a.h5", progress=stop)
    refused("a.h5.part", "sweep", "r.toml", "-o", "a.h5")
    shutil.copy("a.h5.part", "b.h5.part")
    good("sweep", "r.toml", "-o", "a.h5", "--resume")
    good("sweep", "r.toml", "-o", "b.h5", "--force")
    assert Path("a.h5").read_bytes() == Path("b.h5").read_bytes()
    # Of somebody else, and a link.
    Path("c.h5.part").write_bytes(MINE)
    Path("d.h5.part").symlink_to("r.toml")
    for name, more in (("c", ()), ("c", ("--resume",)), ("d", ("--resume",)), ("d", ("--force",))):
        refused(f"{name}.h5.part", "sweep", "r.toml", "-o", f"{name}.h5", *more)
    good("sweep", "r.toml", "-o", "c.h5", "--force")
    assert not Path("c.h5.part").exists()

"""The cache of machine code: whose folder it is in, and what becomes of damaged entries."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from lutgen import cache
from tests.fixtures.places import ROOT

SOAK = "LUTGEN_SOAK" in os.environ


def test_damaged_entries_are_compiled_anew_without_a_crash(tmp_path: Path) -> None:
    count = 500 if SOAK else 18
    done = subprocess.run(
        [sys.executable, "-m", "tests.ground.soak_cache", str(count), str(tmp_path)],
        capture_output=True,
        text=True,
        cwd=ROOT,
        timeout=3600,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    print(done.stdout)
    assert done.stdout.splitlines()[-1] == f"{count} damaged entries: {count} right answers"
    # Damage was met: whatever was damaged was not loaded.
    assert "4 loaded" not in done.stdout
    assert done.stderr == ""


def test_a_folder_of_this_user_alone_is_made_and_used(tmp_path: Path) -> None:
    folder = tmp_path / "lutgen" / "0123"
    assert cache.usable(folder)
    assert folder.stat().st_mode & 0o777 == 0o700
    # One that others could read, but not write, is closed.
    folder.chmod(0o755)
    assert cache.usable(folder)
    assert folder.stat().st_mode & 0o777 == 0o700


def open_to_all(folder: Path) -> None:
    """Let everybody write into the folder."""
    folder.mkdir()
    folder.chmod(0o777)


def open_above(folder: Path) -> None:
    """Let everybody rename the folder."""
    folder.mkdir(mode=0o700)
    folder.parent.chmod(0o777)


def linked(folder: Path) -> None:
    """Let the folder be a link."""
    folder.with_name("real").mkdir(mode=0o700)
    folder.symlink_to(folder.with_name("real"))


def given_away(folder: Path) -> None:
    """Give the folder to somebody else."""
    folder.mkdir(mode=0o700)
    give(folder)


def above_given_away(folder: Path) -> None:
    """Give what is above the folder to somebody else."""
    folder.mkdir(mode=0o700)
    give(folder.parent)


def through_a_link(folder: Path) -> None:
    """Let somebody else's link lead to the folder."""
    real = folder.parent.with_name("elsewhere")
    folder.parent.rename(real)
    folder.parent.symlink_to(real)
    (real / folder.name).mkdir(mode=0o700)
    give(folder.parent)


def give(path: Path) -> None:
    """Change the owner of a file or a link, which needs the superuser."""
    if os.geteuid() != 0:
        pytest.skip("needs to be root")
    os.chown(path, 65534, 65534, follow_symlinks=False)


@pytest.mark.parametrize(
    "plant", [open_to_all, open_above, linked, given_away, above_given_away, through_a_link]
)
def test_a_folder_that_somebody_else_may_have_filled_is_not_used_and_one_sentence_says_so(
    plant: Callable[[Path], None], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "lutgen" / "0123"
    folder.parent.mkdir(mode=0o700)
    plant(folder)
    assert not cache.usable(folder)
    assert not cache.usable(folder)
    said = capfd.readouterr().err
    assert said.count("\n") == 1
    assert "somebody else can write there" in said
    assert "NUMBA_CACHE_DIR" in said


def test_without_a_home_the_folder_is_named_after_the_user(monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown() -> Path:
        raise RuntimeError("no home")

    monkeypatch.setattr(Path, "home", unknown)
    for name in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    assert cache.cache_root().name == f"lutgen-{os.geteuid()}"

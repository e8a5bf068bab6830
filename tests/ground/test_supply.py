"""What is installed beside lutgen: its bounds, a lock with digests, and no address of an index."""

import json
import re

import pytest

from tests.fixtures.places import ROOT
from tools import pins

# Hosts of package indexes, in halves: nor is one named here.
HOSTS = (("pypi", "org"), ("pythonhosted", "org"), ("anaconda", "org"), ("npmjs", "org"))
ADDRESS = re.compile(
    "|".join([*(rf"{name}\.{end}" for name, end in HOSTS), r"https?://[^\s\"')]*/simple\b"])
)
# What is committed is text, but for pictures; what is made is elsewhere.
MADE = {".git", ".venv", "build", "__pycache__"}
PICTURES = {".png", ".so", ".pyc", ".gif"}


def version(text: str) -> tuple[int, ...]:
    return tuple(int(part) for part in re.findall(r"\d+", text)[:3])


def below_or_same(low: str, high: str) -> bool:
    """Return whether one version is not above another; 2.0 and 2.0.0 are the same."""
    pair = [(*version(text), 0, 0)[:3] for text in (low, high)]
    return pair[0] <= pair[1]


def test_every_dependency_has_one_lower_and_one_upper_bound() -> None:
    bounds = pins.bounds()
    assert {"numpy", "numba", "setuptools", "ruff"} <= set(bounds)
    for name, (low, high) in bounds.items():
        assert below_or_same(low, high), name


def test_the_lock_keeps_within_the_bounds_and_has_all_that_tests_and_checks_need() -> None:
    bounds, locked = pins.bounds(), pins.locked()
    for one in locked:
        low, high = bounds.get(one.name, ("0", "9999999"))
        assert below_or_same(low, one.version), one
        assert not below_or_same(high, one.version), one
    # Those of other extras are large, and no test needs them.
    assert set(bounds) - {one.name for one in locked} <= {
        "mujoco",
        "pin",
        "example-robot-data",
        "selenium",
        "zfpy",
        "furo",
        "myst-parser",
        "sphinx",
    }


def test_whatever_is_locked_has_digests() -> None:
    locked = pins.locked()
    assert len(locked) > 40
    assert [one for one in locked if not one.digests] == []


def test_the_bill_lists_what_is_locked() -> None:
    document = json.loads(pins.bill())
    assert (document["bomFormat"], document["specVersion"]) == ("CycloneDX", "1.6")
    listed = [(part["name"], part["version"]) for part in document["components"]]
    assert listed == [(one.name, one.version) for one in pins.locked()]


def test_no_file_names_an_index_of_packages() -> None:
    found = [
        str(path.relative_to(ROOT))
        for path in ROOT.rglob("*")
        if path.is_file()
        and not MADE & set(path.relative_to(ROOT).parts)
        and path.suffix not in PICTURES
        and ADDRESS.search(path.read_text("utf-8", errors="replace"))
    ]
    assert found == []
    assert "://" not in pins.LOCK.read_text("utf-8")
    assert "index" not in pins.LOCK.read_text("utf-8")


@pytest.mark.parametrize("name", ["numpy", "numpy>=1", "numpy<3", "numpy==1.26"])
def test_a_dependency_without_both_bounds_is_found(
    name: str, monkeypatch: pytest.MonkeyPatch, tmp_path
) -> None:
    text = (ROOT / "pyproject.toml").read_text("utf-8")
    changed = re.sub(r'"numpy>=[^"]*"', f'"{name}"', text, count=1)
    assert changed != text
    (tmp_path / "pyproject.toml").write_text(changed, "utf-8")
    monkeypatch.setattr(pins, "ROOT", tmp_path)
    with pytest.raises(ValueError, match="has no bounds"):
        pins.bounds()

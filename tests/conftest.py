"""Fixtures that several test files share, and what happens to tests that cannot run here."""

from pathlib import Path

import numba
import pytest
from hypothesis import settings

import lutgen
from lutgen.errors import LutgenError
from lutgen.mapping import plan, sweeper
from lutgen.quantities import CHANNELS
from tests.fixtures.needs import ABSENT, lacking
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import tripod

# The first call of a kernel compiles it, so a deadline would fail at random; the examples
# are the same in every run, so a failure can be repeated.
settings.register_profile("lutgen", deadline=None, derandomize=True, max_examples=100)
settings.load_profile("lutgen")


def in_one_line(error, *words):
    """Demand of every error of lutgen that its message is one line, or one for each wrong key."""
    super(LutgenError, error).__init__(*words)
    # The name of a file may hold anything; commands show its escapes.
    for line in str(error).split("\n")[1:] if "\x1b" not in str(error) else ():
        assert ": key `" in line or line.endswith("more faults."), error


def pytest_configure(config):
    """Look at every message; let each of several workers compute by one thread."""
    LutgenError.__init__ = in_one_line
    if hasattr(config, "workerinput"):
        numba.set_num_threads(1)


def pytest_addoption(parser):
    """Add the two options by which continuous integration runs every test exactly once."""
    group = parser.getgroup("tests that are skipped")
    group.addoption(
        "--skipped-to",
        metavar="FILE",
        type=Path,
        help="write the names of the tests that were skipped, one a line, to FILE",
    )
    group.addoption("--nothing-skipped", action="store_true", help="fail if a test is skipped")


def pytest_collection_modifyitems(items):
    """Skip the tests that need what is not here, and say what that is."""
    for item in items:
        names = [name for mark in item.iter_markers("needs") for name in mark.args]
        missing = "; ".join(filter(None, map(lacking, names)))
        if missing:
            item.add_marker(pytest.mark.skip(reason=missing))


def pytest_sessionfinish(session):
    """Write down what was skipped, without what cannot be installed; fail if nothing may be."""
    config = session.config
    reporter = config.pluginmanager.get_plugin("terminalreporter")
    if reporter is None:  # in a worker
        return
    skipped = reporter.stats.get("skipped", [])
    if skipped and config.getoption("nothing_skipped"):
        session.exitstatus = pytest.ExitCode.TESTS_FAILED
    if place := config.getoption("skipped_to"):
        absent = [one for one in skipped if any(why in str(one.longrepr) for why in ABSENT)]
        names = {one.nodeid for one in skipped if one not in absent}
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text("".join(f"{name}\n" for name in sorted(names)), encoding="utf-8")


@pytest.fixture
def tripod_path(tmp_path):
    path = tmp_path / "tripod.toml"
    path.write_text(tripod())
    return path


@pytest.fixture(scope="session")
def two():
    return lutgen.load_recipe(MAPS / "paper_two.toml")


@pytest.fixture(scope="session")
def swept(tmp_path_factory):
    """Return a folder with three maps that no test changes."""
    folder = tmp_path_factory.mktemp("maps")
    for name, text in {
        "cone": tripod(channels=CHANNELS, nodes=9, max_tilt=60.0),
        "sphere": tripod(channels=("sdg", "tip_angle", "height"), chart="sphere", nodes=5),
        "alone": tripod(channels=("sdg",), nodes=9, max_tilt=60.0),
    }.items():
        lutgen.sweep(lutgen.parse_recipe(text), folder / f"{name}.h5")
    return folder


@pytest.fixture
def cut(monkeypatch):
    """Return a function that sets how many nodes a block of a sweep may hold."""

    def set_size(nodes):
        monkeypatch.setattr(sweeper, "plan", lambda recipe: plan(recipe, nodes))

    return set_size

"""Fixtures that several test files share."""

from pathlib import Path

import pytest
from hypothesis import settings

# The first call of a kernel compiles it, so a deadline would fail at random; the examples
# are the same in every run, so a failure can be repeated.
settings.register_profile("lutgen", deadline=None, derandomize=True, max_examples=100)
settings.load_profile("lutgen")


@pytest.fixture(scope="session")
def maps_folder() -> Path:
    """Return the folder with the recipes of the project."""
    return Path(__file__).resolve().parent.parent / "maps"

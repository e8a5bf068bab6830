"""What is installed beside lutgen."""

import re
import tomllib

from tests.fixtures.places import ROOT


def test_every_dependency_has_a_lower_and_an_upper_bound():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    extras = settings["project"]["optional-dependencies"].values()
    needs = [*settings["project"]["dependencies"], *(need for extra in extras for need in extra)]
    needs += settings["build-system"]["requires"]
    assert len(needs) > 20
    wrong = [need for need in needs if not re.fullmatch(r"[a-z0-9-]+>=[0-9.]+,<[0-9.]+", need)]
    assert wrong == []

"""What is installed beside lutgen, and under which licence its C is."""

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


def test_every_file_of_c_says_its_licence():
    rooms = [ROOT / room for room in ("benchmarks", "firmware_export", "proofs", "targets")]
    sources = [
        path for room in rooms for end in ("[chS]", "mjs") for path in room.rglob(f"*.{end}")
    ]
    assert len(sources) > 20
    lines = ["SPDX-License-Identifier: MIT", "Copyright (c) The lutgen authors"]
    for path in sources:
        head = path.read_text(encoding="utf-8").splitlines()[:2]
        assert [line.strip("/*# ") for line in head] == lines, path

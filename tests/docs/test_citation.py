"""What a reference manager reads, and what the policy promises."""

import re

import lutgen
from tests.fixtures.places import ROOT

CITATION = (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def test_the_citation_has_what_its_format_asks_for_and_the_version_of_the_package():
    keys = dict(re.findall(r"^([a-z-]+):[ ]*(.*)$", CITATION, re.MULTILINE))
    assert {"cff-version", "message", "title", "authors"} <= set(keys)
    assert keys["cff-version"] == "1.2.0"
    assert keys["version"] == lutgen.__version__
    assert f'license = "{keys["license"]}"' in (ROOT / "pyproject.toml").read_text()
    assert "- name: The lutgen developers" in CITATION
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    newest = re.search(r"^## (.*\d)$", changes, re.MULTILINE)  # not one that is unreleased
    assert newest is not None
    assert newest[1] == f"{lutgen.__version__}, {keys['date-released']}"

"""Names that documents, docstrings and comments mention are there."""

import pkgutil
import re

import pytest

from tests.fixtures.places import DOCUMENTS, SOURCES

NAME = re.compile(r"(?<![\w/.-])((?:lutgen|firmware_export)(?:\.[a-zA-Z_]\w*)+)")
# A name that ends like this is that of a file.
FILES = {"c", "csv", "gif", "h", "h5", "json", "md", "png", "svg", "toml", "urdf"}


@pytest.mark.parametrize("pages", [DOCUMENTS, SOURCES], ids=["documents", "sources"])
def test_every_dotted_name_of_a_document_resolves(pages):
    gone = []
    # The changelog says what names were before.
    for page in (page for page in pages if page.name != "CHANGELOG.md"):
        text = page.read_text(encoding="utf-8")
        for name in NAME.findall(text):
            if name.rpartition(".")[2] not in FILES:
                try:
                    pkgutil.resolve_name(name)
                except (ImportError, AttributeError):
                    gone.append(f"{page.name}: {name}")
    assert gone == []

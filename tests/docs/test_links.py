"""Links and names of documents and sources lead to something."""

import pkgutil
import re

import pytest

from tests.fixtures.places import DOCUMENTS, ROOT, SOURCES

# `search/driving` is a source, too.
ENDS = ("", ".py")
NAME = re.compile(r"(?<![\w/.-])((?:lutgen|firmware_export)(?:\.[a-zA-Z_]\w*)+)")
# A name that ends like this is that of a file.
FILES = {"c", "csv", "gif", "h", "h5", "json", "md", "png", "svg", "toml", "urdf"}


def prose(page):
    return re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)


def test_links_lead_to_files_and_every_page_can_be_reached_from_the_readme():
    seen, waiting, missing = set(), [ROOT / "README.md"], []
    while waiting:
        page = waiting.pop()
        seen.add(page)
        for target in re.findall(r"\]\(([^)#\s]+)", re.sub(r"`[^`\n]*`", "", prose(page))):
            end = (page.parent / target).resolve()
            if "://" not in target and not end.exists():
                missing.append(f"{page.name}: {target}")
            elif end.suffix == ".md" and end not in seen:
                waiting.append(end)
    assert missing == []
    assert set(DOCUMENTS) - seen == set()


def test_every_source_that_a_document_names_with_its_folder_is_there():
    missing = []
    for page in DOCUMENTS:
        for name in re.findall(r"`((?:[a-z_]+/)+[a-z_]*(?:\.(?:py|[ch]))?)`", prose(page)):
            # In full, or from a package on, as in `search/driving`.
            folders = [ROOT / folder for folder in ("", "lutgen", "firmware_export")]
            known = any((folder / name.split("/")[0]).is_dir() for folder in folders)
            there = any((folder / f"{name}{end}").exists() for folder in folders for end in ENDS)
            if known and not there and not name.startswith("build/"):
                missing.append(f"{page.name}: {name}")
    assert missing == []


@pytest.mark.parametrize("pages", [DOCUMENTS, SOURCES], ids=["documents", "sources"])
def test_every_dotted_name_and_every_file_of_the_runtime_is_there(pages):
    gone, runtime = [], ROOT / "firmware_export" / "runtime"
    # The changelog says what names were before.
    for page in (page for page in pages if page.name != "CHANGELOG.md"):
        text = page.read_text(encoding="utf-8")
        parts = re.findall(r"\bruntime/(\w+\.[ch])\b", text)
        gone += [f"{page.name}: {part}" for part in parts if not (runtime / part).exists()]
        for name in NAME.findall(text):
            if name.rpartition(".")[2] not in FILES:
                try:
                    pkgutil.resolve_name(name)
                except (ImportError, AttributeError):
                    gone.append(f"{page.name}: {name}")
    assert gone == []

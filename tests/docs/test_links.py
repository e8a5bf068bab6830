"""Links between the documents: each leads to a file that is there, and to a heading in it."""

import re
from pathlib import Path

import pytest

from tests.fixtures.places import DOCUMENTS, ROOT


def prose(text: str) -> str:
    """Return a page without its fenced blocks and without code between back-quotes."""
    return re.sub(r"`[^`\n]*`", "", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S))


def anchors(text: str) -> set[str]:
    """Return the anchors of a page's headings, as the usual viewers make them."""
    found: set[str] = set()
    for heading in re.findall(
        r"^#+ (.+)$", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S), re.M
    ):
        plain = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).lower()
        name = re.sub(r"[^\w\- ]", "", plain).strip().replace(" ", "-")
        again = [name, *(f"{name}-{count}" for count in range(1, 100))]
        found.add(next(one for one in again if one not in found))
    return found


def broken(page: Path, text: str) -> list[str]:
    """Return the links of a page that lead nowhere."""
    wrong = []
    for target, anchor in re.findall(r"\]\(([^)#\s]*)(?:#([^)\s]+))?\)", prose(text)):
        if "://" in target:
            continue
        end = (page.parent / target).resolve() if target else page
        if not end.exists():
            wrong.append(target)
        elif anchor and anchor not in anchors(end.read_text(encoding="utf-8") if target else text):
            wrong.append(f"{target}#{anchor}")
    return wrong


@pytest.mark.parametrize("page", DOCUMENTS, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_relative_link_of_a_document_leads_to_a_file_and_a_heading(page: Path) -> None:
    assert broken(page, page.read_text(encoding="utf-8")) == []


def test_a_link_to_a_missing_file_or_heading_is_found() -> None:
    page = ROOT / "docs" / "design.md"
    text = "# One\n## One\n[a](none.md) [b](#one-1) [c](#two) `[d](code.md)` [e](design.md#no)"
    assert broken(page, text) == ["none.md", "#two", "design.md#no"]


def test_every_page_can_be_reached_from_the_readme() -> None:
    seen: set[Path] = set()
    waiting = [ROOT / "README.md"]
    while waiting:
        page = waiting.pop()
        seen.add(page)
        for target in re.findall(r"\]\(([^)#\s]+\.md)", prose(page.read_text(encoding="utf-8"))):
            end = (page.parent / target).resolve()
            if "://" not in target and end not in seen:
                waiting.append(end)
    assert set(DOCUMENTS) - seen == set()


@pytest.mark.parametrize("page", DOCUMENTS, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_source_that_a_document_names_with_its_folder_is_there(page: Path) -> None:
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    missing = []
    for name in re.findall(r"`((?:[a-z_]+/)+[a-z_]*(?:\.(?:py|[ch]))?)`", text):
        # In full, or from a package on, as in `search/driving`.
        folders = [ROOT / folder for folder in ("", "lutgen", "firmware_export")]
        known = any((folder / name.split("/")[0]).is_dir() for folder in folders)
        homes = [folder / name for folder in folders]
        there = any(home.exists() or home.with_suffix(".py").exists() for home in homes)
        if known and not there and not name.startswith("build/"):
            missing.append(name)
    assert missing == []

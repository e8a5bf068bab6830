"""The site: it is built without a warning, and nothing public is missing from its reference."""

import fcntl
import re
import subprocess
import sys
import zlib
from functools import cache
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import click
import pytest

import firmware_export
import lutgen
from lutgen.cli import main
from lutgen.recipe.keys import KEYS
from tests.fixtures.places import ROOT

pytestmark = pytest.mark.needs("sphinx")

HEADERS = [ROOT / "firmware_export/runtime" / name for name in ("smap.h", "smap_control.h")]


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """Return the folder of the site, and the exit code and words of its build.

    It is that of `make docs`, so that only what is new is read; one process builds it for all.
    """
    shared = tmp_path_factory.getbasetemp()
    shared = shared.parent if shared.name.startswith("popen-") else shared
    with (shared / "site.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        said = shared / "site.txt"
        if not said.is_file():
            command = [sys.executable, "-m", "tools.site"]
            done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
            said.write_text(f"{done.returncode}\n{done.stdout}{done.stderr}")
    return ROOT / "build" / "site", said.read_text()


@pytest.fixture(scope="module")
def site(built: tuple[Path, str]) -> Path:
    """Return the folder of the site."""
    return built[0]


@cache
def known(site: Path) -> dict[str, set[str]]:
    """Return the names of everything that the site documents, by their role."""
    inventory = (site / "objects.inv").read_bytes()
    _, _, _, _, packed = inventory.split(b"\n", 4)
    found: dict[str, set[str]] = {}
    for line in zlib.decompress(packed).decode().splitlines():
        match = re.match(r"(.+?)\s+(\S+:\S+)\s+(-?\d+)\s+(\S*)\s+(.*)", line)
        assert match is not None, line
        found.setdefault(match[2], set()).add(match[1])
    return found


class Page(HTMLParser):
    """What a page of the site refers to, and the places in it that can be referred to."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.ids: set[str] = set()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note what a tag refers to."""
        for name, value in attrs:
            if name == "id" and value:
                self.ids.add(value)
            elif name == "href" and value and tag == "a":
                self.links.append(value)
            elif name in ("href", "src") and value and tag != "a":
                self.loads.append(value)


def test_the_build_ends_without_a_warning(built: tuple[Path, str]) -> None:
    assert built[1] == "0\n"


def test_every_public_name_of_python_is_in_the_reference(site: Path) -> None:
    names = {name for role, some in known(site).items() if role.startswith("py:") for name in some}
    wanted = {f"lutgen.{name}" for name in lutgen.__all__}
    wanted |= {f"firmware_export.{name}" for name in firmware_export.__all__}
    assert len(wanted) >= 16
    assert wanted - names == set()


def test_every_command_and_every_option_is_in_the_reference(site: Path) -> None:
    page = (site / "docs/reference/commands.html").read_text(encoding="utf-8")
    titles = set(re.findall(r"<h2>(lutgen[\w -]*)<", page))
    wanted = set()
    for name, command in main.commands.items():
        assert f"lutgen {name}" in titles
        context = click.Context(command, info_name=name, help_option_names=["-h", "--help"])
        for param in command.get_params(context):
            if isinstance(param, click.Option):
                flags = (*param.opts, *param.secondary_opts)
                wanted |= {f"lutgen-{name}.{flag}" for flag in flags}
    assert len(wanted) > 150
    assert wanted - known(site)["std:cmdoption"] == set()


def test_every_key_of_a_recipe_is_in_the_reference(site: Path) -> None:
    page = (site / "docs/reference/recipe.html").read_text(encoding="utf-8")
    # The first cell of a row, in whatever the table is about.
    rows = set(re.findall(r"<tr[^>]*><td><p><code[^>]*><span[^>]*>(\w+)</span>", page))
    wanted = {key.name for keys in KEYS.values() for key in keys}
    assert len(wanted) > 40
    assert wanted - rows == set()


def test_every_function_type_and_macro_of_the_headers_is_in_the_reference(site: Path) -> None:
    text = "\n".join(path.read_text(encoding="utf-8") for path in HEADERS)
    code = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    roles = known(site)
    functions = set(re.findall(r"^static inline \w+ (\w+)\(", code, re.MULTILINE))
    assert len(functions) >= 20
    assert functions - roles["c:function"] == set()
    # How a map is reached is no business of a caller.
    types = {name for name in re.findall(r"\b(smap_\w+_t)\b", code) if "runtime" not in name}
    documented = roles["c:struct"] | roles["c:enum"] | roles["c:type"]
    assert types - documented == set()
    constants = set(re.findall(r"\b(SMAP_\w+) = -?\d", code))
    macros = set(re.findall(r"^#define (SMAP_\w+)[( ]", code, re.MULTILINE))
    assert len(constants) >= 12
    named = {name.rpartition(".")[2] for name in roles["c:enumerator"]} | roles["c:macro"]
    assert (constants | macros) - named == set()


def test_every_link_leads_to_a_page_and_a_place_and_nothing_comes_from_a_network(
    site: Path,
) -> None:
    pages = {path: Page(path) for path in site.rglob("*.html") if "explorer" not in path.parts}
    assert len(pages) > 45
    wrong = []
    for path, page in pages.items():
        for target in [*page.links, *page.loads]:
            parts = urlsplit(unescape(target))
            if parts.scheme in ("http", "https", "data", "mailto"):
                if target in page.loads and parts.scheme != "data":
                    wrong.append((path.name, target))
                continue
            end = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            known_place = end not in pages or not parts.fragment or parts.path == ""
            if not end.is_file() or not (known_place or unquote(parts.fragment) in pages[end].ids):
                wrong.append((path.name, target))
            if not parts.path and parts.fragment and unquote(parts.fragment) not in page.ids:
                wrong.append((path.name, target))
    assert wrong == []


def test_every_term_of_the_glossary_can_be_looked_up(site: Path) -> None:
    text = (ROOT / "docs/reference/glossary.md").read_text(encoding="utf-8")
    terms = {
        one for said in re.findall(r"^- \*\*(.+?)\*\*:", text, re.M) for one in said.split(", ")
    }
    assert len(terms) > 60
    assert {term.lower() for term in terms} == {term.lower() for term in known(site)["std:term"]}
    index = (site / "genindex.html").read_text(encoding="utf-8")
    assert [term for term in terms if f"<strong>{term}</strong></a>" not in index] == []
    assert (site / "search.html").is_file()


def test_the_site_shows_what_the_notebooks_gave(site: Path) -> None:
    for notebook in ROOT.glob("docs/notebooks/*.ipynb"):
        page = (site / "docs/notebooks" / f"{notebook.stem}.html").read_text(encoding="utf-8")
        assert f"{notebook.stem}_" in page, "it has a figure"
        assert '"outputs": []' in notebook.read_text(encoding="utf-8")
        assert not re.search(r'"outputs": \[[^\]]', notebook.read_text(encoding="utf-8"))

"""The site: it is built without a warning, and nothing public is missing from its reference."""

import fcntl
import posixpath
import re
import subprocess
import sys
from functools import cache

import pytest

import firmware_export
import lutgen
from tests.fixtures.places import ROOT

pytestmark = pytest.mark.needs("sphinx")

# Notebooks run in `test_pages`, without a kernel of their own.
BUILD = ["-q", "-W", "--keep-going", "-c", "docs", "-D", "nb_execution_mode=off"]
BUILD += ["-d", "build/site-test-work", ".", "build/site-test"]
HEADERS = [ROOT / "firmware_export/runtime" / name for name in ("smap.h", "smap_control.h")]


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Return the folder of the site, and the exit code and words of its build.

    It is kept, so that only what is new is read; one process builds it for all.
    """
    shared = tmp_path_factory.getbasetemp()
    shared = shared.parent if shared.name.startswith("popen-") else shared
    with (shared / "site.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        said = shared / "site.txt"
        if not said.is_file():
            command = [sys.executable, "-m", "sphinx", *BUILD]
            done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
            said.write_text(f"{done.returncode}\n{done.stdout}{done.stderr}")
    return ROOT / "build" / "site-test", said.read_text()


@pytest.fixture(scope="module")
def site(built):
    return built[0]


@cache
def known(site):
    from sphinx.util.inventory import InventoryFile

    with (site / "objects.inv").open("rb") as file:
        return InventoryFile.load(file, "", posixpath.join)


def test_the_build_ends_without_a_warning(built):
    assert built[1].startswith("0\n"), built[1]


def test_every_public_name_of_python_is_in_the_reference(site):
    names = {name for role, some in known(site).items() if role.startswith("py:") for name in some}
    wanted = {f"lutgen.{name}" for name in lutgen.__all__}
    wanted |= {f"firmware_export.{name}" for name in firmware_export.__all__}
    assert len(wanted) >= 16
    assert wanted - names == set()


def test_every_function_type_and_constant_of_the_headers_is_in_the_reference(site):
    text = "\n".join(path.read_text(encoding="utf-8") for path in HEADERS)
    code = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    roles = known(site)
    functions = set(re.findall(r"^static inline \w+ (\w+)\(", code, re.MULTILINE))
    assert len(functions) >= 20
    assert functions - set(roles["c:function"]) == set()
    # The rest stands in the headers themselves, which the page shows.
    page = re.sub(r"<[^>]+>", "", (site / "docs/reference/c.html").read_text(encoding="utf-8"))
    constants = set(re.findall(r"\b(?:SMAP_\w+|smap_\w+_t)\b", code))
    assert len(constants) >= 20
    assert {name for name in constants if name not in page} == set()


def test_no_page_loads_anything_from_a_network(site):
    pages = [page for page in site.rglob("*.html") if "explorer" not in page.parts]
    assert len(pages) > 45
    loads = re.compile(r"""<(?:link|script|img|iframe)[^>]+(?:src|href)=["'](?:https?:)?//""")
    assert [page.name for page in pages if loads.search(page.read_text("utf-8"))] == []


def test_every_term_of_the_glossary_can_be_looked_up(site):
    text = (ROOT / "docs/reference/glossary.md").read_text(encoding="utf-8")
    terms = {
        one for said in re.findall(r"^- \*\*(.+?)\*\*:", text, re.M) for one in said.split(", ")
    }
    assert len(terms) > 60
    assert {term.lower() for term in terms} == {term.lower() for term in known(site)["std:term"]}
    index = (site / "genindex.html").read_text(encoding="utf-8")
    assert [term for term in terms if f"<strong>{term}</strong></a>" not in index] == []
    assert (site / "search.html").is_file()

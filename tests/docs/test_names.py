"""What docstrings, comments and documents name between back-quotes is there under that name."""

import ast
import importlib
import importlib.util
import re
import tokenize
from functools import cache
from pathlib import Path

import pytest

from tests.fixtures.places import DOCUMENTS, ROOT

PACKAGES = ("lutgen", "firmware_export", "targets", "proofs", "benchmarks")
SOURCES = sorted(
    path
    for folder in (*PACKAGES, "tests", "tools")
    for path in (ROOT / folder).rglob("*.py")
    if "__pycache__" not in path.parts
)
# Tokens between two statements.
BETWEEN = {tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT}
# A name that ends like this is that of a file; links to files are followed elsewhere.
FILES = {"c", "h", "o", "csv", "gif", "h5", "in", "json", "md", "part", "png", "toml", "urdf"}
# The mark of a typed package is one, too.
FILES |= {"typed"}


def fenced(text: str) -> str:
    """Return the fenced blocks of a page."""
    return "\n".join(re.findall(r"^```.*?^```", text, re.M | re.S))


@cache
def parted(path: Path) -> tuple[str, frozenset[str]]:
    """Return the docstrings and comments of a Python file, and every other word in it.

    A docstring is a text that is a statement by itself.
    """
    said, words = list[str](), set[str]()
    start = True
    with path.open(encoding="utf-8") as file:
        for token in tokenize.generate_tokens(file.readline):
            if token.type == tokenize.COMMENT or (start and token.type == tokenize.STRING):
                said.append(token.string)
            else:
                words.update(re.findall(r"\w+", token.string))
            if token.type not in (tokenize.COMMENT, tokenize.NL):
                start = token.type in BETWEEN
    return "\n".join(said), frozenset(words)


def prose(path: Path) -> str:
    """Return what a file says to people."""
    if path.suffix == ".md":
        return re.sub(r"^```.*?^```", "", path.read_text(encoding="utf-8"), flags=re.M | re.S)
    return parted(path)[0]


def dotted(text: str) -> set[str]:
    """Return the dotted names of a text: those between back-quotes, and full ones anywhere."""
    quoted = re.findall(r"`([A-Za-z_]\w*(?:\.\w+)+)(?:\([^`]*\))?`", text)
    full = re.findall(rf"(?<![`\w/.-])((?:{'|'.join(PACKAGES)})(?:\.\w+)+)", text)
    return {name for name in (*quoted, *full) if name.rpartition(".")[2] not in FILES}


@cache
def modules() -> dict[str, list[str]]:
    """Return the full names of all modules by their last part."""
    found: dict[str, list[str]] = {}
    for path in SOURCES:
        parts = path.relative_to(ROOT).with_suffix("").parts
        parts = parts[:-1] if parts[-1] == "__init__" else parts
        if parts[0] in PACKAGES:
            found.setdefault(parts[-1], []).append(".".join(parts))
    return found


@cache
def classes() -> dict[str, list[str]]:
    """Return the modules that define a class, by its name."""
    found: dict[str, list[str]] = {}
    for path in SOURCES:
        name = ".".join(path.relative_to(ROOT).with_suffix("").parts)
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef) and name.split(".")[0] in PACKAGES:
                found.setdefault(node.name, []).append(name)
    return found


def has(thing: object, names: list[str]) -> bool:
    """Tell whether a thing has an attribute that has an attribute, and so on."""
    for place, name in enumerate(names):
        if not hasattr(thing, name):
            # A field without a default is known to its class by its annotation only.
            return place == len(names) - 1 and name in getattr(thing, "__annotations__", {})
        thing = getattr(thing, name)
    return True


@cache
def importable(name: str) -> bool:
    """Tell whether a full dotted name is that of a module, or of something in one."""
    parts = name.split(".")
    for count in range(len(parts), 0, -1):
        try:
            spec = importlib.util.find_spec(".".join(parts[:count]))
        except ModuleNotFoundError:
            continue
        if spec is not None:
            rest = parts[count:]
            return not rest or has(importlib.import_module(".".join(parts[:count])), rest)
    return False


def exists(name: str) -> bool:
    """Tell whether a dotted name is right: in full, from a module's or room's name, or a class's.

    `rounds.find_round_facets` is right where some module called rounds has that function.  The
    structs of the C runtime count as classes.
    """
    head, _, rest = name.partition(".")
    if rest == "py":
        return head in modules()
    if head in PACKAGES:
        return importable(name)
    homes = [f"{module}.{rest}" for module in modules().get(head, [])]
    homes += [f"{module}.{name}" for module in classes().get(head, [])]
    if re.fullmatch(r"smap_\w*t", head):
        header = (ROOT / "firmware_export/runtime/smap.h").read_text(encoding="utf-8")
        struct = re.search(rf"\{{([^}}]*)\}} {head};", header)
        return struct is not None and re.search(rf"\b{rest}\b", struct[1]) is not None
    return any(map(importable, homes)) if homes else importable(name)


# The changelog says what names were before.
PRESENT = [page for page in DOCUMENTS if page.name != "CHANGELOG.md"]


@pytest.mark.parametrize("path", [*SOURCES, *PRESENT], ids=lambda path: str(path.relative_to(ROOT)))
def test_every_dotted_name_that_a_file_mentions_is_there(path: Path) -> None:
    # A page may also name what stands in its own examples.
    shown = fenced(path.read_text(encoding="utf-8")) if path.suffix == ".md" else ""
    names = [name for name in sorted(dotted(prose(path))) if name not in shown]
    assert [name for name in names if not exists(name)] == []


@pytest.mark.parametrize(
    ("name", "there"),
    [
        ("lutgen.sweep", True),
        ("lutgen.search", True),
        ("lutgen.support.find_the_facets", False),
        ("lutgen.statics.diagnose", False),
        ("rounds.py", True),
        ("urdf_text.py", False),
        ("rounds.find_round_facets", True),
        ("rounds.find_feet", False),
        ("hull.find_facets", False),
        ("StabilityMap.read", True),
        ("StabilityMap.write", False),
        ("Axis.knots", True),
        ("smap_reading_i_t.tip", True),
        ("smap_reading_i_t.top", False),
        ("os.fsync", True),
        ("limits_of.anything", False),
    ],
)
def test_a_name_that_is_gone_is_found(name: str, there: bool) -> None:
    assert exists(name) is there


@cache
def identifiers() -> frozenset[str]:
    """Return every word of the programs: names, words of their texts, files, and recipes."""
    words: set[str] = set()
    for path in SOURCES:
        words.update(path.relative_to(ROOT).with_suffix("").parts, parted(path)[1])
    for pattern in (*(f"{folder}/**/*.[chS]" for folder in PACKAGES), "maps/*.toml", "Makefile"):
        for path in ROOT.glob(pattern):
            words.update(re.findall(r"\w+", path.read_text(encoding="utf-8")))
    return frozenset(words)


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_word_that_a_comment_quotes_occurs_in_the_programs(path: Path) -> None:
    quoted = set(re.findall(r"`([A-Za-z_]\w*)`", prose(path)))
    assert sorted(quoted - identifiers()) == []


def test_a_module_that_is_gone_is_no_word_of_the_programs() -> None:
    # Put together, so that they are not words of this file.
    assert not {"errata_" + "geometry", "contacts_" + "fit", "grid_" + "outline"} & identifiers()
    assert {"fit", "proposal_text", "smap_read_i", "upright"} <= identifiers()


def test_the_product_imports_nothing_from_the_tests() -> None:
    for path in SOURCES:
        if path.relative_to(ROOT).parts[0] in ("lutgen", "firmware_export"):
            text = path.read_text(encoding="utf-8")
            assert not re.search(r"^\s*(from|import) tests\b", text, re.MULTILINE), path


def test_the_reader_of_prose_finds_docstrings_and_comments() -> None:
    text = prose(ROOT / "lutgen" / "files.py")
    assert "Owns the marks" in text
    assert "import csv" not in text

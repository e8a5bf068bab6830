"""The tree of pages.  Owns how docs/README.md, a list for people, becomes Sphinx's toctrees.

Each heading of the second level of that page is a part of the site, and each item of its lists
that begins with a link is a page of it.  The comment ``<!-- made: NAME TITLE; ... -->`` stands for
pages that have no file and come from the sources.
"""

import re
from dataclasses import dataclass
from pathlib import PurePosixPath

__all__ = ["HOME", "Part", "home", "parts"]

# Where the list for people is, and the name under which the site has it.
HOME = "docs/README.md"
_ITEM = re.compile(r"^(?:-|\d+\.) \[([^]]+)\]\(([^)#]+)\)")
_MADE = re.compile(r"^<!-- made: (.+) -->$", re.MULTILINE)


@dataclass(frozen=True)
class Part:
    """A part of the site: its heading and its pages, as (title, path from the project's root)."""

    title: str
    pages: tuple[tuple[str, str], ...]


def _normal(path: str) -> str:
    """Return a path relative to docs/ as one from the root, without ``..``."""
    found: list[str] = []
    for step in PurePosixPath("docs", path).parts:
        if step == "..":
            found.pop()
        else:
            found.append(step)
    return "/".join(found)


def _with_made(text: str) -> str:
    """Return the list with an item for every page that is made."""

    def items(match: re.Match[str]) -> str:
        pairs = (one.strip().split(" ", 1) for one in match[1].split(";"))
        return "\n".join(f"- [{title}]({path})" for path, title in pairs)

    return _MADE.sub(items, text)


def parts(text: str) -> list[Part]:
    """Return the parts of the site in the order of docs/README.md."""
    found = []
    for section in re.split(r"^## ", _with_made(text), flags=re.MULTILINE)[1:]:
        title, _, rest = section.partition("\n")
        pages = tuple(
            (match[1], _normal(match[2]))
            for line in rest.splitlines()
            if (match := _ITEM.match(line))
        )
        if pages:
            found.append(Part(title, pages))
    return found


def home(text: str) -> str:
    """Return the site's first page: the list for people, and the tree of pages out of sight.

    A notebook is a page there, too.
    """
    shown = re.sub(
        r"\]\(([^)#:]+)(#[^)]*)?\)",
        lambda match: f"]({_normal(match[1])}{match[2] or ''})",
        _with_made(text),
    )
    # What Sphinx makes of all of them, which has no file either.
    trees = ["```{toctree}\n:hidden:\n\nIndex <genindex>\n```\n"]
    for part in parts(text):
        pages = "\n".join(
            f"{title} <{path.replace('.ipynb', '.md')}>" for title, path in part.pages
        )
        trees.append(f"```{{toctree}}\n:hidden:\n:caption: {part.title}\n\n{pages}\n```\n")
    return "\n".join([shown, *trees])

"""The folder that Sphinx reads.  Owns which files go into it, and what is rewritten on the way.

A page keeps its place relative to the project's root, so that its links stay as they are on a git
host.  A file that a page links to and that is no page comes along, and is offered as a download.
"""

import re
import shutil
from collections.abc import Callable
from pathlib import Path

from tools.site import c_page, command_page, notebooks, python_page
from tools.site.navigation import HOME, home

__all__ = ["Stage"]

_LINK = re.compile(r"(?:\]\(|<img src=\")([^)#:\"\s]+)")
# An image with a width, as a git host takes it.
_IMAGE = re.compile(r'<img src="([^"]+)" width="([^"]+)" alt="([^"]+)"[^>]*>')
# Pages that have no file; their names are in the comment of docs/README.md.
_MADE: dict[str, Callable[[], str]] = {
    "docs/reference/commands.md": command_page.page,
    "docs/reference/python.md": python_page.page,
    "docs/reference/c.md": c_page.page,
}
_GLOSSARY = "docs/reference/glossary.md"
_EXPLORERS = "maps/explorers.md"


class Stage:
    """The folder in the making.

    Parameters
    ----------
    root : pathlib.Path
        The project.
    target : pathlib.Path
        The folder; what lies in it and is not written again is removed.
    explorers : pathlib.Path
        Where `make explorer` puts its pages; it need not be there.
    """

    def __init__(self, root: Path, target: Path, explorers: Path) -> None:
        self.root, self.target, self.explorers = root, target, explorers
        self._written: set[Path] = set()

    def fill(self) -> None:
        """Write every page and what belongs to it."""
        pages = [
            *self.root.glob("*.md"),
            *self.root.glob("docs/**/*.md"),
            self.root / "maps/README.md",
        ]
        for page in sorted(pages):
            name = page.relative_to(self.root).as_posix()
            self._page("index.md" if name == HOME else name, page)
        for notebook in sorted(self.root.glob("docs/notebooks/*.ipynb")):
            self._notebook(notebook)
        for name, page_of in _MADE.items():
            self._text(name, page_of())
        self._text(_EXPLORERS, self._list_of_explorers())
        for path in [*self.target.rglob("*")]:
            if path.is_file() and path not in self._written:
                path.unlink()

    def _text(self, name: str, text: str) -> None:
        """Write a page, unless it is there as it is: Sphinx reads again what is new."""
        path = self.target / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
        self._written.add(path)

    def _page(self, name: str, page: Path) -> None:
        """Write a page of the project, and the files that it links to."""
        text = page.read_text(encoding="utf-8")
        for target in _LINK.findall(text):
            linked = (page.parent / target).resolve()
            if linked.suffix != ".md" and linked.suffix != ".ipynb" and linked.is_file():
                self._copy(linked)
        if name == "index.md":
            text = home(text)
        elif name == _GLOSSARY:
            text = _glossary(text)
        text = re.sub(r"(\]\([^)\s]*)\.ipynb\)", r"\1.md)", text)
        text = text.replace("```csv\n", "```text\n")  # which no lexer colours
        text = _IMAGE.sub(r'![\3](\1){width="\2"}', text)
        up = "../" * name.count("/")
        text = re.sub(
            r"\]\((?:\.\./)*(?:docs/)?README\.md\)", lambda m: _homeward(m[0], name, up), text
        )
        self._text(name, text)

    def _copy(self, file: Path) -> None:
        """Copy a file that a page links to."""
        path = self.target / file.relative_to(self.root)
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.is_file() or path.read_bytes() != file.read_bytes():
            shutil.copy(file, path)
        self._written.add(path)

    def _notebook(self, notebook: Path) -> None:
        """Run a notebook and write it as a page, if it or the packages are newer than the page."""
        page = (self.target / notebook.relative_to(self.root)).with_suffix(".md")
        sources = [notebook, *(self.root / "lutgen").rglob("*.py")]
        sources += (self.root / "firmware_export").rglob("*.[pch]*")
        newest = max(
            path.stat().st_mtime for path in sources if path.suffix in {".ipynb", ".py", ".c", ".h"}
        )
        if not page.is_file() or page.stat().st_mtime < newest:
            folder = self.target.parent / "notebooks" / notebook.stem
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)
            notebooks.written(notebooks.ran(notebook, folder), page)
        self._written.update([page, *page.parent.glob(f"{page.stem}_*.png")])

    def _list_of_explorers(self) -> str:
        """Return the page that leads to the explorers that have been made."""
        names = sorted(path.stem for path in self.explorers.glob("*.html"))
        head = "# Move a robot by hand\n\nEach page is an [explorer](../docs/guide/explorer.md)"
        if not names:
            return f"{head} of a robot; `make explorer docs` puts them here. None is made yet.\n"
        rows = "\n".join(f'- <a href="../explorer/{name}.html">{name}</a>' for name in names)
        return f"{head} of a robot of the [gallery](README.md).\n\n{rows}\n"


def _homeward(link: str, name: str, up: str) -> str:
    """Return a link to a README, to the first page if it is the one of docs/ that it leads to."""
    path = link[2:-1]
    steps = [*name.split("/")[:-1]]
    for step in path.split("/"):
        if step == "..":
            steps.pop()
        else:
            steps.append(step)
    return f"]({up}index.md)" if "/".join(steps) == HOME else link


def _glossary(text: str) -> str:
    """Return the glossary with its list as Sphinx has it: every term in the index, and a target."""
    head, *entries = re.split(r"^- \*\*", text, flags=re.MULTILINE)
    blocks = []
    for entry in entries:
        term, said = entry.split("**: ", 1)
        names = "\n".join(term.split(", "))
        lines = "\n".join(f"   {line.strip()}" for line in said.strip().splitlines())
        blocks.append(f"{names}\n{lines}")
    body = "\n\n".join(blocks)
    return f"{head}```{{glossary}}\n:sorted:\n\n{body}\n```\n" if entries else text

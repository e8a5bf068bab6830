"""Settings of Sphinx for the site of the documents; `make docs` takes warnings for errors.

The source folder is the project itself, so links lead where they lead on a git host.
"""

import re
import shutil
from pathlib import Path

import click
from pygments.lexers.special import TextLexer

import lutgen

ROOT = Path(__file__).resolve().parent.parent
EXPLORERS = ROOT / "build" / "explorer"
COMMENT = r"(?:/\*((?:[^*]|\*(?!/))*)\*/\n)?"
FUNCTION = re.compile(COMMENT + r"static inline (\w+ \w+\([^{]*\))\n\{")

project = "lutgen"
author = project_copyright = "The lutgen authors"
version = release = lutgen.__version__
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_click"]
root_doc = "docs/README"
include_patterns = ["*.md", "docs/**", "maps/README.md"]
exclude_patterns = [".*", "build", "lutgen", "firmware_export", "tests", "proofs", "targets"]

myst_enable_extensions = ["html_image"]
myst_heading_anchors = 4
nb_execution_mode = "auto"  # a notebook is checked in without outputs
nb_execution_in_temp = nb_execution_raise_on_error = True
nb_execution_timeout = 600
napoleon_google_docstring = napoleon_use_rtype = False
autodoc_typehints = "none"
autodoc_member_order = "bysource"
default_role = "code"  # single back-quotes of a docstring
smartquotes = False
html_theme = "furo"
html_title = f"lutgen {release}"
html_show_sphinx = html_copy_source = False
html_theme_options = {"top_of_page_buttons": []}


def escape(app, *given):
    """Escape bars of a docstring, and stars of a help text, in place."""
    lines, marks = given[-1], r"(?<!^)([|*])" if isinstance(given[0], click.Context) else r"([|])"
    for place, line in enumerate(lines):
        pieces = re.split(r"(`[^`]*`)", line)
        pieces[::2] = [re.sub(marks, r"\\\1", piece) for piece in pieces[::2]]
        lines[place] = "".join(pieces)


def trees(text):
    """Return docs/README.md with a hidden tree for each of its lists."""
    found = []
    for section in text.split("\n## ")[1:]:
        pages = re.findall(r"^(?:-|\d+\.) \[([^]]+)\]\(([^)#]+)\.\w+\)", section, re.MULTILINE)
        listed = "\n".join(f"{title} <{path}>" for title, path in pages)
        title = section.partition("\n")[0]
        found.append(f"```{{toctree}}\n:hidden:\n:caption: {title}\n\n{listed}\n```\n")
    return "\n".join([text, *found, "```{toctree}\n:hidden:\n\nIndex </genindex>\n```\n"])


def glossary(text):
    """Return the glossary as Sphinx has it: every term in the index, and a target."""
    head, *entries = re.split(r"^- \*\*", text, flags=re.MULTILINE)
    blocks = []
    for term, said in (entry.split("**: ", 1) for entry in entries):
        blocks.append(term.replace(", ", "\n") + "\n   " + " ".join(said.split()))
    return head + "```{glossary}\n:sorted:\n\n" + "\n\n".join(blocks) + "\n```\n"


def functions(match):
    """Return the functions of a header of C, each with the comment before it."""
    text, found = (ROOT / match[1]).read_text("utf-8"), []
    for comment, declared in FUNCTION.findall(text):
        said = re.sub(r"\n \*", "\n", "" if comment.lstrip().startswith("--") else comment)
        said = re.sub(r"([*|_])", r"\\\1", " ".join(said.split()))
        found.append(f".. c:function:: {' '.join(declared.split())}\n\n   {said}\n")
    return "\n".join(found)


def read(app, name, source):
    """Write into a page what is read off other files."""
    if name == root_doc:
        source[0] = trees(source[0])
    elif name == "docs/reference/glossary":
        source[0] = glossary(source[0])
    elif name == "docs/reference/c":
        source[0] = re.sub(r"^\.\. functions:: (\S+)$", functions, source[0], flags=re.MULTILINE)
    elif name == "maps/README" and EXPLORERS.is_dir():
        pages = [page.name for page in sorted(EXPLORERS.glob("*.html"))]
        links = "\n".join(f'- <a href="../explorer/{page}">{page}</a>' for page in pages)
        source[0] += f"\n## Robots moved by hand\n\n{links}\n"


def finish(app, error):
    """Put the explorers beside the pages, and a first page at the top."""
    (app.outdir / "index.html").write_text(
        '<!doctype html><meta charset="utf-8"><title>lutgen</title>'
        '<meta http-equiv="refresh" content="0; url=docs/README.html">'
        '<a href="docs/README.html">Documentation of lutgen</a>'
    )
    if EXPLORERS.is_dir():
        shutil.copytree(EXPLORERS, app.outdir / "explorer", dirs_exist_ok=True)


def setup(app):
    """Connect all of this."""
    app.add_lexer("csv", TextLexer)
    app.connect("source-read", read)
    app.connect("autodoc-process-docstring", escape)
    for part in ("description", "options"):
        app.connect(f"sphinx-click-process-{part}", escape)
    app.connect("build-finished", finish)

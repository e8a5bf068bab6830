"""Settings of Sphinx for the site; it runs with warnings taken for errors."""

import re
from typing import Any

import lutgen

project = "lutgen"
author = "The lutgen developers"
project_copyright = "The lutgen authors"
version = release = lutgen.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
myst_enable_extensions = ["attrs_inline"]
# Links to a heading are those of a git host.
myst_heading_anchors = 4
# Pages begin with the first level everywhere but in what is read off the sources.
napoleon_google_docstring = False
napoleon_use_rtype = False
autodoc_typehints = "none"
autodoc_member_order = "bysource"
# What stands between single back-quotes of a docstring is a name.
default_role = "code"

html_theme = "furo"
html_title = f"lutgen {release}"
html_show_sphinx = False
# The site works from a disk and says nothing to anybody: no fonts, scripts or counters of others.
html_copy_source = False
html_theme_options = {"top_of_page_buttons": []}


def _absolute_values(app: Any, what: str, name: str, thing: Any, options: Any, lines: Any) -> None:
    """Escape the bars of |SD_g| in a docstring, which would be a substitution."""
    for place, line in enumerate(lines):
        pieces = re.split(r"(`[^`]*`)", line)
        pieces[::2] = [piece.replace("|", r"\|") for piece in pieces[::2]]
        lines[place] = "".join(pieces)


def setup(app: Any) -> None:
    """Connect what is done to docstrings."""
    app.connect("autodoc-process-docstring", _absolute_values)

"""The site: the pages of docs/, and beside them what the sources say about themselves.

The pages of docs/ are the only text there is; a git host shows them as they are.  `make docs`
copies them into build/site-source, writes the pages of reference that have no file (commands,
Python, C), runs the notebooks, and has Sphinx make build/site of all that.

Sphinx, and not MkDocs, because the reference is half of the site: it knows Python's docstrings,
C and the options of commands, and makes one index of all of them and of the glossary.  Its parser
of Markdown takes the pages as they are.

In reading order: `navigation` (docs/README.md as the tree of pages), `command_page`, `python_page`,
`c_page` (the reference that is read off the sources), `notebooks` (runs them and writes them as
pages), `staging` (the folder that Sphinx reads), `conf` (Sphinx's settings), `__main__`.
"""

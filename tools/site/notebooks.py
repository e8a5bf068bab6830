"""Notebooks: runs the code of one as it stands, and writes it as a page with what came out.

The notebooks that are checked in hold no outputs, so none can be out of date.  They are plain
Python without the magics of Jupyter: a cell runs as in any interpreter, the value of its last line
is shown, and so is every figure that it leaves open.
"""

import ast
import contextlib
import io
import json
import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

__all__ = ["Cell", "ran", "written"]


@dataclass
class Cell:
    """A cell: whether it is code, its text, what it printed or returned, and its figures (PNG)."""

    code: bool
    text: str
    said: str = ""
    figures: list[bytes] = field(default_factory=list)


def _cells(notebook: Path) -> list[Cell]:
    """Return the cells of a notebook."""
    content = json.loads(notebook.read_text(encoding="utf-8"))
    return [Cell(cell["cell_type"] == "code", "".join(cell["source"])) for cell in content["cells"]]


def _figures(value: Any) -> Iterator[bytes]:
    """Yield the figures that are open, and close them; and a cell's value if it is one."""
    from matplotlib import pyplot

    shown = [pyplot.figure(number) for number in pyplot.get_fignums()]
    if hasattr(value, "savefig") and value not in shown:
        shown.append(value)
    for figure in shown:
        file = io.BytesIO()
        figure.savefig(file, format="png", dpi=144, bbox_inches="tight")
        yield file.getvalue()
    pyplot.close("all")


def _run(cell: Cell, names: dict[str, Any], where: str) -> None:
    """Run one cell in the names of those before it."""
    tree = ast.parse(cell.text, where)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(tree, where, "exec"), names)
        value = last and eval(compile(ast.Expression(last.value), where, "eval"), names)
        if value is not None and not hasattr(value, "savefig"):
            print(repr(value))
    cell.said = printed.getvalue()
    cell.figures = list(_figures(value))


def ran(notebook: Path, folder: Path) -> list[Cell]:
    """Return the cells of a notebook after running them in a folder, which its files go into."""
    import matplotlib

    matplotlib.use("agg")
    cells = _cells(notebook)
    names: dict[str, Any] = {"__name__": "__main__"}
    before = Path.cwd()
    os.chdir(folder)
    try:
        for number, cell in enumerate(cells, 1):
            if cell.code:
                _run(cell, names, f"{notebook.name}, cell {number}")
    finally:
        os.chdir(before)
    return cells


def written(cells: list[Cell], page: Path) -> None:
    """Write cells that have run as a page, and their figures beside it."""
    page.parent.mkdir(parents=True, exist_ok=True)
    pieces = []
    for number, cell in enumerate(cells, 1):
        pieces.append(f"```python\n{cell.text}\n```" if cell.code else cell.text)
        if cell.said:
            pieces.append(f"```text\n{cell.said.rstrip()}\n```")
        for count, figure in enumerate(cell.figures):
            image = page.with_name(f"{page.stem}_{number}_{count}.png")
            image.write_bytes(figure)
            pieces.append(f"![Figure of the cell above]({image.name})")
    page.write_text("\n\n".join(pieces) + "\n", encoding="utf-8")

"""`lutgen paper`: everything in one folder, and one page that shows it.

Owns the folder; the words of the page are in `page.md.in`.
"""

import os
import shutil
import tempfile
import time
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path

from lutgen.errors import InputError
from lutgen.files import csv_text, write_text
from lutgen.paper import manifest
from lutgen.paper.numbers import page_numbers
from lutgen.paper.page import Picture, render
from lutgen.paper.page_tables import page_tables
from lutgen.paper.pictures import draw_pictures
from lutgen.paper.results import MAP, Results, compute
from lutgen.paper.tables import tables

PAGE = "paper.html"
TEMPLATE = files(__package__).joinpath("page.md.in").read_text(encoding="utf-8")


def write_report(
    directory: str | os.PathLike[str],
    progress: Callable[[str], None] = lambda _: None,
    force: bool = False,
) -> Path:
    """Compute everything and write page, figures, tables and map into a folder.

    Parameters
    ----------
    directory : path
        Made if it is not there.  Files of an earlier report are replaced, as far as its list
        (`manifest`) knows them; others stay.
    progress : callable
        Is told what is being done.
    force : bool
        Whether files that lutgen did not make, or that were edited, may be replaced.

    Returns
    -------
    pathlib.Path
        The page.

    Raises
    ------
    InputError
        Where the folder cannot be written, or a file of the report would replace another's.
    """
    begin = time.perf_counter()
    target = Path(directory)
    if not force:
        manifest.check(target, (PAGE, MAP))
    try:
        target.mkdir(parents=True, exist_ok=True)
        # Everything appears at once, or not at all.
        work = Path(tempfile.mkdtemp(prefix=".paper.", dir=target))
    except OSError as error:
        raise InputError(
            f"{target}: cannot be made a folder of results (got {error.strerror or error}); "
            "choose another path"
        ) from error
    try:
        results = compute(work, progress)
        progress("figures")
        pictures = draw_pictures(work, results)
        for name, (head, rows) in tables(results).items():
            write_text(work / name, csv_text(head, rows))
        write_text(work / PAGE, build_page(results, pictures, time.perf_counter() - begin))
        made = sorted(path.name for path in work.iterdir())
        if not force:
            manifest.check(target, made)
        write_text(work / manifest.NAME, manifest.text(work, made))
        # The list last, so that it never names what is not there yet.
        for name in (*made, manifest.NAME):
            (work / name).replace(target / name)
    except OSError as error:
        raise InputError(
            f"{target}: the report cannot be written (got {error.strerror or error}); "
            "choose a folder with room"
        ) from error
    finally:
        shutil.rmtree(work, ignore_errors=True)
    return target / PAGE


def build_page(results: Results, pictures: dict[str, Picture], seconds: float) -> str:
    """Return the page: the template with its numbers, tables and pictures."""
    filled = TEMPLATE.format_map(page_numbers(results, seconds))
    return render(filled, pictures, page_tables(results))

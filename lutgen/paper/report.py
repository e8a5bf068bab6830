"""`lutgen paper`: everything in one folder, and one page that shows it.

Owns the folder and the order of the page.
"""

import os
import shutil
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from lutgen._version import __version__
from lutgen.errors import InputError
from lutgen.files import csv_text, write_text
from lutgen.paper.page import Page
from lutgen.paper.pictures import Picture, draw_pictures
from lutgen.paper.results import MAP, Results, compute
from lutgen.paper.sections import introduction, simulation_one, simulation_three, simulation_two
from lutgen.paper.sections_checks import errata_section, forces_section, omitted_section
from lutgen.paper.tables import tables

__all__ = ["PAGE", "build_page", "write_report"]

PAGE = "paper.html"


def write_report(
    directory: str | os.PathLike[str], progress: Callable[[str], None] = lambda _: None
) -> Path:
    """Compute everything and write page, figures, tables and map into a folder.

    Parameters
    ----------
    directory : path
        Made if it is not there.  Files of an earlier report are replaced; others stay.
    progress : callable
        Is told what is being done.

    Returns
    -------
    pathlib.Path
        The page.

    Raises
    ------
    InputError
        Where the folder cannot be written.
    """
    begin = time.perf_counter()
    target = Path(directory)
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
        pictures = draw_pictures(work, results.first, results.second, results.swept, results.third)
        for name, (head, rows) in tables(results).items():
            write_text(work / name, csv_text(head, rows))
        page = build_page(results, pictures, lambda: time.perf_counter() - begin)
        write_text(work / PAGE, page.text())
        for made in sorted(work.iterdir()):
            made.replace(target / made.name)
    except OSError as error:
        raise InputError(
            f"{target}: the report cannot be written (got {error.strerror or error}); "
            "choose a folder with room"
        ) from error
    finally:
        shutil.rmtree(work, ignore_errors=True)
    return target / PAGE


def build_page(
    results: Results, pictures: dict[str, Picture], elapsed: Callable[[], float]
) -> Page:
    """Return the page."""
    page = Page("Variable robot geometry against tip-over: the paper's simulations, computed again")

    def show(*stems: str) -> None:
        for stem in stems:
            each = pictures[stem]
            page.picture(each.path, f"{each.number}: {each.caption}.", each.width)

    introduction(page, show)
    simulation_one(page, results, show)
    simulation_two(page, results, show)
    simulation_three(page, results, show)
    errata_section(page, results)
    forces_section(page)
    omitted_section(page)
    page.heading("How this page was made", "made")
    page.paragraph(
        f"lutgen {__version__} computed and drew everything on this page in {elapsed():.0f} "
        "seconds; `lutgen paper -o DIR` does it again.  Beside it stand the figures, the numbers "
        f"as CSV, and the map as HDF5 ({MAP})."
    )
    return page

"""`lutgen paper`: everything in one folder, and one page that shows it."""

import base64
import logging
import math
import os
import tempfile
import time
from functools import partial
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from lutgen import plot
from lutgen._version import __version__
from lutgen.errors import InputError
from lutgen.files import check_target, csv_text, write_text
from lutgen.mapping import load_map
from lutgen.paper.model import DOWN, NOMINAL, RADIUS, TABLE, paper_recipe
from lutgen.paper.simulations import MAP, Results, compute, second_optimum
from lutgen.paper.tables import Table, tables

log = logging.getLogger("lutgen")
PAGE = "paper.html"
UNEVEN = {"alpha": 20.0, "gamma": 40.0}
SLOPE = (-0.3, 0.15, -1.0)
# CSS pixels of an inch of a figure.
PIXELS = 80.0
# Every how many points of the curve stand on the page.
CURVE_EVERY = 50


def write_report(directory: str | os.PathLike[str], force: bool = False) -> Path:
    """Compute everything, write page, figures, tables and map into a folder; return the page.

    The folder is made if it is not there.  Refused if it cannot be written, or, without `force`, if
    a file of the report would replace one that lutgen did not make.
    """
    begin = time.perf_counter()
    target = Path(directory)
    for name in (PAGE, MAP):
        check_target(target / name, force)
    try:
        target.mkdir(parents=True, exist_ok=True)
        # Everything appears at once, or not at all.
        with tempfile.TemporaryDirectory(prefix=".paper.", dir=target) as place:
            work = Path(place)
            results = compute(work)
            log.info("figures")
            widths = draw_figures(work, results)
            found = tables(results)
            for name, table in found.items():
                write_text(work / f"{name}.csv", _csv(table))
            page = build_page(work, results, found, widths, time.perf_counter() - begin)
            write_text(work / PAGE, page)
            made = sorted(work.iterdir())
            for path in made:
                check_target(target / path.name, force, path.read_bytes())
            for path in made:
                path.replace(target / path.name)
    except OSError as error:
        raise InputError(
            f"{target}: the report cannot be written (got {error.strerror or error}); "
            "choose a folder that exists and has room."
        ) from error
    return target / PAGE


def _csv(table: Table) -> str:
    """Return a table as CSV, without the marks of HTML."""
    rows = (
        [cell.striptags() if isinstance(cell, Markup) else cell for cell in row]
        for row in table.rows
    )
    return csv_text([column.key for column in table.columns], rows)


def draw_figures(folder: Path, results: Results) -> dict[str, int]:
    """Draw all figures as PNG into a folder; return the width (CSS pixels) of each by its stem."""
    stability_map = load_map(folder / MAP)
    one, two, third = paper_recipe("paper_one"), paper_recipe(), results.third
    search = results.second["plane", "search"]
    runs = {"without control": third["fixed"], "with control": third["lagged"]}
    robot, curve = partial(plot.draw, "robot"), partial(plot.draw, "curve", channel="sdg")
    contour = partial(plot.draw, "contour", channel="sdg")
    steps = partial(plot.draw_steps, two, search, DOWN)
    painters = {
        "fig05_support": partial(robot, two, params=UNEVEN, gravity=SLOPE),
        # As printed: at the exact angle |SD_g| would be rounding noise.
        "fig07_robot": partial(robot, one, params={"alpha": 30.964}),
        "fig08_curve": partial(curve, one, convention="plane"),
        "fig09_robot": partial(robot, two, params=UNEVEN, convention="plane"),
        "fig10_surface": partial(plot.draw, "surface", stability_map, channel="sdg"),
        "fig11_map": partial(contour, stability_map),
        "fig11_plane": partial(contour, two, convention="plane"),
        "fig12_steps": partial(steps, (0, 1, 2)),
        "fig13_step": partial(steps, (0,)),
        "fig14_step": partial(steps, (1,)),
        "fig15_step": partial(steps, (2,)),
        "fig15_last": partial(steps, (5,)),
        "fig16_17_path": partial(plot.draw_path, two, runs),
    }
    widths = {}
    for stem, paint in painters.items():
        figure = paint()
        plot.save(figure, folder / f"{stem}.png")
        widths[stem] = round(PIXELS * figure.get_figwidth())
    return widths


def build_page(
    folder: Path,
    results: Results,
    found: dict[str, Table],
    widths: dict[str, int],
    seconds: float,
) -> str:
    """Return the page: the template with its numbers, its tables and the figures of a folder."""
    environment = Environment(
        loader=PackageLoader("lutgen.paper", "."),
        autoescape=True,
        trim_blocks=True,
        undefined=StrictUndefined,
    )
    environment.filters["f"] = shown
    curve = found["fig08_curve"]
    few = Table(curve.columns, curve.rows[::CURVE_EVERY])
    pictures = {
        stem: (width, base64.b64encode((folder / f"{stem}.png").read_bytes()).decode("ascii"))
        for stem, width in widths.items()
    }
    return environment.get_template("page.html.j2").render(
        page_numbers(results, found["forces"]),
        seconds=seconds,
        tables={**found, "fig08_curve": few},
        pictures=pictures,
    )


def shown(value: object, spec: str) -> str:
    """Return a cell or a number of the page as HTML: 1.5e-07 is 1.5 times a power of ten."""
    if value is None:
        return "\N{EN DASH}"
    if isinstance(value, str):
        return value
    text = format(value, spec).replace("-", "\N{MINUS SIGN}")
    mantissa, mark, power = text.partition("e")
    if not mark:
        return text
    return Markup(f"{mantissa}&middot;10<sup>{power.removeprefix('+').replace('0', '', 1)}</sup>")


def page_numbers(results: Results, forces: Table) -> dict[str, Any]:
    """Return the numbers of the page's prose by the names that its template gives them."""
    values, _ = results.table["plane"]
    known = [i for i, said in enumerate(TABLE) if said.searching]
    meant = {n: [v[i] / TABLE[i].read_as for i in known] for n, (v, _) in results.table.items()}
    off = [scale * r - 1.0 for name, (_, scale) in results.table.items() for r in meant[name]]
    third, last, first = TABLE[4], TABLE[5], TABLE[3]
    slope = (first.sdg - third.sdg) / (first.alpha - third.alpha)
    faster = 3600.0 / results.swept["file"]
    digit = 10 ** math.floor(math.log10(faster))
    return {
        "radius": RADIUS,
        "nominal_deg": math.degrees(NOMINAL),
        "first_best": {n: math.degrees(at.params[0]) for n, at in results.first.items()},
        "swept": results.swept,
        # Rounded down to one digit: more would be claimed than is known.
        "faster": int(faster // digit * digit),
        "second_optimum": second_optimum(),
        "ratio": [value / said.sdg for value, said in zip(values, TABLE, strict=True)],
        "fitted": {name: RADIUS * scale for name, (_, scale) in results.table.items()},
        "ratio_low": min(meant["plane"]),
        "ratio_high": max(meant["plane"]),
        "worst_percent": 100.0 * max(map(abs, off)),
        "zero_of_line": third.alpha - third.sdg / slope,
        "zero_of_last": last.alpha + last.sdg / slope,
        "both_tips": int(results.third["both"].tips.sum()),
        "turning_tips": int(results.third["turning"].tips.sum()),
        "near_tip": min(forces.rows, key=lambda row: row[2]),
        "version": __version__,
    }

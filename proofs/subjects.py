"""The exports that are proved: of `make maps` those that differ in code, small ones of the rest."""

import re
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from firmware_export.emit import package, report
from firmware_export.protocol.exported import Export
from firmware_export.truth.model import Model
from lutgen.errors import ExportError, InputError
from lutgen.recipe.recipe import parse_recipe
from proofs.exports import coded_export, rover_export, tripod_export
from proofs.recipes import tripod
from targets.noise import noise

__all__ = ["Subject", "mapped", "read_subject", "small"]


def _looked_up(arithmetic: str, name: str) -> Export:
    """Return tables of positions of three contacts, whose facet and walls follow from them."""
    return tripod_export(name, codec="grid", arithmetic=arithmetic)


def _over_gravity(chart: str, name: str) -> Export:
    """Return trained tables over the chart, on one face or six; they mean nothing.

    Bytes of every value are the harder case for a proof, and need no fit.
    """
    model = Model(parse_recipe(tripod(chart=chart)))
    return noise(name, model, (3, 3, 5, 5), ("sdg", "height"))


# Small exports, so that every codec and both kinds of arithmetic are there, all channels and faces.
SMALL: dict[str, Callable[[str], Export]] = {
    "tables_float": partial(_looked_up, "float"),
    "tables_integer": partial(_looked_up, "integer"),
    "grid_integer": partial(_over_gravity, "cone"),
    "grid_sphere_integer": partial(_over_gravity, "sphere"),
    "poly_cone": lambda name: tripod_export(name, codec="poly"),
    "four_wheels": rover_export,
    "legs_by_code": partial(coded_export, robot="legs"),
    "wheels_by_code": partial(coded_export, robot="wheels"),
}
# Of `make maps`: three contacts on a cone and a sphere, rails, and axes that are not parallel.
MAPPED = (
    *("paper_two", "three_leg_sphere", "marv", "absolem", "excavator", "markhor"),
    "articulated",
)


@dataclass(frozen=True)
class Subject:
    """An export: its C name, its folder, and what decides how it is proved.

    `kind` is the part that makes its postures: "points", "series" (points given by code), "poly",
    "tables", "grid" (without floats "tables whole", "grid whole"), "rails" or "search"; `forms`
    are those of a pose that it has, in C.
    """

    name: str
    folder: Path
    params: int
    forms: str
    kind: str

    @property
    def integer(self) -> bool:
        """Whether it has no floats."""
        return self.forms == "SMAP_INTEGER"

    @property
    def source(self) -> str:
        """The text of its smap.c."""
        return (self.folder / "smap.c").read_text(encoding="utf-8")

    def filled(self, template: str) -> str:
        """Return a C template with this export's name, parameters and forms in it."""
        values = {"NAME": self.name, "PARAMS": str(self.params), "INTEGER": str(int(self.integer))}
        values["FORMS"] = f"({self.forms})"
        return re.sub(r"@(\w+)@", lambda found: values[found[1]], template)


# The part that makes postures, by its switch.
KINDS = {
    "SMAP_POINTS": "points",
    "SMAP_POLY": "poly",
    "SMAP_TABLES": "tables",
    "SMAP_GRID": "grid",
    "SMAP_MANY_BY_RAILS": "rails",
    "SMAP_MANY_SEARCH": "search",
}


def read_subject(folder: Path) -> Subject:
    """Return the export in a folder.

    Raises
    ------
    InputError
        It is no folder of ``lutgen export``.
    """
    content = report.load_report(folder)
    settings = (folder / f"{content['name']}.c").read_text(encoding="utf-8")
    on = set(re.findall(r"#define (SMAP_\w+) 1$", settings, re.MULTILINE))
    kind = next(kind for switch, kind in KINDS.items() if switch in on)
    forms = " | ".join(form for form in ("SMAP_FLOAT", "SMAP_INTEGER") if f"{form}S" in on)
    if kind == "points" and "SMAP_SERIES" in on:
        kind = "series"
    if kind in ("tables", "grid") and forms == "SMAP_INTEGER":
        kind = f"{kind} whole"
    return Subject(content["name"], folder.absolute(), len(content["parameters"]), forms, kind)


def mapped(folder: Path) -> list[Subject]:
    """Return the exports of ``make maps`` that differ in their code, by name."""
    found = [folder / name / "firmware" for name in MAPPED]
    return [read_subject(path) for path in found if (path / "smap.h").is_file()]


def small(folder: Path) -> list[Subject]:
    """Make the small exports in a folder and return them."""
    folder.mkdir(parents=True, exist_ok=True)
    result = []
    for name, make in SMALL.items():
        print(f"makes the small export {name}", file=sys.stderr)
        try:
            package.write(make(name), folder / name)
        except InputError as error:
            raise ExportError(str(error)) from error
        result.append(read_subject(folder / name))
    return result

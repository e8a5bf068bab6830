"""The exports that are proved: those of `make maps`, and one small one of each further kind."""

import re
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from firmware_export import package, report
from firmware_export.exported import Export
from lutgen.errors import ExportError, InputError
from tests.exports import rover_export, tripod_export

__all__ = ["Subject", "mapped", "read_subject", "small"]

# Small exports, so that every codec and both kinds of arithmetic are there.
SMALL: dict[str, Callable[[str], Export]] = {
    "grid_float": lambda name: tripod_export(name, codec="grid"),
    "grid_integer": lambda name: tripod_export(name, codec="grid", arithmetic="integer"),
    "poly_cone": lambda name: tripod_export(name, codec="poly"),
    "four_wheels": rover_export,
}


@dataclass(frozen=True)
class Subject:
    """An export: its C name, its folder, and what decides how it is proved.

    `kind` is "grid", "poly", "contacts" or "contacts many"; `integer` tells which of smap_read and
    smap_read_i it has.
    """

    name: str
    folder: Path
    params: int
    integer: bool
    kind: str

    def filled(self, template: str) -> str:
        """Return a C template with this export's name and number of parameters in it."""
        values = {"NAME": self.name, "PARAMS": str(self.params), "INTEGER": str(int(self.integer))}
        return re.sub(r"@(\w+)@", lambda found: values[found[1]], template)


def read_subject(folder: Path) -> Subject:
    """Return the export in a folder.

    Raises
    ------
    InputError
        It is no folder of ``lutgen export``.
    """
    content = report.load(folder)
    settings = (folder / "smap_config.h").read_text(encoding="utf-8")
    many = re.search(r"#define SMAP_CONTACTS_MANY 1", settings) is not None
    codec = str(content["codec"])
    kind = "contacts many" if codec == "contacts" and many else codec
    integer = content["arithmetic"] == "integer"
    return Subject(content["name"], folder.absolute(), len(content["parameters"]), integer, kind)


def mapped(folder: Path) -> list[Subject]:
    """Return the exports of ``make maps``, by name."""
    return [read_subject(path.parent) for path in sorted(folder.glob("*/firmware/smap.h"))]


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

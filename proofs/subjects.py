"""The exports that are proved and fuzzed: of every codec and family, small where that is enough."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from firmware_export.emit import package
from firmware_export.host import family_of
from firmware_export.protocol import Export
from targets.cases import of_recipe, trained
from tests.fixtures.exports import coded_export, rover_export, tripod_export

# Name of a subject: how its export is made.
SUBJECTS: dict[str, Callable[[], Export]] = {
    "paper_two": partial(of_recipe, "paper_two", "contacts"),
    "three_leg_sphere": partial(of_recipe, "three_leg_sphere", "contacts"),
    "legs_by_code": partial(coded_export, "legs_by_code", "legs"),
    "tables_float": partial(tripod_export, "tables_float", "grid"),
    "tables_integer": partial(tripod_export, "tables_integer", "grid", arithmetic="integer"),
    "trained": partial(trained, "trained", "cone"),
    "trained_sphere": partial(trained, "trained_sphere", "sphere"),
    "four_wheels": partial(rover_export, "four_wheels"),
    "wheels_by_code": partial(coded_export, "wheels_by_code", "wheels"),
    "marv": partial(of_recipe, "marv", "contacts"),
    "absolem": partial(of_recipe, "absolem", "contacts"),
    "excavator": partial(of_recipe, "excavator", "contacts"),
    "articulated": partial(of_recipe, "articulated", "contacts"),
    "tractor": partial(of_recipe, "tractor", "contacts"),
}


@dataclass(frozen=True)
class Subject:
    """An export in a folder: its C name, parameters, forms of a pose in C, and family of code."""

    name: str
    folder: Path
    params: int
    forms: str
    family: str

    @property
    def many(self) -> bool:
        """Whether it is of more than three contacts in closed form."""
        return self.family in ("rails", "search")

    @property
    def proved(self) -> bool:
        """Whether Eva proves it: of more contacts only one of two tracks and two rests."""
        return not self.many or self.name == "excavator"

    @property
    def integer(self) -> bool:
        """Whether it has no floats."""
        return self.forms == "SMAP_INTEGER"

    def filled(self, template: str) -> str:
        """Return a C template with this export's name, parameters and forms in it."""
        values = {"NAME": self.name, "PARAMS": str(self.params), "INTEGER": str(int(self.integer))}
        values |= {"FORMS": f"({self.forms})", "MANY": str(int(self.many))}
        return re.sub(r"@(\w+)@", lambda found: values[found[1]], template)


def made(name: str, folder: Path) -> Subject:
    """Make a subject's export below a folder."""
    export = SUBJECTS[name]()
    folder.mkdir(parents=True, exist_ok=True)
    package.write(export, folder / name)
    forms = "SMAP_INTEGER" if export.integer else "SMAP_FLOAT | SMAP_INTEGER"
    family = family_of(export.body.codec, export.integer)
    return Subject(name, (folder / name).absolute(), export.model.k, forms, family)

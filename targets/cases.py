"""The rows of the matrix: robots of every family of code, and the exports of the host's vectors."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from firmware_export.codecs import usable
from firmware_export.emit import package
from firmware_export.grid import lookup
from firmware_export.model import Model
from firmware_export.protocol import Export
from lutgen.quantities import EXPORTABLE
from lutgen.recipe import Recipe, load_recipe, parse_recipe
from lutgen.recipe.gallery import KINDS, start_recipe
from targets.marks import ROOT
from tests.fixtures.exports import noise
from tests.fixtures.frozen import exports
from tests.fixtures.recipes import tripod

BUILD = ROOT / "build" / "targets"
# Four with parallel axes, one with a search for facets, three of three points.
ROBOTS = (
    *("marv", "absolem", "markhor", "excavator", "articulated"),
    *("paper_two", "paper_one", "three_leg_sphere", "legs"),
)
# Codec, arithmetic and size of a table of positions.
TABLES = {
    "float": lookup.Spec(16, ((1, 8), (9, 1), (1, 1))),
    "integer": lookup.Spec(16, ((1, 10), (11, 1), (1, 1))),
}
# Nodes of a trained table, and what it holds beside the angle.
LARGE = ((15, 15, 12, 11), ("sdg",))
# Its pose of 5.5 kB, and a second one on the stack in smap_read, do not fit 8 kB.
WITHOUT = {"absolem": ("avr",)}


@dataclass(frozen=True)
class Case:
    """A row: its name, how its export is made, whether it is counted, and boards without it."""

    name: str
    make: Callable[[], Export]
    counted: bool = True
    without: tuple[str, ...] = ()


def of_robot(
    recipe: Recipe, name: str, codec: str, arithmetic: str = "float", spec: Any = None
) -> Export:
    """Return the export of a robot in a codec, of its smallest size unless one is given."""
    model = Model(recipe)
    channels = tuple(one for one in EXPORTABLE if one in recipe.channels or one == "tip_angle")
    return usable(model, arithmetic, codec)[0].export(model, name, channels, arithmetic, spec)


def of_recipe(name: str, codec: str, arithmetic: str = "float", spec: Any = None) -> Export:
    """Return the export of a recipe in a codec; see `of_robot` and `recipe_of`."""
    return of_robot(recipe_of(name), name, codec, arithmetic, spec)


def trained(name: str, chart: str) -> Export:
    """Return a trained table of all channels whose bytes mean nothing, which is hard to prove."""
    model = Model(parse_recipe(tripod(chart=chart)))
    return noise(name, model, (3, 3, 5, 5), ("sdg", "height"))


def recipe_of(name: str) -> Recipe:
    """Return a recipe of maps/, or one of those that `lutgen new` writes."""
    if name in KINDS:
        return parse_recipe(start_recipe(name))
    return load_recipe(ROOT / "maps" / f"{name}.toml")


def cases() -> list[Case]:
    """Return all rows."""
    rows = [
        Case(name, partial(of_recipe, name, "contacts"), without=WITHOUT.get(name, ()))
        for name in ROBOTS
    ]
    for arithmetic, spec in TABLES.items():
        make = partial(of_recipe, "paper_two", "grid", arithmetic, spec)
        rows.append(Case(f"paper_two_grid_{arithmetic}", make))
    # Bytes that mean nothing: what matters of a trained table is how it is read.
    model = Model(load_recipe(ROOT / "maps" / "paper_two.toml"))
    large = partial(noise, "grid_60kB", model, *LARGE)
    rows.append(Case("grid_60kB", large, without=("avr",)))
    rows += [Case(one.name, partial(_same, one), counted=False) for one in exports()]
    return rows


def _same(export: Export) -> Export:
    return export


def written(case: Case) -> tuple[Export, Path]:
    """Make a row's export and write its folder."""
    export = case.make()
    directory = BUILD / case.name / "firmware"
    directory.parent.mkdir(parents=True, exist_ok=True)
    package.write(export, directory)
    return export, directory

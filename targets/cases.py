"""The rows of the matrix: the exports of `make maps`, small grids, and a table beyond 64 KB.

Owns how a row becomes an `Export` (for the host) and a folder of C with the present runtime.
What takes long to fit is kept in build/targets/tables, by the digest of what it depends on.
"""

import hashlib
import pickle
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from firmware_export.codecs import CODECS, codec, usable
from firmware_export.emit import package, report
from firmware_export.emit.runtime import features, runtime_text
from firmware_export.emit.source import body_of, source_text
from firmware_export.grid import lookup
from firmware_export.grid.spec import Spec
from firmware_export.grid.tables import SPAN, Part, Tables, U, V, places_of
from firmware_export.protocol.exported import Export
from firmware_export.truth.model import Model
from lutgen.errors import ExportError
from lutgen.quantities import EXPORTABLE
from lutgen.recipe.recipe import load_recipe, parse_recipe

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "targets"
MAPS = ROOT / "build" / "maps"
# One robot of each kind of code: the other robots of maps/ run that of `absolem`.
ROBOTS = ("absolem", "paper_one", "paper_two", "three_leg_sphere")
VERDICT = ("tip_angle",)
# What tables depend on: the codecs, and the exact kernels that they ask.
SOURCES = (
    "lutgen/*.py",
    *(f"lutgen/{room}/*.py" for room in ("urdf", "recipe", "support", "channels")),
    *(f"firmware_export/{room}/*.py" for room in ("truth", "protocol")),
    *sorted({f"firmware_export/{info.encode.__module__.split('.')[1]}/*.py" for info in CODECS}),
)

# A stool on three legs: no parameters, so that its tables have the two axes of the chart.
STOOL = """\
[robot]
name = "stool"
length_unit = "m"

[[robot.link]]
name = "body"
mass = 1.0
com = [0.02, 0, 0.1]

[[robot.contact]]
name = "front"
link = "body"
position = [0.3, 0, -0.3]

[[robot.contact]]
name = "left"
link = "body"
position = [-0.2, 0.25, -0.3]

[[robot.contact]]
name = "right"
link = "body"
position = [-0.2, -0.25, -0.3]

[sweep.gravity]
chart = "cone"
max_tilt = 60.0
nodes = 11
channels = ["sdg", "tip_angle", "height"]
"""
STOOL_SPEC = lookup.Spec(8, ((), (), ()))
# A row of the table in docs/measured/exports.md.
FOUR_AXES = lookup.Spec(16, ((1, 8), (8, 1), (1, 1)))


@dataclass(frozen=True)
class Case:
    """One row of the matrix.

    Parameters
    ----------
    name : str
        Of the row.
    make : callable
        Returns the export; it may take long.
    folder : path, optional
        The folder of `make maps` whose tables must be the same.
    """

    name: str
    make: Callable[[], Export]
    folder: Path | None = None


def spec_of(label: str) -> tuple[str, Any]:
    """Return the codec and the size that a report names."""
    name = label.split()[0]
    return name, codec(name).read_label(label)


def encoded(model: Model, name: str, channels: tuple[str, ...], spec: Any) -> Any:
    """Return a codec's tables of one size, from build/targets/tables if they are there."""
    text = repr((model.recipe.digest, name, channels, spec)).encode()
    for pattern in SOURCES:
        for path in sorted(ROOT.glob(pattern)):
            text += path.read_bytes()
    path = BUILD / "tables" / f"{hashlib.sha256(text).hexdigest()[:24]}.pickle"
    if path.is_file():
        return pickle.loads(path.read_bytes())
    tables = usable(model, "float", name)[0].encode(model, channels, spec)
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    part.write_bytes(pickle.dumps(tables))
    part.replace(path)
    return tables


def of_map(name: str) -> Export:
    """Return the export that `make maps` made of a recipe, rebuilt from what its report says."""
    directory = MAPS / name / "firmware"
    if not directory.is_dir():
        raise ExportError(
            f"{directory.relative_to(ROOT)}: is not there (got no folder); run `make maps`."
        )
    content = report.load_report(directory)
    model = Model(load_recipe(ROOT / "maps" / f"{name}.toml"))
    kind, spec = spec_of(content["spec"])
    channels = tuple(channel for channel in EXPORTABLE if channel in content["channels"])
    tables = encoded(model, kind, channels, spec)
    return Export(
        content["name"], model.recipe, model, kind, content["arithmetic"], channels, tables
    )


def of_stool(arithmetic: str) -> Export:
    """Return the tip angle of the stool: one table of two axes."""
    model = Model(parse_recipe(STOOL))
    tables = encoded(model, "grid", VERDICT, STOOL_SPEC)
    return Export("stool", model.recipe, model, "grid", arithmetic, VERDICT, tables)


def of_four_axes(arithmetic: str, channels: tuple[str, ...]) -> Export:
    """Return a grid of the paper's second robot, all of it or its first table alone."""
    model = Model(load_recipe(ROOT / "maps" / "paper_two.toml"))
    tables = encoded(model, "grid", EXPORTABLE, FOUR_AXES)
    tables = replace(tables, channels=channels)
    return Export("four_axes", model.recipe, model, "grid", arithmetic, channels, tables)


def of_noise(arithmetic: str) -> Export:
    """Return 74,529 bytes of codes that mean nothing: what matters is where they lie."""
    model = Model(load_recipe(ROOT / "maps" / "paper_two.toml"))
    shape = (13, 13, 21, 21)
    knots = tuple(np.linspace(0, SPAN, n).round().astype(np.uint16) for n in shape)
    codes = np.random.default_rng(8).integers(0, 256, (1, *shape, 1)).astype(np.uint8)
    offset = np.full(2, -0.5, np.float32)
    part = Part("tip", (0, 1, V, U), knots, codes, offset, np.float32(1.0 / 256.0))
    spec = Spec(8, (("tip", shape),))
    tables = Tables(
        spec, VERDICT, (part,), model.chart_limit, places_of(model), 0.0, "codes that mean nothing"
    )
    return Export("noise", model.recipe, model, "grid", arithmetic, VERDICT, tables)


def cases() -> list[Case]:
    """Return all rows."""
    rows = [Case(name, partial(of_map, name), MAPS / name / "firmware") for name in ROBOTS]
    for arithmetic in ("float", "integer"):
        rows.append(Case(f"grid_2d_{arithmetic}", partial(of_stool, arithmetic)))
        for words, channels in (("4d", VERDICT), ("4d_all", EXPORTABLE)):
            make = partial(of_four_axes, arithmetic, channels)
            rows.append(Case(f"grid_{words}_{arithmetic}", make))
        rows.append(Case(f"grid_74kB_{arithmetic}", partial(of_noise, arithmetic)))
    return rows


def written(case: Case) -> tuple[Export, Path]:
    """Make a row's export and write its folder with the present runtime."""
    export = case.make()
    if case.folder is not None:
        held = (case.folder / f"{export.name}.c").read_text(encoding="utf-8")
        runtime = (case.folder / "smap.c").read_text(encoding="utf-8")
        if runtime != runtime_text(features(body_of(export))):
            print(f"older   {case.name}: `make maps` made it with another runtime", flush=True)
        elif held != source_text(export, body_of(export)):
            raise ExportError(
                f"{case.folder.relative_to(ROOT)}: its tables are not those of its report (got "
                f"another {export.name}.c); run `make maps`."
            )
    directory = BUILD / case.name / "firmware"
    directory.parent.mkdir(parents=True, exist_ok=True)
    package.write(export, directory)
    return export, directory

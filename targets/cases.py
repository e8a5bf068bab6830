"""The rows of the matrix: robots of every kind of code, tables of positions and over gravity.

Owns how a row becomes an `Export` (for the host) and a folder of C with the present runtime.
What takes long to fit is kept in build/targets/tables, by the digest of what it depends on.
"""

import hashlib
import pickle
import threading
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from firmware_export.codecs import CODECS, usable
from firmware_export.emit import package, report
from firmware_export.emit.runtime import features, runtime_text
from firmware_export.emit.source import body_of, source_text
from firmware_export.exporter import proved
from firmware_export.protocol.exported import Export
from firmware_export.truth.model import Model
from lutgen.errors import ExportError
from lutgen.quantities import EXPORTABLE
from lutgen.recipe.recipe import Recipe, load_recipe
from targets.boards import BOARDS
from targets.noise import noise
from targets.quadruped import quadruped

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "targets"
MAPS = ROOT / "build" / "maps"
# Robots whose contacts are computed, one of each kind of code: rails, many of them, rigid wheels,
# axes that are not parallel, three points.
ROBOTS = ("marv", "absolem", "excavator", "articulated", "paper_two", "three_leg_sphere")
# The others of maps/, whose code is that of one of them: counted on one board, for their reports.
COUNTED_ONCE = ("markhor", "paper_one")
# Code of many contacts is larger than all flash of this board.
WITHOUT: dict[str, tuple[str, ...]] = {
    name: ("mega328p",) for name in ("marv", "absolem", "excavator", "articulated", "quadruped")
}
WITHOUT |= {name: tuple(one.name for one in BOARDS if one.name != "m4f") for name in COUNTED_ONCE}
# What tables depend on: the codecs, what they ask of the runtime, and the exact kernels.
SOURCES = (
    "firmware_export/runtime/*.[ch]",
    "lutgen/*.py",
    *(f"lutgen/{room}/*.py" for room in ("urdf", "recipe", "support", "channels")),
    *(f"firmware_export/{room}/*.py" for room in ("truth", "protocol")),
    *sorted({f"firmware_export/{info.encode.__module__.split('.')[1]}/*.py" for info in CODECS}),
)

# A car on four wheels, of fixed shape: its tree has the two axes of the chart, and is folded.
CAR = """\
[robot]
name = "car"
length_unit = "m"

[[robot.link]]
name = "body"
mass = 12.0
com = [0.02, 0, 0.1]

[[robot.contact]]
name = "front left"
link = "body"
position = [0.3, 0.25, -0.1]
radius = 0.1
axis = [0, 1, 0]

[[robot.contact]]
name = "front right"
link = "body"
position = [0.3, -0.25, -0.1]
radius = 0.1
axis = [0, 1, 0]

[[robot.contact]]
name = "rear left"
link = "body"
position = [-0.3, 0.25, -0.1]
radius = 0.1
axis = [0, 1, 0]

[[robot.contact]]
name = "rear right"
link = "body"
position = [-0.3, -0.25, -0.1]
radius = 0.1
axis = [0, 1, 0]

[sweep.gravity]
chart = "cone"
max_tilt = 60.0
nodes = 11
channels = ["tip_angle"]
"""
# Tables beside a tree of 40 kB.
# Sizes of docs/measured/exports.md.
POLY = "poly 0x2 2x0 0x0"
GRIDS = {"float": "grid i16 1x8 9x1 1x1", "integer": "grid i16 1x10 11x1 1x1"}


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
    without : tuple of str
        Boards that it is not run on, as docs/measured/targets.md says.
    """

    name: str
    make: Callable[[], Export]
    folder: Path | None = None
    without: tuple[str, ...] = ()


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
    # Rows that share a size may both be making it.
    part = path.with_suffix(f".{threading.get_ident()}.part")
    part.write_bytes(pickle.dumps(tables))
    part.replace(path)
    return tables


def of_recipe(name: str, kind: str, arithmetic: str = "float", label: str = "") -> Export:
    """Return the export of a recipe of maps/ in a codec; see `of_robot`."""
    return of_robot(load_recipe(ROOT / "maps" / f"{name}.toml"), name, kind, arithmetic, label)


def of_robot(
    source: Recipe, name: str, kind: str, arithmetic: str = "float", label: str = ""
) -> Export:
    """Return the export of a robot in a codec, of its smallest size if no label tells another."""
    model = Model(source)
    channels = tuple(
        channel
        for channel in EXPORTABLE
        if channel in model.recipe.channels or channel == "tip_angle"
    )
    one = usable(model, arithmetic, kind)[0]
    size = one.read_label(label) if label else one.sizes(model, channels, arithmetic)[0]
    tables = encoded(model, kind, channels, size)
    # With the guard that its proof needs, as `lutgen export` has it.
    return proved(Export(name, model.recipe, model, kind, arithmetic, channels, tables))


def of_noise(source: Recipe) -> Export:
    """Return a trained table that means nothing: what matters is where its codes lie."""
    return noise("noise", Model(source), (15, 15, 12, 11), ("sdg",))


def _paper_two() -> Recipe:
    return load_recipe(ROOT / "maps" / "paper_two.toml")


def cases() -> list[Case]:
    """Return all rows."""
    rows = [
        Case(
            name,
            partial(of_recipe, name, "contacts"),
            MAPS / name / "firmware",
            WITHOUT.get(name, ()),
        )
        for name in (*ROBOTS, *COUNTED_ONCE)
    ]
    legs = partial(of_robot, quadruped(), "quadruped", "contacts")
    rows.append(Case("quadruped", legs, None, WITHOUT["quadruped"]))
    folder = MAPS / "paper_two" / "firmware"
    poly = partial(of_recipe, "paper_two", "poly", "float", POLY)
    rows.append(Case("paper_two_poly", poly, folder))
    for arithmetic in ("float", "integer"):
        make = partial(of_recipe, "paper_two", "grid", arithmetic, GRIDS[arithmetic])
        rows.append(Case(f"paper_two_grid_{arithmetic}", make, folder))
    rows.append(Case("grid_60kB", partial(of_noise, _paper_two())))
    return rows


def written(case: Case) -> tuple[Export, Path]:
    """Make a row's export and write its folder with the present runtime."""
    export = case.make()
    if case.folder is not None and (case.folder / f"{export.name}.c").is_file():
        _compare(export, case.folder)
    directory = BUILD / case.name / "firmware"
    directory.parent.mkdir(parents=True, exist_ok=True)
    package.write(export, directory)
    return export, directory


def _compare(export: Export, folder: Path) -> None:
    """Refuse a folder of `make maps` that is another export than that of its recipe."""
    known = report.load_report(folder)
    if (known["spec"], known["arithmetic"]) != (export.tables.spec.label, export.arithmetic):
        return  # the same robot, held in another way
    body = body_of(export)
    runtime = (folder / "smap.c").read_text(encoding="utf-8")
    held = (folder / f"{export.name}.c").read_text(encoding="utf-8")
    if runtime != runtime_text(features(body)):
        print(f"older   {export.name}: `make maps` made it with another runtime", flush=True)
    elif held != source_text(export, body):
        raise ExportError(
            f"{folder.relative_to(ROOT)}: is another export than that of its recipe (got "
            f"another {export.name}.c); run `make maps`."
        )

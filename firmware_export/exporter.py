"""Export a robot, from source to folder: options, choice, certificate, files."""

import logging
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from firmware_export.certify.certificate import POINTS, SEED, Certificate, bounded
from firmware_export.choose import KNEE, Candidate, Goal, Trials, choose, examine
from firmware_export.codecs import usable
from firmware_export.emit import check_directory, check_name, default_name, write
from firmware_export.host import load_library
from firmware_export.model import Model, uniform
from firmware_export.protocol import Codec, Export
from firmware_export.quantity import ErrorBound, parse_error, parse_size
from lutgen.channels import refuse_forces
from lutgen.errors import ExportError, InputError, reject
from lutgen.mapping import TO_STAND, StabilityMap, load_map
from lutgen.quantities import EXPORTABLE
from lutgen.recipe import Recipe, load_recipe

log = logging.getLogger("lutgen")

# Certificates that may refuse a choice before the search is given up.
ATTEMPTS = 6
# Times that a guard is made larger for what a certificate has seen, or a table lowered for what its
# test has; the largest guard (rad).
WIDER, LOWERED, WIDEST = 3, 80, 5e-3
# Points of which a robot must stand at one at least.
LOOKED = 30_000
# Share of what stands that an export may report as unsafe at most.
USELESS = 0.25
# Bytes of the export that is made without a request if nothing reaches the knee.
ROOM = 64 * 1024


@dataclass(frozen=True)
class ExportOptions:
    """Options of an export; see the parameters of `export`."""

    name: str | None = None
    flash: str | int | None = None
    max_error: str | float | None = None
    channels: Sequence[str] | None = None
    codec: str = "auto"
    arithmetic: str = "float"
    allow_python: bool = False
    points: int = field(default_factory=lambda: POINTS)


def export(
    source: str | os.PathLike[str] | StabilityMap | Recipe,
    directory: str | os.PathLike[str],
    name: str | None = None,
    flash: str | int | None = None,
    max_error: str | float | None = None,
    channels: Sequence[str] | None = None,
    codec: str = "auto",
    arithmetic: str = "float",
    allow_python: bool = False,
    points: int = POINTS,
    progress: Callable[[str], None] | None = None,
    force: bool = False,
) -> dict[str, Any]:
    """Write a map or a recipe as C tables with their runtime.

    Parameters
    ----------
    source : path, StabilityMap or Recipe
        Robot to export.  A map counts by its recipe: every number is computed exactly from it, none
        is read from the map's nodes.
    directory : path
        The folder; it appears when it is whole.  One that holds anything but an earlier export, or
        one that was edited, is refused without `force`.
    name : str, optional
        C identifier; the robot's name by default.
    flash : str or int, optional
        Most bytes of tables and code, such as ``"16KiB"``: the most accurate that fits is chosen.
    max_error : str or float, optional
        Largest error of |SD_g|, in percent of its range (``"1%"``) or in the length unit: the
        smallest that holds it is chosen, ``contacts`` before ``grid``.  `height` is held to the
        same percentage or length.  Where |SD_g| jumps it is the 99th percentile that is held.
        With `flash` both must hold; with neither the recipe's [export] counts, and without that 1%.
    channels : sequence of str, optional
        Some of ``"sdg"``, ``"tip_angle"`` and ``"height"``, those of the recipe by default;
        ``"tip_angle"`` is always there.
    codec : str
        ``"auto"``, or the only codec that may be used.
    arithmetic : str
        ``"integer"`` for targets without floating point.
    allow_python : bool
        True if a recipe file may run the code that its `python` key names.
    points : int
        Points of the certificate.
    progress : callable, optional
        Called with a text for people before each step.
    force : bool
        True if files that lutgen did not make, or that were edited, may be replaced.

    Returns
    -------
    dict
        The content of NAME_report.json.

    Raises
    ------
    InputError
        For arguments that mean nothing, and channels that the recipe does not hold.
    ExportError
        If nothing meets the request, or the folder cannot be written.
    """
    progress = progress or log.debug
    check_directory(directory, force)
    options = ExportOptions(
        name, flash, max_error, channels, codec, arithmetic, allow_python, points
    )
    final = certified(source, options, progress)
    progress("writing")
    return write(final, directory, progress, force)


def certified(
    source: str | os.PathLike[str] | StabilityMap | Recipe,
    options: ExportOptions,
    progress: Callable[[str], None] = log.debug,
) -> Export:
    """Return the export of a source, chosen and certified, before it is written; see `export`."""
    load_library()  # what is certified with must be there before the minutes of a fit
    recipe = _recipe(source, options.allow_python)
    label = check_name(options.name) if options.name is not None else default_name(recipe.name)
    channels = _channels(recipe, options.channels)
    flash, error = options.flash, options.max_error
    if flash is None and error is None:
        flash, error = recipe.export.flash, recipe.export.max_error
    size = None if flash is None else parse_size(flash)
    bound = None if error is None else parse_error(error)
    model = Model(recipe)
    codecs = usable(model, options.arithmetic, options.codec)
    sample = uniform(model, LOOKED, SEED)
    if not (model.exact(*sample).tip_angle >= 0.0).any():
        what = "key `robot.contact`: the export would only ever answer that the robot tips"
        got = f"none of {sample.points:,} postures and directions in which it stands"
        reject(recipe.source, what, got, TO_STAND, ExportError)
    progress(f"looking for the best of {', '.join(one.name for one in codecs)}")
    trials = Trials(model, label, channels, options.arithmetic)
    nothing = size is None and bound is None
    goal = Goal(size, KNEE if nothing else bound)
    try:
        chosen = _certified(trials, codecs, goal, options.points, progress)
    except ExportError:
        if not nothing:
            raise
        goal = Goal(ROOM, None)
        chosen = _certified(trials, codecs, goal, options.points, progress)
    certificate = chosen.certificate
    if certificate.false_tip > USELESS:
        what = "the export would report too much of what stands as unsafe"
        got = f"{100.0 * certificate.false_tip:.3g} % for {chosen.label}"
        way_out = "allow more flash, narrow the parameters, or choose another --codec"
        most = f"more than {100.0 * USELESS:.0f} %"
        reject(recipe.source, what, f"{got}, {most}", way_out, ExportError)
    result = certificate.as_dict() | {
        "error_percent": certificate.error_of(bounded(channels)[0], relative=True),
        "bound": None if goal.bound is None else str(goal.bound),
        "candidates": len(trials.tried),
    }
    return replace(chosen.export, certificate=result)


def _recipe(source: str | os.PathLike[str] | StabilityMap | Recipe, allow_python: bool) -> Recipe:
    """Return the recipe of a source; refuse a robot whose code was not run."""
    if isinstance(source, str | os.PathLike):
        toml = Path(source).suffix == ".toml"
        source = load_recipe(source, allow_python) if toml else load_map(source)
    recipe = source.recipe if isinstance(source, StabilityMap) else source
    if recipe.python is not None and recipe.function is None:
        what = "the robot is given by code, which a map does not hold"
        got, way_out = f"python = {recipe.python!r}", "export the recipe's file with --allow-python"
        reject(recipe.source, what, got, way_out, InputError)
    refuse_forces(recipe, "the C runtime")
    return recipe


def _channels(recipe: Recipe, given: Sequence[str] | None) -> tuple[str, ...]:
    """Return the channels to hold, in the order of the runtime."""
    stored = [name for name in EXPORTABLE if name in recipe.channels]
    if isinstance(given, str):
        given = [name.strip() for name in given.split(",")]
    wanted = stored if given is None else list(given)
    for name in wanted:
        if name not in EXPORTABLE:
            what, way_out = f"{name!r} cannot be exported", f"choose from {', '.join(EXPORTABLE)}"
            reject("channels", what, repr(name), way_out, InputError)
        if name not in recipe.channels and name != "tip_angle":
            raise InputError(
                f"{recipe.source}: has no channel {name!r} (it has {', '.join(recipe.channels)}); "
                "add it to `sweep.gravity.channels` and sweep again."
            )
    return tuple(name for name in EXPORTABLE if name in wanted or name == "tip_angle")


def _certified(
    trials: Trials,
    codecs: Sequence[Codec],
    goal: Goal,
    points: int,
    progress: Callable[[str], None],
) -> Candidate:
    """Return the best candidate whose full certificate meets a goal."""
    bound = goal.bound
    for _ in range(ATTEMPTS):
        chosen = choose(trials, codecs, goal)
        progress(f"certifying {chosen.label}, {chosen.total:,} bytes")
        export, certificate = guarded(chosen.export, bound, points)
        certificate.refuse_false_safe(f"{trials.model.recipe.source}: {chosen.label}")
        chosen = replace(chosen, export=export, certificate=certificate)
        found = goal.error(chosen)
        if bound is None or found <= bound.value:
            return chosen
        # The certificate saw more than the choice; aim lower by as much.
        goal = replace(goal, margin=goal.margin * max(1.1, 1.02 * found / bound.value))
    raise ExportError(
        f"{trials.model.recipe.source}: no export was certified to an error of {bound} (got "
        f"{found:.3g} for {chosen.label}, {chosen.total:,} bytes); allow a larger error."
    )


def guarded(export: Export, bound: ErrorBound | None, points: int) -> tuple[Export, Certificate]:
    """Return an export, mended if it has to be to be never falsely safe, and its certificate.

    A trained table is lowered at the points that its test has found.  Where contacts are within
    rounding of one plane, single precision may take another one for the corner of a rest: twice
    what that alters is added to the guard.  Points that have not been seen judge it then.
    """
    certificate = examine(export, bound, points)
    for attempt in range(1, (LOWERED if export.tables.tested else WIDER) + 1):
        if certificate.witness is None:
            break
        if certificate.wrong is not None:
            tables = export.tables.lowered(*certificate.wrong, attempt)
        else:
            _, _, said, true = certificate.witness
            guard = float(export.tables.guard) + 2.0 * (said - true)
            tables = export.tables.guarded(guard) if guard <= WIDEST else None
        if tables is None:
            break
        export = replace(export, tables=tables)
        certificate = examine(export, bound, points, SEED + attempt)
    return export, certificate

"""The tables that a page is asked with: those of an export, or made for the page.

Owns where they come from and what is told of them.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from firmware_export.codecs import codec
from firmware_export.contacts import c_body, drawn_tables
from firmware_export.protocol import Blob, Export, describe, restored
from firmware_export.truth import Model
from lutgen.errors import ExportError, InputError
from lutgen.quantities import EXPORTABLE
from lutgen.recipe import Recipe

# What is made where nobody has exported: it has no tables to fit, so that it takes seconds.
QUICK = "contacts"


@dataclass(frozen=True, eq=False)
class Answers:
    """Tables and what is told of them.

    Parameters
    ----------
    blob : Blob
        As they stand in flash.
    drawn : Blob
        Tables of the same robot from which the runtime for many contacts makes its pose.
    about : str
        Codec and what its certificate found, for people.
    guard : float
        What is taken off the tip angle, rad.
    steps : dict
        Length of a step of each channel of an export without floats.
    """

    blob: Blob
    drawn: Blob
    about: str
    guard: float
    steps: dict[str, float]


def answers_of_recipe(recipe: Recipe) -> Answers:
    """Return tables of the codec that needs no search.

    Raises
    ------
    InputError
        For robots that the page cannot compute: given by code, or under forces.
    ExportError
        If the codec cannot hold the robot.
    """
    drawn, info, model = _drawn(recipe), codec(QUICK), Model(recipe)
    spec = info.sizes(model, EXPORTABLE, "float")[0]
    tables = info.encode(model, EXPORTABLE, spec)
    export = Export("explored", recipe, model, info.name, "float", EXPORTABLE, tables)
    blob = describe(export, info.c_body(tables, False))
    return Answers(blob, drawn, f"codec {QUICK}, made for this page", float(tables.guard), {})


def answers_of_export(report: Mapping[str, Any], source: str, recipe: Recipe) -> Answers:
    """Return the tables of an export; refuse one of another recipe.

    `report` is of `device.ExportFolder`, which has looked at it, and `source` names the folder.

    Raises
    ------
    InputError
        If it is of another recipe, or of a robot that the page cannot compute.
    ExportError
        If the robot has more contacts than the runtime knows.
    """
    drawn = _drawn(recipe)
    if report["recipe_sha256"] != recipe.digest:
        raise InputError(
            f"{source}: was exported from another recipe than {recipe.source} (got the digest "
            f"{recipe.digest[:12]}, the export says {report['recipe_sha256'][:12]}); name its own "
            "with --recipe."
        )
    about = f"export {report['name']}, {report['spec']}, {report['arithmetic']} arithmetic"
    if report.get("points"):
        about += f", certified on {report['points']:,} points: {report['false_safe']} falsely safe"
    steps = {name: float(step) for name, step in (report.get("steps") or {}).items()}
    guard = math.radians(report["guard_deg"])
    return Answers(restored(report["tables"]), drawn, about, guard, steps)


def _drawn(recipe: Recipe) -> Blob:
    """Return what the picture is made from; refuse a robot that the page cannot compute."""
    refuse_unknown(recipe)
    model = Model(recipe)
    reason = codec(QUICK).refusal(model, "float")
    if reason is not None:
        raise ExportError(
            f"{recipe.source}: the codec {QUICK} cannot hold this robot (got: "
            f"{reason.rstrip('.')}), and the page computes with it; look at the robot with "
            "`lutgen plot --kind robot`."
        )
    tables = drawn_tables(model)
    return describe(Export("drawn", recipe, model, QUICK, "float", (), tables), c_body(tables))


def refuse_unknown(recipe: Recipe) -> None:
    """Refuse a robot whose contacts or forces the page cannot compute."""
    got: Any = None
    if recipe.python is not None:
        got, why = f"python = {recipe.python!r}", "is given by code, which no page can run"
    elif recipe.has_wrench:
        names = ", ".join(force.name for force in recipe.forces if force.acts)
        got, why = names, "is under forces, and the page knows the weight and no other"
    if got is not None:
        raise InputError(
            f"{recipe.source}: the robot {why} (got {got}); look at it with `lutgen plot --kind "
            "robot` and `lutgen eval`."
        )

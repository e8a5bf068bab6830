"""The tables of a page: those of an export, or made for the page."""

import math
from dataclasses import dataclass

from firmware_export.codecs import codec
from firmware_export.contacts import drawn_tables
from firmware_export.device import ExportFolder
from firmware_export.model import Model
from firmware_export.protocol import Blob, Export, describe
from lutgen.errors import InputError, reject
from lutgen.quantities import EXPORTABLE
from lutgen.recipe import Recipe

# The codec for robots that are not exported: it has no tables to fit, so it takes seconds.
QUICK = "contacts"


@dataclass(frozen=True, eq=False)
class Answers:
    """Tables and the page's words on them.

    `blob` is as it stands in flash; from `drawn` the runtime for many contacts makes the pose that
    is drawn.  `about` names codec and certificate for people; `guard` (rad) is what is taken off
    the tip angle.
    """

    blob: Blob
    drawn: Blob
    about: str
    guard: float


def answers_of_recipe(recipe: Recipe) -> Answers:
    """Return tables of the codec that needs no search; refuse a robot that the page cannot hold."""
    model = Model(recipe)
    drawn, export = _drawn(model), codec(QUICK).export(model, "explored", EXPORTABLE)
    guard = float(export.tables.guard)
    return Answers(describe(export), drawn, f"codec {QUICK}, made for this page", guard)


def answers_of_export(folder: ExportFolder) -> Answers:
    """Return the tables of an export; refuse one that the page cannot read."""
    report, recipe = folder.report, folder.recipe()
    if folder.integer:
        what = "the export is read without floats, but the page uses floats"
        way_out = "read it with `lutgen eval`, or explore its recipe"
        reject(recipe.source, what, "integer arithmetic", way_out, InputError)
    about = f"export {report['name']}, {report['spec']}, {report['arithmetic']} arithmetic"
    if report.get("points"):
        about += f", certified on {report['points']:,} points: {report['false_safe']} falsely safe"
    return Answers(folder.blob, _drawn(Model(recipe)), about, math.radians(report["guard_deg"]))


def _drawn(model: Model) -> Blob:
    """Return what the picture is made from; refuse a robot that the page cannot compute."""
    recipe = model.recipe
    if recipe.python is not None:
        reason: str | None = "it is given by code"
    elif recipe.has_wrench:
        reason = "it is under forces other than its weight"
    else:
        reason = codec(QUICK).refusal(model, "float")
    if reason is not None:
        what, got = "no page can compute this robot", reason.rstrip(".")
        way_out = "look at it with `lutgen plot --kind robot` and `lutgen eval`"
        reject(recipe.source, what, got, way_out, InputError)
    tables = drawn_tables(model)
    return describe(Export("drawn", recipe, model, QUICK, "float", (), tables))

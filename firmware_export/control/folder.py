"""An export with a policy: from source to folder.

Owns the order: what is certified first, then the policy that steers by it.
"""

import os
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from firmware_export.control.maker import Design, Wishes, design
from firmware_export.emit import check_directory, write
from firmware_export.exporter import Asked, certified
from firmware_export.host import Controller
from firmware_export.protocol import Export, describe
from lutgen.errors import InputError
from lutgen.mapping import StabilityMap
from lutgen.recipe import Recipe


def steered(export: Export, wishes: Wishes) -> tuple[Export, Design]:
    """Return an export with the policy that is asked for, and what is known of it.

    Raises
    ------
    InputError
        For wishes that mean nothing, and exports that are read without floats.
    """
    if export.integer:
        raise InputError(
            f"{export.recipe.source}: on-board control computes with floats (got integer "
            "arithmetic); export with --arithmetic float."
        )
    found = design(export.model, wishes)
    blob = describe(export)
    Controller(blob, found.policy.packed(blob.bytes))  # whether the C takes it
    return replace(export, policy=found.policy), found


def policy(
    source: str | os.PathLike[str] | StabilityMap | Recipe,
    directory: str | os.PathLike[str],
    wishes: Wishes | None = None,
    tell: Callable[[str], None] = lambda text: None,
    **options: Any,
) -> tuple[dict[str, Any], Design]:
    """Write a robot's map, its policy and the C that follows it into a folder.

    Parameters
    ----------
    source, directory
        As for `firmware_export.export`.
    wishes : Wishes, optional
        What the policy is asked for.
    tell : callable
        Called with a text for people before each step.
    **options
        `name`, `flash`, `max_error`, `channels`, `codec`, `allow_python` and `points` of
        `firmware_export.export`.

    Returns
    -------
    dict
        The content of NAME_report.json.
    Design
        The policy, and what it loses.

    Raises
    ------
    InputError
        For arguments that mean nothing.
    ExportError
        If nothing meets what is asked for, or the folder cannot be written.
    """
    check_directory(directory)
    export = certified(source, Asked(**options), tell)
    tell("looking for the best postures")
    export, found = steered(export, wishes or Wishes())
    tell("writing")
    return write(export, directory, tell), found

"""What is proved of an export folder, from the folder alone.

Owns the question that `lutgen prove` asks.
"""

import json
import os
from pathlib import Path
from typing import Any

from firmware_export.device import ExportFolder
from firmware_export.prove import Statement, record, state
from lutgen.errors import InputError, LutgenError
from lutgen.recipe import Recipe, parse_recipe

__all__ = ["proof_text", "prove"]


def prove(directory: str | os.PathLike[str]) -> tuple[Statement, dict[str, Any] | None]:
    """Prove that the export of a folder is never falsely safe.

    Returns
    -------
    stated : Statement
        What came of it.
    content : dict or None
        The content of NAME_proof.json, for `proofs/check_proof.py`; None without a proof.

    Raises
    ------
    InputError
        If the folder is none of an export, or its report does not hold the recipe.
    """
    folder = ExportFolder(directory)
    recipe = _recipe(folder, Path(directory))
    stated = state(recipe, folder.blob.bytes, folder.integer)
    if not stated.proved:
        return stated, None
    digest = folder.report["tables"]["source_sha256"]
    return stated, record(recipe, stated, folder.report["name"], digest)


def proof_text(content: dict[str, Any]) -> str:
    """Return the text of NAME_proof.json."""
    return json.dumps(content, indent=1, allow_nan=False) + "\n"


def _recipe(folder: ExportFolder, directory: Path) -> Recipe:
    """Return the recipe that a report holds, if it is the one of the export."""
    held: Any = folder.report.get("recipe")
    try:
        text, urdf = held["text"], held["urdf"]
        recipe = parse_recipe(text, f"{directory} (recipe inside)", inert=True, urdf=urdf)
    except LutgenError:
        raise
    except (KeyError, TypeError, AttributeError) as error:
        raise InputError(
            f"{directory}: its report does not hold the recipe (got one of lutgen "
            f"{folder.report.get('lutgen_version')}); export again."
        ) from error
    if recipe.digest != folder.report.get("recipe_sha256"):
        raise InputError(
            f"{directory}: the recipe of its report was changed (got the digest "
            f"{recipe.digest[:12]}, not {str(folder.report.get('recipe_sha256'))[:12]}); "
            "export again."
        )
    return recipe

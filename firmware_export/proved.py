"""What is proved of an export folder, from the folder alone.

Owns the question that `lutgen prove` asks.
"""

import json
import os
from typing import Any

from firmware_export.device import ExportFolder
from firmware_export.prove import Statement, record, state

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
    recipe = folder.recipe()
    stated = state(recipe, folder.blob.bytes, folder.integer)
    if not stated.proved:
        return stated, None
    digest = folder.report["tables"]["source_sha256"]
    return stated, record(recipe, stated, folder.report["name"], digest)


def proof_text(content: dict[str, Any]) -> str:
    """Return the text of NAME_proof.json."""
    return json.dumps(content, indent=1, allow_nan=False) + "\n"

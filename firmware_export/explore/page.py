"""The page: one file of HTML with its scripts, both WebAssembly modules and the robot inside.

Owns how they are put together; built/ holds what tools/explorer.py made of engine/ and web/.
"""

import base64
import html
import json
import math
import re
from importlib.resources import files
from typing import Any

from firmware_export.explore.scene import scene_of
from firmware_export.explore.tables import Answers
from lutgen.errors import ExportError
from lutgen.recipe import Recipe

_HOME = files("firmware_export") / "explore"


def part(name: str) -> bytes:
    """Return a file of the room."""
    try:
        return (_HOME / name).read_bytes()
    except OSError as error:
        raise ExportError(
            f"{name}: this file of the explorer cannot be read (got {error.strerror}); "
            "install lutgen again."
        ) from error


def page_text(recipe: Recipe, answers: Answers) -> str:
    """Return the page of a robot: a pure function of the recipe and the tables."""
    blob = answers.blob
    data = {
        "scene": scene_of(recipe),
        "map": {
            "blob": _encoded(blob.bytes),
            "codec": blob.codec,
            "integer": blob.integer,
            "ends": [[one.minimum, one.maximum] for one in recipe.parameters],
            "steps": answers.steps,
        },
        "exported": _encoded(part("built/exported.wasm")),
        "exact": _encoded(part("built/exact.wasm")),
    }
    has = {
        "NAME": html.escape(recipe.name.replace("_", " ")),
        "ABOUT": html.escape(_about(recipe, answers)),
        "GUARD": f"{math.degrees(answers.guard):.2g}°",
        "LICENCES": _inside_script(part("built/three.LICENSE").decode("utf-8")),
        "CSS": part("web/page.css").decode("utf-8"),
        "DATA": _inside_script(json.dumps(data, allow_nan=False, separators=(",", ":"))),
        "WORKER": _inside_script(part("built/worker.js").decode("utf-8")),
        "MAIN": _inside_script(part("built/main.js").decode("utf-8")),
    }
    frame = part("web/page.html.in").decode("utf-8")
    return re.sub(r"@([A-Z]+)@", lambda found: has[found[1]], frame)


def _about(recipe: Recipe, answers: Answers) -> str:
    """Return the line below the name."""
    k, n = len(recipe.parameters), len(recipe.contacts)
    joints, size = f"{k} parameter{'' if k == 1 else 's'}", len(answers.blob.bytes)
    nominal = "; exact values are those of the nominal com" if recipe.com_uncertainty > 0.0 else ""
    return f"{joints}, {n} contacts; {answers.about}, {size:,} bytes of tables{nominal}"


def _encoded(data: bytes) -> str:
    return base64.b64encode(data).decode("ascii")


def _inside_script(text: str) -> Any:
    """Return a text that cannot end the script element that it stands in."""
    return re.sub(r"</(script)", r"<\\/\1", text, flags=re.IGNORECASE).replace("<!--", "<\\!--")

"""The page: one file of HTML with its scripts, the runtime as WebAssembly and the robot inside.

Owns how they are put together, and the policy by which the page may run these scripts and load
nothing else.
"""

import base64
import hashlib
import html
import json
import math
import re
from importlib.resources import files
from typing import Any

from firmware_export.explore.scene import scene_of
from firmware_export.explore.tables import Answers
from firmware_export.host import stem_of
from firmware_export.protocol import Blob
from lutgen.errors import ExportError
from lutgen.recipe import Recipe

_HOME = files("firmware_export") / "explore"
# In this order they are one script.
SCRIPTS = (
    *("words", "colours", "gravity", "runtime", "state", "robot", "marks", "stage"),
    *("flat", "controls", "page"),
)


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
    data = {
        "scene": scene_of(recipe),
        "answers": _asked(answers.blob)
        | {
            "integer": answers.blob.integer,
            "ends": [[one.minimum, one.maximum] for one in recipe.parameters],
            "steps": answers.steps,
        },
        "drawn": _asked(answers.drawn),
        "wasm": _encoded(part("wasm/exported.wasm")),
    }
    css = part("web/page.css").decode("utf-8")
    three = _inside_script(part("vendor/three.js").decode("utf-8"))
    own = "\n".join(part(f"web/{name}.js").decode("utf-8") for name in SCRIPTS)
    own = _inside_script(own)
    has = {
        "NAME": html.escape(recipe.name.replace("_", " ")),
        "ABOUT": html.escape(_about(recipe, answers)),
        "GUARD": f"{math.degrees(answers.guard):.2g}°",
        "LICENCES": _inside_script(part("vendor/three.LICENSE").decode("utf-8")),
        "CSS": css,
        "DATA": _inside_script(json.dumps(data, allow_nan=False, separators=(",", ":"))),
        "THREE": three,
        "OWN": own,
        "POLICY": f"default-src 'none'; img-src data:; style-src {_hash(css)}; "
        f"script-src {_hash(three)} {_hash(own)} 'wasm-unsafe-eval'",
    }
    frame = part("web/page.html.in").decode("utf-8")
    return re.sub(r"@([A-Z]+)@", lambda found: has[found[1]], frame)


def _about(recipe: Recipe, answers: Answers) -> str:
    """Return the line below the name."""
    k, n = len(recipe.parameters), len(recipe.contacts)
    joints, size = f"{k} parameter{'' if k == 1 else 's'}", len(answers.blob.bytes)
    return f"{joints}, {n} contacts; {answers.about}, {size:,} bytes of tables"


def _asked(blob: Blob) -> dict[str, Any]:
    """Return tables, and what the names of the functions that read them begin with."""
    return {"blob": _encoded(blob.bytes), "stem": stem_of(blob)}


def _encoded(data: bytes) -> str:
    return base64.b64encode(data).decode("ascii")


def _hash(text: str) -> str:
    """Return the source of a policy that allows the element with this text."""
    return f"'sha256-{_encoded(hashlib.sha256(text.encode()).digest())}'"


def _inside_script(text: str) -> str:
    """Return a text that cannot end the script element that it stands in."""
    return re.sub(r"</(script)", r"<\\/\1", text, flags=re.IGNORECASE).replace("<!--", "<\\!--")

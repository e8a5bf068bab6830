"""The page: one file of HTML with its scripts, the runtime as WebAssembly and the robot inside.

This module puts them together.  A policy in the page lets it run these scripts and load nothing
else.
"""

import base64
import hashlib
import html
import json
import math
import re
from importlib.resources import files

from firmware_export.explore.scene import scene_of
from firmware_export.explore.tables import Answers
from firmware_export.host import stem_of
from firmware_export.protocol import Blob
from lutgen.recipe import Recipe

# In this order they are one script.
SCRIPTS = ("words", "answers", "robot", "marks", "stage", "flat", "page")


def page_text(recipe: Recipe, answers: Answers) -> str:
    """Return the page of a robot: a pure function of the recipe and the tables."""
    data = {
        "scene": scene_of(recipe),
        "answers": _asked(answers.blob),
        "drawn": _asked(answers.drawn),
        "wasm": _encoded(_part("wasm/exported.wasm")),
    }
    css = _part("web/page.css").decode()
    three = _script(_part("vendor/three.js").decode())
    own = _script("\n".join(_part(f"web/{name}.js").decode() for name in SCRIPTS))
    parameters, size = len(recipe.parameters), len(answers.blob.bytes)
    joints = f"{parameters} parameter{'' if parameters == 1 else 's'}"
    about = f"{joints}, {len(recipe.contacts)} contacts; {answers.about}, {size:,} bytes of tables"
    has = {
        "NAME": html.escape(recipe.name.replace("_", " ")),
        "ABOUT": html.escape(about),
        "GUARD": f"{math.degrees(answers.guard):.2g}°",
        "LICENCES": _script(_part("vendor/three.LICENSE").decode()),
        "CSS": css,
        "DATA": _script(json.dumps(data, allow_nan=False, separators=(",", ":"))),
        "THREE": three,
        "OWN": own,
        "POLICY": f"default-src 'none'; img-src data:; style-src {_hash(css)}; "
        f"script-src {_hash(three)} {_hash(own)} 'wasm-unsafe-eval'",
    }
    return re.sub(r"@([A-Z]+)@", lambda found: has[found[1]], _part("web/page.html.in").decode())


def _part(name: str) -> bytes:
    """Return a file of the room."""
    return (files("firmware_export") / "explore" / name).read_bytes()


def _asked(blob: Blob) -> dict[str, str]:
    """Return tables, and what the names of the functions that read them begin with."""
    return {"blob": _encoded(blob.bytes), "stem": stem_of(blob)}


def _encoded(data: bytes) -> str:
    return base64.b64encode(data).decode("ascii")


def _hash(text: str) -> str:
    """Return the source of a policy that allows the element with this text."""
    return f"'sha256-{_encoded(hashlib.sha256(text.encode()).digest())}'"


def _script(text: str) -> str:
    """Return a text that cannot end the script element that it stands in."""
    return re.sub(r"</(script)", r"<\\/\1", text, flags=re.IGNORECASE).replace("<!--", "<\\!--")

"""The codecs, a row each, and which of them can hold a robot."""

from firmware_export.contacts import INFO as CONTACTS
from firmware_export.grid import LOOKUP, TABLE
from firmware_export.model import Model
from firmware_export.protocol import Codec
from lutgen.errors import ExportError, InputError, reject

# In the order in which they are tried: the first are most accurate for what they can hold.
CODECS = (CONTACTS, LOOKUP, TABLE)
ARITHMETIC = ("float", "integer")


def named(name: str) -> list[Codec]:
    """Return the codecs that people call so; all for ``auto``."""
    found: list[Codec] = [info for info in CODECS if name in (info.name, "auto")]
    if not found:
        names = ", ".join(dict.fromkeys(info.name for info in CODECS))
        way_out = f"use auto or one of: {names}"
        reject("codec", f"{name!r} is unknown", repr(name), way_out, InputError)
    return found


def codec(name: str) -> Codec:
    """Return what writes and reads the tables of the codecs with a name."""
    return named(name)[0]


def usable(model: Model, arithmetic: str, name: str = "auto") -> list[Codec]:
    """Return the codecs that can hold a robot, in the order to try them.

    InputError is raised for names that are not known, ExportError if none can, with the reasons.
    """
    if arithmetic not in ARITHMETIC:
        what, way_out = f"{arithmetic!r} is unknown", f"use one of: {', '.join(ARITHMETIC)}"
        reject("arithmetic", what, repr(arithmetic), way_out, InputError)
    reasons = {info: info.refusal(model, arithmetic) for info in named(name)}
    found = [info for info, reason in reasons.items() if reason is None]
    if not found:
        # Codecs of one name refuse for the same reason.
        why = "; ".join(dict.fromkeys(str(reason).rstrip(".") for reason in reasons.values()))
        got = f"codec {name!r}, arithmetic {arithmetic!r}: {why}"
        what, way_out = "no codec can hold this robot", "choose another codec or arithmetic"
        reject(model.recipe.source, what, got, way_out, ExportError)
    return found

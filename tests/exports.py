"""Small exports that several test files share: real codecs, a made-up certificate."""

from typing import Any

from firmware_export import contacts, grid, poly
from firmware_export.exported import CHANNELS, Export
from firmware_export.model import Model
from lutgen.recipe import Recipe, parse_recipe
from tests.recipes import rover, tripod

CERTIFICATE: dict[str, Any] = {
    "points": 512_345,
    "channels": {
        "sdg": {
            **{"max": 0.0123, "p99": 0.0045, "rms": 0.0011, "range": 1.5},
            **{"max_percent": 0.82, "p99_percent": 0.3, "rms_percent": 0.073},
        },
        "tip_angle": {"max": 0.02, "p99": 0.01, "rms": 0.002},
        "height": {"max": 0.002, "p99": 0.001, "rms": 0.0005},
    },
    "false_safe": 0,
    "given_up": 0.0123,
    "jumps": False,
    "text": [],
}
PARETO: list[dict[str, Any]] = [
    {"label": "poly small", "codec": "poly", "bytes": 60, "total_bytes": 1700, "error": 2.0},
    {
        **{"label": "poly large", "codec": "poly", "bytes": 90, "total_bytes": 1730},
        **{"error": 0.82, "chosen": True},
    },
    {"label": "grid u8", "codec": "grid", "bytes": 16_000, "total_bytes": 17_500, "error": 2.4},
]


CODECS = {"contacts": contacts, "grid": grid, "poly": poly}
# Steps of growth from the smallest size: a fit of a few tenths of a second.
GROWTH = {"contacts": 4, "grid": 0, "poly": 4}


def tripod_export(name: str = "tripod", codec: str = "contacts", **changes: Any) -> Export:
    """Return an export of the tripod; `changes` replace arguments of `Export`."""
    return _export(parse_recipe(tripod()), name, codec, changes)


def rover_export(name: str = "rover", codec: str = "contacts", **changes: Any) -> Export:
    """Return an export of four wheels, whose support facet changes."""
    return _export(parse_recipe(rover()), name, codec, changes)


def _export(recipe: Recipe, name: str, codec: str, changes: dict[str, Any]) -> Export:
    module, model = CODECS[codec], Model(recipe)
    arithmetic = changes.pop("arithmetic", "float")
    # Fitting |SD_g| onto a grid takes longer than a test should.
    channels = ("tip_angle",) if codec == "grid" else CHANNELS
    assert module.refusal(model, arithmetic) is None
    spec = module.start(model, channels, arithmetic)[-1]
    for _ in range(GROWTH[codec]):
        spec = (module.grow(model, spec) or [spec])[0]
    tables = module.encode(model, channels, spec)
    values = {"certificate": CERTIFICATE, "pareto": PARETO, "code_bytes": 1640, **changes}
    return Export(name, recipe, model, codec, arithmetic, channels, tables, **values)

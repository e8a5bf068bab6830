"""Lay a map out as one run of bytes: a CRC-32, descriptor and tables, as runtime/smap_map.h says.

The exported file, the report and the library of this machine all use these bytes.
"""

import base64
import math
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from firmware_export.model import Model, sensor_tolerance
from firmware_export.protocol.codec import CArray, Export

# SMAP_VERSION of the runtime.
VERSION = 3
TURN = 2.0 * math.pi
# The rim of the chart is widened by this: rounding of a quotient.
HAIR = 1e-6
# Postures that decide if a robot given by code is the same a turn further, and how nearly.
LOOKED, ALIKE = 200, 1e-9
CHANNEL_BITS = {"sdg": 1, "tip_angle": 2, "height": 4}


@dataclass(frozen=True, eq=False)
class Blob:
    """A map as bytes, CRC-32 first.

    `sections` say where each part begins and what it is, for people; `codec` is the codec's number,
    `params` the number of parameters, `integer` True if the map is read without floats.
    """

    bytes: bytes
    sections: tuple[tuple[int, str], ...]
    codec: int
    params: int
    integer: bool


def turns(model: Model, index: int) -> bool:
    """Return True if a parameter turns joints all the way round: 2 pi more is the same posture."""
    recipe = model.recipe
    parameter = recipe.parameters[index]
    if recipe.function is not None:
        return parameter.unit == "rad" and _repeats(model, index)
    joints = [
        link.joint for link in recipe.links if link.joint and link.joint.parameter == parameter.name
    ]
    whole = all(joint.kind == "revolute" and joint.scale % 1.0 == 0.0 for joint in joints)
    round_ = parameter.maximum - parameter.minimum >= TURN * (1.0 - 1e-6)
    return parameter.unit == "rad" and bool(joints) and whole and round_


@lru_cache(maxsize=64)
def _repeats(model: Model, index: int) -> bool:
    """Return True if a robot given by code is the same a turn further, and its axis has a turn."""
    span = model.upper[index] - model.lower[index]
    if abs(span - TURN) > 1e-6:
        return False
    params = model.at(np.random.default_rng(index).random((LOOKED, model.k)))
    params[: LOOKED // 2, index] = model.lower[index]
    further = params.copy()
    further[:, index] += TURN
    here, there = (model.postures(one).centres for one in (params, further))
    return bool(np.abs(here - there).max() <= ALIKE * np.abs(here).max())


def describe(export: Export) -> Blob:
    """Return the blob of an export."""
    body, model, guard = export.body, export.model, float(export.tables.guard)
    channels = sum(CHANNEL_BITS[channel] for channel in export.channels)
    limit = min(65535, math.ceil(model.chart_limit * 4096.0 * (1.0 + HAIR)) + 1)
    head = [VERSION, body.codec, model.k, channels, model.faces, body.contacts, 0, 0]
    meaning = "version, codec, parameters, channels, faces of the chart, contacts"
    arrays = [
        CArray("head", "uint8_t", head, meaning),
        CArray(
            "limit", "float", [model.chart_limit * (1.0 + HAIR)], "largest |u|, |v|, just wider"
        ),
        CArray("guard", "float", [guard], "guard, rad"),
        CArray("step", "float", [body.step], "length of a step of the integer form"),
        CArray(
            *("whole", "uint16_t"),
            [min(math.ceil(guard * 32767.0) + body.rounded, 32767), limit],
            "guard in 1/32767, largest |u|, |v| in 1/4096",
        ),
        *_axes(model),
        *body.arrays,
    ]
    packed, sections, at = b"", [], 8
    for array in arrays:
        if array.bytes:
            sections.append((at, f"{array.name}: {array.comment}"))
            packed, at = packed + array.packed, at + array.bytes
    packed = (at).to_bytes(4, "little") + packed
    whole = zlib.crc32(packed).to_bytes(4, "little") + packed
    sections.insert(0, (0, "CRC-32 of what follows, bytes in all"))
    return Blob(whole, tuple(sections), body.codec, model.k, export.integer)


def _axes(model: Model) -> Iterator[CArray]:
    """Return the arrays of the parameters' axes."""
    for index, parameter in enumerate(model.recipe.parameters):
        round_ = turns(model, index)
        room = -1.0 if round_ else sensor_tolerance(parameter)
        span = parameter.maximum - parameter.minimum
        steps = math.floor(max(room, 0.0) / span * 32767.0)
        exact = round_ and abs(span - TURN) < 1e-6
        ends = [parameter.minimum, parameter.maximum, room]
        about = f"{parameter.name}, {parameter.unit}: ends, sensor tolerance (-1: it turns round)"
        yield CArray(f"axis {index}", "float", ends, about)
        yield CArray(
            *(f"axis {index} in steps", "uint16_t"),
            [65535 if exact else min(steps, 32767)],
            "sensor tolerance (65535: it turns)",
        )


def stored(blob: Blob) -> dict[str, Any]:
    """Return a blob as JSON knows it."""
    return {
        "blob": base64.b64encode(blob.bytes).decode("ascii"),
        "codec": blob.codec,
        "params": blob.params,
        "integer": blob.integer,
    }


def restored(content: Mapping[str, Any]) -> Blob:
    """Return the blob that `stored` wrote; KeyError, TypeError or ValueError if it did not."""
    packed = base64.b64decode(content["blob"], validate=True)
    if zlib.crc32(packed[4:]).to_bytes(4, "little") != packed[:4]:
        raise ValueError("its CRC-32 is another")
    codec, params = int(content["codec"]), int(content["params"])
    if packed[9:11] != bytes((codec, params)):
        raise ValueError("their codec or number of parameters is another")
    return Blob(packed, (), codec, params, bool(content["integer"]))

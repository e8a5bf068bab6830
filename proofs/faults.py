"""Seeded faults in maps of three points: none that a dense search finds unsafe may be proved.

`python -m proofs.faults` changes one bit of a hundred maps, asks `firmware_export.prove` of each,
and searches it with the C itself: just outside the true boundary, and anywhere.
"""

import zlib
from collections import Counter
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from firmware_export.codecs import named
from firmware_export.host import Host
from firmware_export.protocol import Blob, Export, describe
from firmware_export.prove import state, stored_guard
from firmware_export.truth import Model
from lutgen.recipe import parse_recipe
from lutgen.vector import Floats
from tests.fixtures.recipes import tripod

__all__ = ["Verdict", "judge", "main", "proved_maps", "search", "seeded"]

# Codec and size of the maps, and whether they are read without floats.
MAPS = (
    ("contacts", "contacts", False),
    ("poly", "poly 2x1 2x1 2x1", False),
    ("grid", "grid i16 4x4 4x4 4x4", False),
    ("grid", "grid i8 4x4 4x4 4x4", True),
)
# Bytes of a map that faults are put in: from its guard on.
FIRST = 20
POSTURES, ALONG, OUTSIDE = 1500, 4, 2e-6


class Verdict(NamedTuple):
    """What is said of a map: whether it is proved, and how many false safes a search finds."""

    proved: bool
    unsafe: int


def proved_maps() -> list[tuple[Model, Blob]]:
    """Return a map of each codec with the guard that its proof needs."""
    recipe = parse_recipe(tripod())
    model = Model(recipe)
    found = []
    for codec, label, integer in MAPS:
        arithmetic = "integer" if integer else "float"
        info = next(one for one in named(codec) if one.refusal(model, arithmetic) is None)
        channels = ("sdg", "tip_angle")
        tables = info.encode(model, channels, info.read_label(label))
        export = Export("faults", recipe, model, info.name, arithmetic, channels, tables)
        blob = describe(export, info.c_body(tables, integer))
        needed = state(recipe, blob.bytes, integer, least=True).needed
        tables = replace(tables, guard=stored_guard(needed))
        export = replace(export, tables=tables)
        found.append((model, describe(export, info.c_body(tables, integer))))
    return found


def seeded(blob: Blob, rng: np.random.Generator) -> Blob:
    """Return a map that the C takes for whole, with one bit changed."""
    while True:
        held = bytearray(blob.bytes)
        held[rng.integers(FIRST, len(held))] ^= 1 << int(rng.integers(8))
        packed = zlib.crc32(bytes(held[4:])).to_bytes(4, "little") + bytes(held[4:])
        wrong = replace(blob, bytes=packed)
        if Host(wrong).check() == 0:
            return wrong


def judge(model: Model, blob: Blob, rng: np.random.Generator) -> Verdict:
    """Prove a map and search it."""
    proved = state(model.recipe, blob.bytes, blob.integer).proved
    return Verdict(proved, search(model, blob, rng))


def search(model: Model, blob: Blob, rng: np.random.Generator) -> int:
    """Return how many directions that tip the C takes for safe."""
    host = Host(blob)
    t = rng.random((POSTURES, model.k))
    t[: POSTURES // 3] = np.rint(t[: POSTURES // 3] * 6.0) / 6.0
    steps = np.rint(t * 32767.0).astype(np.int64)
    params = model.at(steps / 32767.0) if blob.integer else model.at(t).astype(np.float32)
    params = params.astype(np.float64)
    downs = _directions(model, params, rng)
    if blob.integer:
        downs = np.rint(downs / np.abs(downs).max(axis=-1, keepdims=True) * 32767.0)
    else:
        downs = downs.astype(np.float32).astype(np.float64)
    tips = model.exact(params, downs).tip_angle < 0.0
    each = downs.shape[1]
    if blob.integer:
        status, _ = host.read_i(np.repeat(steps, each, axis=0), downs.reshape(-1, 3))
    else:
        status, _ = host.read(np.repeat(params, each, axis=0), downs.reshape(-1, 3))
    return int((tips.reshape(-1) & (status == 0)).sum())


def _directions(model: Model, params: Floats, rng: np.random.Generator) -> Floats:
    """Return directions (m, d, 3): just outside every edge of the true cone, and anywhere."""
    p = model.postures(params).centres
    found = [rng.normal(size=(len(p), 3)), p.sum(axis=1)]
    sign = np.sign(np.linalg.det(p))[:, None]
    for i in range(3):
        a, b = p[:, i], p[:, i - 2]
        normal = sign * np.cross(a, b)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        for share in rng.random((ALONG, len(p), 1)):
            x = (1.0 - share) * a + share * b
            found.append(x / np.linalg.norm(x, axis=1, keepdims=True) - OUTSIDE * normal)
    return np.stack(found, axis=1)


def main(count: int = 25) -> int:
    """Judge maps with faults; 1 where one is proved that is unsafe."""
    rng = np.random.default_rng(7)
    unsound = 0
    for (_, label, integer), (model, blob) in zip(MAPS, proved_maps(), strict=True):
        whole = judge(model, blob, rng)
        seen = Counter(judge(model, seeded(blob, rng), rng) for _ in range(count))
        kinds = Counter[tuple[bool, bool]]()
        for verdict, times in seen.items():
            kinds[verdict.proved, verdict.unsafe > 0] += times
        unsound += kinds[True, True]
        print(
            f"{label}{', integers' if integer else ''}: without a fault "
            f"{'proved' if whole.proved else 'NOT proved'}, {whole.unsafe} unsafe; of "
            f"{count} faults {kinds[True, True]} proved and unsafe, "
            f"{kinds[True, False]} proved and harmless, "
            f"{kinds[False, True]} not proved and unsafe, {kinds[False, False]} not proved, none "
            "found unsafe"
        )
    return int(unsound > 0)


if __name__ == "__main__":
    raise SystemExit(main())

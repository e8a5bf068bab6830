"""smap_check: what was damaged is noticed; `proofs.fuzz` asks what passes."""

import zlib

import numpy as np
import pytest

from firmware_export.host import Host
from firmware_export.model import Model
from firmware_export.protocol import Blob, describe
from lutgen.recipe import parse_recipe
from tests.fixtures.exports import coded_export, noise, rover_export, tripod_export
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import rover, tripod

OK, CORRUPT = 0, 5


def trained():
    return noise("trained", Model(parse_recipe(tripod(chart="sphere"))), (2, 2, 2, 3), ("sdg",))


MAKERS = {
    "contacts": tripod_export,
    "many": lambda: rover_export(text=rover().replace("upright = 90.0", "upright = 80.0")),
    "any contacts": rover_export,
    "an axle that swings": lambda: rover_export(text=(MAPS / "tractor.toml").read_text()),
    "points given by code": lambda: coded_export("coded", "legs"),
    "many given by code": lambda: coded_export("coded", "scissors"),
    "grid": lambda: tripod_export(codec="grid"),
    "grid without floats": lambda: tripod_export(codec="grid", arithmetic="integer"),
    "trained": trained,
}


def blob_of(name):
    return describe(MAKERS[name]())


def changed(blob, content):
    return Blob(content, (), blob.codec, blob.params, blob.integer)


@pytest.mark.parametrize("name", MAKERS)
def test_every_flip_of_one_bit_and_of_two_is_noticed(name):
    blob = blob_of(name)
    assert Host(blob).check() == OK
    bits = 8 * len(blob.bytes)
    rng = np.random.default_rng(1)
    flips = [(at,) for at in range(bits)]
    flips += [tuple(rng.choice(bits, 2, replace=False)) for _ in range(1000)]
    for flip in flips:
        content = bytearray(blob.bytes)
        for at in flip:
            content[at // 8] ^= 1 << at % 8
        assert Host(changed(blob, bytes(content))).check() == CORRUPT, flip


def test_a_trained_table_that_would_lead_astray_is_refused():
    blob = blob_of("trained")
    for part_, shift, value in (
        *(("counts", shift, value) for shift, value in ((0, 3), (1, 0), (1, 7), (2, 2), (4, 6))),
        *(("mirror", shift, value) for shift, value in ((0, 2), (1, 3))),
        *(("axes", shift, value) for shift, value in ((0, 1), (0, 200), (1, 1), (1, 9))),
        *(("knots", shift, value) for shift, value in ((0, 7), (1, 7), (3, 0))),
        *(("first", shift, 255) for shift in (0, 3)),
        *(("limit", shift, 255) for shift in (2, 4, 7)),
    ):
        begins = [at for at, words in blob.sections if words.startswith(f"{part_}:")]
        content = bytearray(blob.bytes)
        at = begins[-1 if part_ == "limit" else 0] + shift
        assert content[at] != value, "would change nothing"
        content[at] = value
        content[:4] = zlib.crc32(content[4:]).to_bytes(4, "little")
        assert Host(changed(blob, bytes(content))).check() == CORRUPT, (part_, shift, value)

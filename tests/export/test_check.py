"""smap_check: what was damaged is noticed, and what passes leads no read astray."""

import zlib
from functools import cache

import numpy as np
import pytest

from firmware_export.host import RUNTIME, Host
from firmware_export.model import Model
from firmware_export.protocol import Blob, describe
from lutgen.recipe import parse_recipe
from tests.fixtures.compiled import compile_c, run
from tests.fixtures.exports import coded_export, noise, rover_export, tripod_export
from tests.fixtures.length import part
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import rover, tripod

OK, CORRUPT = 0, 5


def trained():
    return noise("trained", Model(parse_recipe(tripod(chart="sphere"))), (2, 2, 2, 3), ("sdg",))


# How an export is made, and the family that reads it.
MAKERS = {
    "contacts": (tripod_export, "points"),
    "many": (
        lambda: rover_export(text=rover().replace("upright = 90.0", "upright = 80.0")),
        "rails",
    ),
    "any contacts": (rover_export, "search"),
    "an axle that swings": (
        lambda: rover_export(text=(MAPS / "tractor.toml").read_text()),
        "search",
    ),
    "points given by code": (lambda: coded_export("coded", "legs"), "points"),
    "many given by code": (lambda: coded_export("coded", "scissors"), "search"),
    "grid": (lambda: tripod_export(codec="grid"), "tables"),
    "grid without floats": (lambda: tripod_export(codec="grid", arithmetic="integer"), "tables_i"),
    "trained": (trained, "grid"),
}


def blob_of(name):
    return describe(MAKERS[name][0]())


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


def sealed(content):
    return zlib.crc32(content[4:]).to_bytes(4, "little") + content[4:]


FUZZ = r"""
#define SMAP_FAMILY FAMILY
#include "smap_host.c"
#include <stdio.h>
#include <stdlib.h>

int main(int count, char **names)
{
  FILE *in = count == 2 ? fopen(names[1], "rb") : NULL;
  uint32_t size, passed = 0, all = 0;
  while (in && fread(&size, 4, 1, in) == 1) {
    /* On the heap and of just that size, so that a read beyond an end is seen. */
    uint8_t *blob = malloc(size);
    if (!blob || fread(blob, 1, size, in) != size) {
      return 2;
    }
    all++;
    if (SMAP_HOST_NAME(check)(blob, size) == SMAP_OK) {
      /* Any direction, another for each: what is held of it is another part of the blob. */
      const int aside = (int)(all % 31u) * 100 - 1500, across = (int)(all % 29u) * 100 - 1400;
      float params[64], gravity[3] = {(float)aside, (float)across, -1000.0f};
      int16_t params_q[64], down[3] = {(int16_t)aside, (int16_t)across, -1000};
      smap_reading_t reading;
      smap_reading_i_t reading_i;
      int8_t status;
      int i;
      for (i = 0; i < 64; i++) {
        params[i] = 0.3f;
        params_q[i] = 9000;
      }
      SMAP_HOST_NAME(read)(blob, size, 1, params, gravity, &status, &reading);
      SMAP_HOST_NAME(read_i)(blob, size, 1, params_q, down, &status, &reading_i);
      SMAP_HOST_NAME(at_i)(blob, size, 1, params, down, &status, &reading_i);
      passed++;
    }
    free(blob);
  }
  printf("%u %u\n", (unsigned)all, (unsigned)passed);
  return 0;
}
"""


@pytest.fixture(scope="module")
def fuzzer(tmp_path_factory):
    """Return what gives the program of a family, compiled once."""
    # What is no number may become any whole number: that is how conversions are, and does no harm.
    flags = ["-std=c99", "-O0", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    flags += ["-Wno-unknown-pragmas", '-DSMAP_SOURCES="x"', f"-I{RUNTIME}"]

    @cache
    def of(family):
        folder = tmp_path_factory.mktemp(family)
        (folder / "fuzz.c").write_text(FUZZ.replace("Y FAMILY", f"Y {family}"))
        compile_c([*flags, "fuzz.c", "-o", "fuzz"], folder)
        return folder / "fuzz"

    return of


@pytest.mark.parametrize("name", MAKERS)
def test_what_passes_leads_no_read_out_of_its_bounds(name, fuzzer, tmp_path):
    blob = blob_of(name)
    rng = np.random.default_rng(2)
    cases = [blob.bytes]
    for _ in range(part(20_000, 20)):
        content = bytearray(blob.bytes)
        for at in rng.integers(4, len(content), rng.integers(1, 4)):
            content[at] = rng.integers(0, 256)
        cases.append(sealed(bytes(content)))
    for _ in range(part(2000)):
        size = int(rng.integers(32, 400))
        content = bytearray(rng.integers(0, 256, size).astype(np.uint8).tobytes())
        content[4:8] = size.to_bytes(4, "little")
        content[8:14] = blob.bytes[8:14]
        cases.append(sealed(bytes(content)))
    (tmp_path / "cases").write_bytes(
        b"".join(len(one).to_bytes(4, "little") + one for one in cases)
    )
    program = str(fuzzer(MAKERS[name][1]))
    total, passed = map(int, run(tmp_path, program, "cases").split())
    assert total == len(cases)
    # The first is whole, and some numbers may be any: the test is about those that pass.
    assert 1 < passed < total


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
        damaged = changed(blob, sealed(bytes(content)))
        assert Host(damaged).check() == CORRUPT, (part_, shift, value)

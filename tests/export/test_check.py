"""smap_check: what was damaged is noticed, and what passes leads no read astray."""

import subprocess
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from firmware_export.emit.source import body_of, described
from firmware_export.host import RUNTIME, Host
from firmware_export.protocol import Blob, Export
from firmware_export.truth import Model
from lutgen.recipe import parse_recipe
from targets.cases import of_robot
from targets.noise import noise
from tests.fixtures.compiled import compile_c
from tests.fixtures.exports import coded_export, rover_export, tripod_export
from tests.fixtures.frozen import exports
from tests.fixtures.length import part
from tests.fixtures.recipes import CAR, tripod

OK, CORRUPT = 0, 6


def trees(arithmetic: str) -> Export:
    """Return trees and tables that mean nothing, of all faces."""
    model = Model(parse_recipe(tripod(chart="sphere")))
    shapes = {"sdg": (2, 2, 2, 3), "height": (2, 3)}
    return noise("trees", model, arithmetic, 60, shapes)


def cells(arithmetic: str) -> Export:
    """Return a tree with a directory."""
    return of_robot(parse_recipe(CAR), "cells", "grid", arithmetic, "grid u8 tree 400")


MAKERS: dict[str, Any] = {
    "contacts": tripod_export,
    "many": rover_export,
    "points given by code": lambda: coded_export("coded", "legs"),
    "many given by code": lambda: coded_export("coded", "scissors"),
    "grid": lambda: tripod_export(codec="grid"),
    "grid without floats": lambda: tripod_export(codec="grid", arithmetic="integer"),
    "trees": lambda: trees("float"),
    "trees without floats": lambda: trees("integer"),
    "cells": lambda: cells("float"),
    "cells without floats": lambda: cells("integer"),
}
FAMILY = {
    **{"contacts": "three", "many": "many", "grid": "three"},
    **{"points given by code": "three", "many given by code": "search"},
    **{"trees": "grid", "trees without floats": "whole"},
    **{"cells": "grid", "cells without floats": "whole"},
}


def blob_of(name: str) -> Blob:
    export = MAKERS[name]()
    return described(export, body_of(export))


def changed(blob: Blob, content: bytes) -> Blob:
    return Blob(content, (), blob.codec, blob.params, blob.integer)


@pytest.mark.parametrize("name", MAKERS)
def test_every_flip_of_one_bit_and_of_two_is_noticed(name: str) -> None:
    blob = blob_of(name)
    assert Host(blob).check() == OK
    bits = 8 * len(blob.bytes)
    rng = np.random.default_rng(1)
    flips = [(at,) for at in range(bits)]
    flips += [tuple(rng.choice(bits, 2, replace=False)) for _ in range(4000)]
    for flip in flips:
        content = bytearray(blob.bytes)
        for at in flip:
            content[at // 8] ^= 1 << at % 8
        assert Host(changed(blob, bytes(content))).check() == CORRUPT, flip


def sealed(content: bytes) -> bytes:
    """Return a blob with the CRC-32 that its bytes have."""
    return zlib.crc32(content[4:]).to_bytes(4, "little") + content[4:]


FUZZ = r"""
#include "host_FAMILY.c"
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


@pytest.mark.parametrize("name", FAMILY)
def test_what_passes_leads_no_read_out_of_its_bounds(name: str, tmp_path: Path) -> None:
    blob = blob_of(name)
    rng = np.random.default_rng(2)
    cases = [blob.bytes]
    for _ in range(part(20_000)):
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
    (tmp_path / "fuzz.c").write_text(FUZZ.replace("FAMILY", FAMILY[name]))
    # What is no number may become any whole number: that is how conversions are, and does no harm.
    flags = ["-std=c99", "-O0", "-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    flags += ["-Wno-unknown-pragmas", '-DSMAP_SOURCES="x"', f"-I{RUNTIME}"]
    compile_c([*flags, "fuzz.c", "-o", "fuzz"], tmp_path)
    ran = subprocess.run(
        [tmp_path / "fuzz", tmp_path / "cases"],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert ran.stderr == ""
    total, passed = map(int, ran.stdout.split())
    assert total == len(cases)
    # The first is whole, and some numbers may be any: the test is about those that pass.
    assert 1 < passed < total


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf, 3e38])
def test_a_grid_whose_places_would_be_no_numbers_is_refused(wrong: float) -> None:
    export = next(one for one in exports() if one.name == "grid")
    blob = described(export, body_of(export))
    assert Host(blob).check() == OK
    model = export.model
    # The chart's half, and end and rate of each parameter's axis: before all tables.
    begins = next(at for at, words in blob.sections if words.startswith("half"))
    places = [begins, *(begins + 16 + 12 * i + 4 * n for i in range(model.k) for n in (0, 1))]
    for at in places:
        content = bytearray(blob.bytes)
        content[at : at + 4] = np.float32(wrong).tobytes()
        assert Host(changed(blob, sealed(bytes(content)))).check() == CORRUPT, at


@pytest.mark.parametrize("bits", [4, 5, 6, 7, 255])
def test_a_directory_that_is_larger_than_its_tree_is_refused(bits: int) -> None:
    blob = blob_of("cells")
    at = next(at for at, words in blob.sections if words.endswith("bits of a directory"))
    assert blob.bytes[at] == 3
    content = bytearray(blob.bytes)
    content[at] = bits
    assert Host(changed(blob, sealed(bytes(content)))).check() == CORRUPT

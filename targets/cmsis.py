"""Our reads of a table of two axes beside CMSIS-DSP's bilinear interpolation, on M4F and M3.

    python -m targets.cmsis

Its source comes from the package index when this is run (sdist `cmsisdsp`, Apache-2.0) and stays in
build/.  Both read the same table at the same points, at an equal contract: any input in the units
of the axis, clamped, and NaN does no harm.
"""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from statistics import median_low

import numpy as np

from firmware_export.emit import package
from firmware_export.protocol.exported import Export
from lutgen.errors import LutgenError
from lutgen.recipe.recipe import parse_recipe
from targets.boards import Board, board
from targets.cases import BUILD, CAR, of_noise
from targets.image import CHIP, HERE, CellError, build, compiler, run
from targets.tables import columns

VERSION = "1.10.3"
POINTS = 256
# Units of the chart's limit at which the behaviour is shown.
PROBES = (-1.0, 0.9999, 1.0, 1.000001, 2.0, float("nan"))
READERS = (
    *("f32_bare", "f32_kept", "q31_kept", "q15_kept", "ours_read", "ours_read_i"),
    *("empty", "empty_i", "ours_table", "ours_table_i"),
)
# What is printed: label, reader, the reader that does nothing, bytes of a node.
LINES = (
    ("CMSIS f32, input in nodes", "f32_bare", "empty", 4),
    ("CMSIS f32, equal contract", "f32_kept", "empty", 4),
    ("ours, float, equal contract", "ours_table", "empty", 1),
    ("ours, all of smap_read", "ours_read", "empty_i", 1),
    ("CMSIS q31, equal contract", "q31_kept", "empty_i", 4),
    ("CMSIS q15, equal contract", "q15_kept", "empty_i", 2),
    ("ours, integer, equal contract", "ours_table_i", "empty_i", 1),
    ("ours, all of smap_read_i", "ours_read_i", "empty_i", 1),
)


def fetch() -> Path | None:
    """Return the folder of CMSIS-DSP's source; None if there is neither it nor a network."""
    place = BUILD / "cmsis"
    folder = place / f"cmsisdsp-{VERSION}"
    if folder.is_dir():
        return folder
    place.mkdir(parents=True, exist_ok=True)
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--dest"]
    try:
        done = subprocess.run(
            [*command, str(place), f"cmsisdsp=={VERSION}"],
            capture_output=True,
            text=True,
            timeout=120.0,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return None
    archive = place / f"cmsisdsp-{VERSION}.tar.gz"
    if done.returncode or not archive.is_file():
        return None
    with tempfile.TemporaryDirectory(dir=place) as name:
        with tarfile.open(archive) as tar:
            tar.extractall(name, filter="data")
        (Path(name) / folder.name).replace(folder)
    return folder


def even_table(arithmetic: str = "float") -> Export:
    """Return a table over gravity with evenly spaced nodes, which is all that CMSIS knows."""
    return of_noise(arithmetic, parse_recipe(CAR), 32, {"height": (17, 17)})


def header(export: Export) -> str:
    """Return peer.h: the table for each reader, points inside the chart, probes."""
    part = export.tables.parts[0]
    codes = part.codes.reshape(-1).astype(np.int64)
    values = part.offset[0] + part.step * codes.astype(np.float32)
    limit = np.float32(export.model.chart_limit)
    points = np.random.default_rng(5).uniform(-0.999, 0.999, (POINTS, 2)) * limit

    def floats(array: np.ndarray) -> str:
        return ", ".join(f"{np.float32(x)!s}f" for x in array.reshape(-1))

    probes = ", ".join("0.0f / 0.0f" if x != x else floats(np.array([x])) for x in PROBES)
    return "\n".join(
        [
            f"#define NODES {len(part.knots[0])}",
            f"#define LIMIT {floats(np.array([limit]))}",
            f"#define POINTS {POINTS}",
            f"#define PROBES {len(PROBES)}",
            f"static const float32_t table_f32[] = {{{floats(values)}}};",
            f"static const q31_t table_q31[] = {{{', '.join(str(c << 23) for c in codes)}}};",
            f"static const q15_t table_q15[] = {{{', '.join(str(c << 7) for c in codes)}}};",
            f"static const float points[POINTS][2] = {{{floats(points)}}};",
            f"static const float probes[PROBES] = {{{probes}}};",
            "",
        ]
    )


class Measured:
    """What the image said: instructions and results of each reader, and the probes."""

    def __init__(self, text: str, ticks: float) -> None:
        lines = re.findall(r"^([cvp])([0-9a-f]{8})\s*$", text, re.MULTILINE)
        counts = [round(int(value, 16) / ticks) for kind, value in lines if kind == "c"]
        bits = {
            kind: np.array([int(v, 16) for k, v in lines if k == kind], np.uint32).view(np.float32)
            for kind in "vp"
        }
        names = READERS[: len(counts) // POINTS]
        self.counts = {n: counts[i * POINTS : (i + 1) * POINTS] for i, n in enumerate(names)}
        self.values = {n: bits["v"][i * POINTS : (i + 1) * POINTS] for i, n in enumerate(names)}
        self.probes = bits["p"].reshape(-1, 3)


def measure(source: Path, export: Export, on: Board) -> Measured:
    """Build and run the image."""
    with tempfile.TemporaryDirectory(prefix="targets-") as name:
        folder = Path(name) / "firmware"
        package.write(export, folder)
        # The same table for reads without floats; two exports in one program do not mix.
        whole = replace(even_table("integer"), name="whole")
        package.write(whole, folder / "whole")
        for own in (folder / "whole").glob("whole.*"):
            shutil.copy(own, folder)
        for path in (*CHIP, "chip/peer.c", "chip/peer_i.c", "chip/readers.h"):
            shutil.copy(HERE / path, folder)
        (folder / "queries.bin").write_bytes(b"")
        dsp = source / "Source" / "InterpolationFunctions"
        flags = [*on.flags, "-O2", "-D__GNUC_PYTHON__", "-I.", "-ffunction-sections"]
        flags += [f"-I{source / 'Include'}", f"-I{source / 'PrivateInclude'}"]
        peers = [str(dsp / f"arm_bilinear_interp_{kind}.c") for kind in ("f32", "q31", "q15")]
        parts = ["peer.c", "peer_i.c", "queries.S", *peers]
        command = [compiler(on), *flags, *parts, *on.link, "-o", "image.elf"]
        (folder / "peer.h").write_text(header(export), encoding="utf-8")
        build(command, folder)
        done = run([*on.emulator, "image.elf"], folder)
    if not re.search(r"^e0+100\s*$", done.stdout, re.MULTILINE):
        raise CellError(f"{on.emulator[0]}: exit code {done.returncode}, the image did not end")
    return Measured(done.stdout, on.ticks)


def counts_table(found: dict[str, Measured]) -> str:
    """Return instructions of each reader, minimum, median and maximum on every board."""
    head = ["reader", "B/node", *(f"{name} min/median/max" for name in found)]
    rows = []
    for label, reader, nothing, size in LINES:
        cells = []
        for one in found.values():
            free = median_low(one.counts[nothing])
            counts = sorted(count - free for count in one.counts[reader])
            cells.append(f"{counts[0]}/{median_low(counts)}/{counts[-1]}")
        rows.append([label, str(size), *cells])
    return columns(head, rows)


def edges_table(one: Measured) -> str:
    """Return what is answered at the ends of the axis and beyond."""
    rows = [
        [f"{at:.7g} x limit", *(f"{value:.6g}" for value in row)]
        for at, row in zip(PROBES, one.probes, strict=True)
    ]
    return columns(["u", "CMSIS f32", "with a clamp round it", "ours"], rows)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the tables; return an exit code."""
    boards = [board("m4f"), board("m3")]
    if missing := sorted({name for one in boards for name in one.missing()}):
        print(f"SKIPPED CMSIS-DSP: not installed: apt-get install {' '.join(missing)}")
        return int(os.environ.get("CI") == "true")
    source = fetch()
    if source is None:
        print("SKIPPED CMSIS-DSP: its source cannot be downloaded (pip download cmsisdsp).")
        return 0
    try:
        export = even_table()
        found = {one.title: measure(source, export, one) for one in boards}
    except (LutgenError, CellError) as error:
        print(f"Error: {error}", file=sys.stderr)
        return 1
    first = found[boards[0].title]
    nodes = len(export.tables.parts[0].knots[0])
    print(f"== CMSIS-DSP {VERSION} and ours: a table of {nodes} x {nodes}, -O2, instructions")
    print(counts_table(found))
    print("\n== At the ends of an axis and beyond")
    print(edges_table(first))
    step = float(export.tables.parts[0].step)
    apart = float(np.abs(first.values["ours_table"] - first.values["f32_kept"]).max())
    print(f"\nLargest difference between the two float reads: {apart / step:.2g} codes")
    # Both interpolate the same codes; float32 and places in 1/65534 differ by far less.
    if not apart < 0.05 * step:
        print("FAIL    the two read different tables")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

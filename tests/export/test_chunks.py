"""Tables that are cut into chunks where a compiler makes small objects only, such as avr-gcc."""

import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from firmware_export.certify.answers import device
from firmware_export.emit import package
from firmware_export.emit.config import runtime_file
from firmware_export.emit.source import body_of
from firmware_export.grid.tables import CHUNK, SPAN, Part, U, V
from firmware_export.protocol.exported import Export
from lutgen.quantities import EXPORTABLE
from proofs.exports import tripod_export
from targets.compiled import FLAGS, HostLibrary
from tests.fixtures.programs import run
from tests.fixtures.queries import integer_queries, random_queries

LARGEST = 32767  # bytes of one object of avr-gcc
NEAR = 0x10000  # what its plain reads of flash reach
CHUNKS = (*FLAGS, "-DSMAP_GRID_CHUNKS=1")
KINDS = [("float", 8), ("float", 16), ("integer", 8), ("integer", 16)]
WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Wdouble-promotion"]

needs_avr = pytest.mark.needs("avr-gcc")
COMPILERS = [pytest.param(name, marks=pytest.mark.needs(name)) for name in ("gcc", "clang")]
LANGUAGES = ["c", pytest.param("c++", marks=pytest.mark.needs("g++"))]


def made_up(name: str, bits: int, shape: tuple[int, ...], width: int) -> Part:
    """Return a table of random codes, about half of them above zero; the height's all are."""
    names = (0, 1, V, U)[: len(shape)]
    knots = tuple(np.linspace(0, SPAN, n).round().astype(np.uint16) for n in shape)
    dtype = np.uint8 if bits == 8 else np.uint16
    rng = np.random.default_rng(bits)
    codes = rng.integers(0, 2**bits, (1, *shape, width)).astype(dtype)
    step = np.float32(1.0 / 2**bits)
    offset = np.full(2, 0.1 if name == "height" else -0.5, np.float32)
    return Part(name, names, knots, codes, offset, step)


def large_export(name: str, arithmetic: str, bits: int, tip: int = 21) -> Export:
    """Return an export whose codes mean nothing: more than 64 KiB of them unless `tip` is small."""
    export = tripod_export(name, codec="grid", arithmetic=arithmetic)
    parts = (
        made_up("tip", bits, (13, 13, tip, tip), 1),
        made_up("sdg", bits, (9, 8, 7, 6), 2),
        made_up("height", bits, (9, 9), 1),
    )
    tables = replace(export.tables, parts=parts, channels=EXPORTABLE)
    return replace(export, tables=tables, channels=EXPORTABLE)


@pytest.fixture(scope="module")
def large(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, int], tuple[Export, Path]]:
    """Return an export of each kind and its folder, which no test changes."""
    place = tmp_path_factory.mktemp("large")
    found = {}
    for arithmetic, bits in KINDS:
        export = large_export(f"{arithmetic}_{bits}", arithmetic, bits)
        assert export.tables.bytes > 65536
        package.write(export, place / export.name)
        found[arithmetic, bits] = export, place / export.name
    return found


def answers(
    export: Export, folder: Path, count: int, flags: tuple[str, ...]
) -> tuple[np.ndarray, np.ndarray]:
    """Return what the compiled C answers to random queries, as bits."""
    library = HostLibrary(folder, flags)
    if export.integer:
        status, reading = library.read_i(*integer_queries(export.model, count))
        return status, reading
    status, single = library.read(*random_queries(export.model, count))
    return status, single.view(np.uint32)


@pytest.mark.parametrize("kind", KINDS)
def test_a_table_in_chunks_reads_like_one_in_a_piece_and_on_the_host(
    large: dict[tuple[str, int], tuple[Export, Path]], kind: tuple[str, int]
) -> None:
    export, folder = large[kind]
    status, reading = answers(export, folder, 100_000, FLAGS)
    cut_status, cut = answers(export, folder, 100_000, CHUNKS)
    np.testing.assert_array_equal(cut_status, status)
    np.testing.assert_array_equal(cut, reading)
    # Readings that a constant, or a table of which one chunk only is read, would not give.
    assert np.bincount(status + 1, minlength=5).min() > 20
    assert len(np.unique(reading[status == 0], axis=0)) > 10_000
    make = integer_queries if export.integer else random_queries
    host_status, host = device(export).read(*make(export.model, 100_000))
    np.testing.assert_array_equal(host_status, cut_status)
    np.testing.assert_array_equal(host if export.integer else host.view(np.uint32), cut)


def test_no_query_reads_beyond_a_chunk(
    large: dict[tuple[str, int], tuple[Export, Path]],
) -> None:
    sanitizers = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g")
    for kind in (("float", 16), ("integer", 8)):
        export, folder = large[kind]
        queries = integer_queries if export.integer else random_queries
        params, gravity = queries(export.model, 20_000)
        status, _ = HostLibrary(folder, CHUNKS).run_driver(params, gravity, sanitizers)
        assert np.unique(status).tolist() == [-1, 0, 1, 2, 3]


@pytest.mark.parametrize("arithmetic", ["float", "integer"])
def test_a_runtime_for_chunks_reads_small_tables_as_before(arithmetic: str, tmp_path: Path) -> None:
    export = large_export("small", arithmetic, 8, tip=5)
    package.write(export, tmp_path / "small")
    assert "CUT" not in (tmp_path / "small" / "small.c").read_text()
    assert "__AVR__" not in (tmp_path / "small" / "small.c").read_text()
    status, reading = answers(export, tmp_path / "small", 20_000, FLAGS)
    cut_status, cut = answers(export, tmp_path / "small", 20_000, CHUNKS)
    np.testing.assert_array_equal(cut_status, status)
    np.testing.assert_array_equal(cut, reading)


def test_tables_are_cut_once_they_are_too_large_together() -> None:
    # Codes: 169 n^2 of the tip margin and 6,129 more.
    for tip, cut in ((12, False), (13, True)):
        export = large_export("edge", "float", 8, tip)
        codes = sum(part.codes.nbytes for part in export.tables.parts)
        assert (codes > LARGEST) == cut
        assert max(part.codes.nbytes for part in export.tables.parts) <= LARGEST
        assert body_of(export).chunked == cut


def test_the_exporter_and_the_runtime_agree_on_the_size_of_a_chunk() -> None:
    found = re.search(r"#define SMAP_CHUNK_BITS (\d+) ", runtime_file("smap.h"))
    assert found is not None
    assert 1 << int(found[1]) == CHUNK
    assert CHUNK * np.dtype(np.uint16).itemsize <= LARGEST


@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("language", LANGUAGES)
def test_a_build_in_chunks_compiles_without_a_warning(
    large: dict[tuple[str, int], tuple[Export, Path]], language: str, compiler: str
) -> None:
    standard = "c99" if language == "c" else "c++17"
    options = ["-x", language, f"-std={standard}", "-ffp-contract=off", *WARNINGS, *CHUNKS[-1:]]
    for export, folder in large.values():
        names = [f"{export.name}.c", "smap.c", "example.c"]
        run(folder, compiler, *options, "-fsyntax-only", *names)


# avr-gcc


def sections(folder: Path, name: str) -> dict[str, int]:
    """Return the bytes of the sections of an object that take RAM or flash."""
    text = run(folder, "avr-size", "-A", name)
    found = re.findall(r"^\.(data|bss|rodata|progmem|text)\S*\s+(\d+)", text, re.MULTILINE)
    return {section: sum(int(n) for s, n in found if s == section) for section, _ in found}


# What Arduino compiles with, what a debugger wants, and what moves objects about.
OPTIONS = [["-Os"], ["-O0"], ["-Os", "-ffunction-sections", "-fdata-sections"]]


@needs_avr
@pytest.mark.parametrize("options", OPTIONS, ids=" ".join)
@pytest.mark.parametrize("kind", KINDS)
def test_on_avr_chunks_lie_anywhere_in_flash_and_all_else_within_reach(
    large: dict[tuple[str, int], tuple[Export, Path]],
    tmp_path: Path,
    kind: tuple[str, int],
    options: list[str],
) -> None:
    export, folder = large[kind]
    copy = shutil.copytree(folder, tmp_path / "copy")
    # Another module's constants, linked last, must stay within reach of plain reads too.
    (copy / "other.c").write_text("const __flash char other[] = {1, 2, 3};\n")
    names = ("example", "smap", export.name, "other")
    flags = ["-mmcu=atmega2560", "-std=gnu99", "-Wall", "-Wextra", "-Wno-unused-variable"]
    for name in names:
        run(copy, "avr-gcc", *flags, *options, "-c", f"{name}.c")
    for name in ("smap", export.name):
        used = sections(copy, f"{name}.o")
        assert (used.get("data", 0), used.get("bss", 0), used.get("rodata", 0)) == (0, 0, 0)
    run(copy, "avr-gcc", *flags, *[f"{name}.o" for name in names], "-o", "program.elf")
    listing = run(copy, "avr-nm", "-S", "program.elf")
    symbols = {
        name: (int(address, 16), int(size, 16))
        for address, size, name in re.findall(r"^(\w+) (\w+) \w (\w+)$", listing, re.MULTILINE)
    }
    chunks = {name: symbols[name] for name in symbols if re.search(r"_codes_\d+_data$", name)}
    assert sum(size for _, size in chunks.values()) == export.tables.bytes - sum(
        array.bytes for array in body_of(export).arrays if not array.chunk
    )
    assert max(size for _, size in symbols.values()) <= LARGEST
    # RAM begins at 0x800000.
    assert NEAR < max(address + size for address, size in chunks.values()) < 0x40000
    near = [name for name in symbols if name.startswith(export.name) and "_codes_" not in name]
    near += ["other", *(name for name in symbols if name.endswith("_codes"))]
    assert {f"{export.name}", f"{export.name}_body", f"{export.name}_tip_codes"} <= set(near)
    assert max(symbols[name][0] + symbols[name][1] for name in near) < NEAR


@needs_avr
def test_on_avr_a_large_and_a_small_map_share_one_runtime(
    large: dict[tuple[str, int], tuple[Export, Path]], tmp_path: Path
) -> None:
    export, folder = large["float", 8]
    package.write(large_export("small", "float", 8, tip=5), tmp_path / "small")
    copy = shutil.copytree(folder, tmp_path / "copy")
    for name in ("small.c", "small.h"):
        shutil.copy(tmp_path / "small" / name, copy)
    flags = ["-mmcu=atmega2560", "-std=gnu99", "-Os", "-Wall", "-Wextra"]
    sources = [f"{export.name}.c", "small.c", "smap.c", "example.c"]
    run(copy, "avr-gcc", *flags, *sources, "-o", "program.elf")
    # The small map's configuration does not do for the large one, and says so.
    shutil.copy(tmp_path / "small" / "smap_config.h", copy)
    command = ["avr-gcc", *flags, "-c", f"{export.name}.c"]
    done = subprocess.run(command, cwd=copy, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert f'#error "{export.name} needs SMAP_GRID_CHUNKS 1' in done.stderr


@needs_avr
@pytest.mark.parametrize(("part", "standard"), [("atmega2560", "c99"), ("atmega644p", "gnu99")])
def test_without_far_addresses_chunks_are_plain_objects(
    tmp_path: Path, part: str, standard: str
) -> None:
    export = large_export("edge", "float", 8, 13)
    package.write(export, tmp_path / "edge")
    for name in ("edge", "smap"):
        flags = [f"-mmcu={part}", f"-std={standard}", "-Os", "-Wall", "-Wextra"]
        run(tmp_path / "edge", "avr-gcc", *flags, "-c", f"{name}.c")
    used = sections(tmp_path / "edge", "edge.o")
    # Strict C knows no address space: constants are then in RAM.
    assert used["progmem" if standard == "gnu99" else "rodata"] > LARGEST


@needs_avr
def test_half_a_choice_of_address_spaces_is_refused(
    large: dict[tuple[str, int], tuple[Export, Path]],
) -> None:
    export, folder = large["float", 8]
    command = ["avr-gcc", "-mmcu=atmega2560", "-std=gnu99", "-DSMAP_FLASH=__flash", "-fsyntax-only"]
    done = subprocess.run(
        [*command, f"{export.name}.c"], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode != 0
    assert "set both, or neither" in done.stderr

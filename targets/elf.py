"""What an object file or an image says of itself: bytes of its sections, and its symbols."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from elftools.elf.elffile import ELFFile

WRITE, ALLOC = 1, 2


def _elf(path: Path) -> Iterator[Any]:
    with path.open("rb") as file:
        yield from ELFFile(file).iter_sections()


def section_bytes(path: Path, *names: str) -> int:
    """Return the bytes of all sections whose names begin with one of these."""
    return sum(s["sh_size"] for s in _elf(path) if s.name.startswith(names))


def memory(path: Path) -> tuple[int, int]:
    """Return the bytes of flash and RAM that an image takes, without its stack."""
    flash = ram = 0
    for section in _elf(path):
        if not section["sh_flags"] & ALLOC or "stack" in section.name:
            continue
        written, empty = section["sh_flags"] & WRITE, section["sh_type"] == "SHT_NOBITS"
        ram += section["sh_size"] if written else 0
        flash += 0 if empty else section["sh_size"]
    return flash, ram


def _symbols(path: Path) -> Iterator[tuple[str, Any, Any]]:
    """Yield the name, the section's number or word, and the entry of each symbol."""
    for table in _elf(path):
        if table["sh_type"] == "SHT_SYMTAB":
            for symbol in table.iter_symbols():
                yield symbol.name, symbol["st_shndx"], symbol


def undefined(path: Path) -> set[str]:
    """Return the symbols that an object file takes from elsewhere."""
    return {name for name, at, _ in _symbols(path) if at == "SHN_UNDEF" and name}


def writable(path: Path) -> set[str]:
    """Return the variables of an object file that lie in memory that can be written."""
    written = [bool(section["sh_flags"] & WRITE) for section in _elf(path)]
    return {
        name
        for name, at, symbol in _symbols(path)
        if symbol["st_info"]["type"] == "STT_OBJECT"
        and (at == "SHN_COMMON" or (isinstance(at, int) and written[at]))
    }

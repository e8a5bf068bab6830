"""Functions and instructions of a Thumb image, from what ``objdump -dl`` prints."""

import re
from dataclasses import dataclass, field

from lutgen.errors import ExportError

CONDITIONS = "eq|ne|cs|cc|hs|lo|mi|pl|vs|vc|hi|ls|ge|lt|gt|le"
INSTRUCTION = re.compile(r"^\s*([0-9a-f]+):\t(\S+)\s*(.*)$")
TARGET = re.compile(r"([0-9a-f]+) <([\w.]+)(?:\+0x[0-9a-f]+)?>")


@dataclass
class Instruction:
    """One instruction: where, of which line of smap.c, and where it may go on."""

    address: int
    line: int | None
    calls: str | None = None
    targets: list[int] = field(default_factory=list)
    falls: bool = True


def parse(listing: str) -> dict[str, list[Instruction]]:
    """Return the functions of ``objdump -dl`` of a Thumb image."""
    functions: dict[str, list[Instruction]] = {}
    name, line = "", None
    for text in listing.splitlines():
        if found := re.match(r"^[0-9a-f]+ <([\w.]+)>:", text):
            name, line = found[1], None
            functions[name] = []
        elif found := re.match(r"^\S*?([^/\s]+):(\d+)(?: \(discriminator \d+\))?$", text):
            line = int(found[2]) if found[1] == "smap.c" else None
        elif name and (found := INSTRUCTION.match(text)):
            if found[2].startswith("."):
                continue
            functions[name].append(_decode(int(found[1], 16), found[2], found[3], name, line))
    return functions


def _decode(
    address: int, mnemonic: str, operands: str, function: str, line: int | None
) -> Instruction:
    """Return an instruction with where it leads."""
    result = Instruction(address, line)
    op = mnemonic.split(".")[0]
    to = TARGET.search(operands)
    jumps = operands.startswith("pc,") and not (op == "ldr" and "[sp" in operands)
    if op in ("tbb", "tbh") or jumps:
        raise ExportError(f"{function}: a table of branches is not followed (got {mnemonic}).")
    if op in ("bl", "blx") or (op == "bx" and "lr" not in operands):
        if to is None:
            raise ExportError(f"{function}: a call by address (got {mnemonic} {operands}).")
        result.calls = to[2]
    elif to is not None and re.fullmatch(rf"b({CONDITIONS})?|cbn?z", op):
        if to[2] == function:
            result.targets.append(int(to[1], 16))
        else:
            result.calls = to[2]
        result.falls = op != "b"
    elif op == "bx" or (op in ("pop", "ldmia", "ldr") and re.search(r"\bpc\b", operands)):
        result.falls = op == "ldr" and "[pc" in operands
    return result

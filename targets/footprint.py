"""Bytes of code and stack of the runtime as a board's compiler makes it."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from targets.boards import Board
from targets.size import deepest

# Bytes that a call pushes on an AVR of more than 128 KiB of flash, and of less.
RETURN = {"mega2560": 3, "mega328p": 2}
# A pose with floats never calls it: it makes one of integers alone, all of it on the stack.
APART = "smap_pose_whole"


@dataclass(frozen=True)
class Footprint:
    """Bytes.

    `code` is that of NAME.o, without the blob.  `stack` is that of the deepest chain of calls; None
    where the compiler does not tell.  `calls` has that of each call of smap.h, of poses with
    floats where the export has floats.
    """

    code: int
    stack: int | None
    calls: dict[str, int] = field(default_factory=dict)


def footprint(
    name: str,
    board: Board,
    flags: list[str],
    folder: Path,
    build: Callable[[list[str], Path], None],
    run: Callable[[list[str], Path], Any],
    entries: Mapping[str, str],
) -> Footprint:
    """Compile the map with its runtime to an object in `folder` and measure it.

    `entries` names the function that answers a call.
    """
    tool = f"{board.prefix}gcc" if board.prefix else "clang"
    asks = {"avr": ["-fstack-usage"], "wasm": []}.get(board.family, ["-fcallgraph-info=su"])
    build([tool, *flags, *asks, "-c", f"{name}.c", "-o", f"{name}.o"], folder)
    if board.family == "wasm":
        return Footprint(_wasm_code((folder / f"{name}.o").read_bytes()), None)
    listing = run([f"{board.prefix}size", "-A", f"{name}.o"], folder).stdout
    sizes = re.findall(r"^\.text\S*\s+(\d+)", listing, re.MULTILINE)
    code = sum(map(int, sizes))
    if board.family == "avr":
        return Footprint(code, *_avr_stack(name, board, folder, run, entries))
    graph = (folder / f"{name}.ci").read_text(encoding="utf-8")
    stacks = {call: deepest(graph, entry, APART) for call, entry in entries.items()}
    return Footprint(code, deepest(graph), stacks)


def _avr_stack(
    name: str,
    board: Board,
    folder: Path,
    run: Callable[[list[str], Path], Any],
    entries: Mapping[str, str],
) -> tuple[int, dict[str, int]]:
    """Return the deepest chains: .su has each function's bytes, the listing who calls whom.

    avr-gcc 5 writes no call graph.  Its own arithmetic is not counted, as on the other boards.
    """
    own = {
        function: int(size) + RETURN[board.name]
        for function, size in re.findall(
            r"^\S+:(\w+)\s+(\d+)\s",
            (folder / f"{name}.su").read_text(encoding="utf-8"),
            re.MULTILINE,
        )
    }
    calls: dict[str, set[str]] = {function: set() for function in own}
    here = ""
    for line in run([f"{board.prefix}objdump", "-dr", f"{name}.o"], folder).stdout.splitlines():
        if found := re.match(r"^[0-9a-f]+ <([\w.]+)>:", line):
            here = found[1]
        elif (found := re.search(r"R_AVR_(?:CALL|13_PCREL)\s+([\w.]+)", line)) and here in calls:
            target = found[1].removeprefix(".text.")
            if target in own and target != here:
                calls[here].add(target)

    def depth(function: str, without: str = "") -> int:
        below = (depth(called, without) for called in calls[function] if called != without)
        return own[function] + max(below, default=0)

    stacks = {call: depth(entry, APART) for call, entry in entries.items() if entry in own}
    return max(map(depth, own), default=0), stacks


def _wasm_code(data: bytes) -> int:
    """Return the bytes of a wasm object's code section, number 10."""
    at = 8
    while at < len(data):
        kind, at = data[at], at + 1
        size = shift = 0
        while True:
            byte, at = data[at], at + 1
            size |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                break
        if kind == 10:
            return size
        at += size
    return 0

"""The hash of answers: FNV-1a, 32 bits, over status and all bits of the reading of each call."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.fixtures.exports import PosingHost

START = 2166136261
PRIME = 16777619

Queries = tuple[NDArray[Any], NDArray[Any]]


def fnv1a(data: bytes, start: int = START) -> int:
    """Return the FNV-1a hash of bytes, going on from `start`."""
    value = start
    for byte in data:
        value = ((value ^ byte) * PRIME) & 0xFFFFFFFF
    return value


def answer_bytes(status: NDArray[Any], reading: NDArray[Any]) -> NDArray[np.uint8]:
    """Return answers (m,) as they are hashed: status, then the members of the struct."""
    members = [np.asarray(status, np.int8)]
    members += [np.ascontiguousarray(reading[name]) for name in reading.dtype.names or ()]
    rows = [one.view(np.uint8).reshape(len(reading), -1) for one in members]
    return np.concatenate(rows, axis=1)


def answers(host: PosingHost, floats: bool, integers: bool, real: Queries, whole: Queries) -> bytes:
    """Return all answers of a map to queries, in the order in which chip/image.c asks.

    `real` and `whole` are parameters (m, k) and gravity (m, 3), in floats and as whole numbers;
    those of a form that its poses do not have are not looked at.
    """
    found = list[NDArray[np.uint8]]()
    if floats:
        found.append(answer_bytes(*host.ask("read", *real)))
        made, one, two = list[Any](), list[Any](), list[Any]()
        for params, down in zip(*real, strict=True):
            said, status, reading = host.at(params, np.stack([down, -down]))
            made.append(said)
            one.append(answer_bytes(status, reading)[0])
            worst = max(status)
            two.append(answer_bytes(np.array([worst, worst]), reading)[1])
        found += [np.array(made, np.int8).view(np.uint8)[:, None], np.stack(one), np.stack(two)]
    if integers and floats:
        turns = [
            answer_bytes(*host.at(params, down[None], integer=True)[1:])[0]
            for params, down in zip(real[0], whole[1], strict=True)
        ]
        found += [np.stack(turns)] * 2
    if integers:
        read = answer_bytes(*host.ask("read_i", *whole))
        found += [read] if floats else [read, read]
    return np.concatenate(found, axis=1).tobytes()

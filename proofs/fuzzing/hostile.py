"""Values that nobody should write, and the changes that every kind of input shares."""

import random
from typing import Any

from proofs.toml import Raw

__all__ = ["NAMES", "NUMBERS", "anything", "damaged", "number", "pick", "scaled", "text_number"]

NUMBERS: tuple[Any, ...] = (
    *(0, -0.0, 1, -1, 1e-320, 1e-300, 1e-12, 0.5, 90.0, 180.0, 360.0, 1e6, 1e15, 1e150, 1e300),
    *(1.7e308, -1e300, float("nan"), float("inf"), -float("inf"), True, 2**31, 2**53 + 1),
    *(2**63 - 1, 2**63, -(2**63), 10**9, 10**30, Raw("9" * 5000), Raw("0x" + "f" * 3000)),
)
NAMES = (
    *(
        "",
        " ",
        "a b",
        "a.b",
        "ü",
        "日本語",
        "\u202eevil",
        "\x1b[31mred",
        "\x00",
        "a\nb",
        "-o",
        "--",
    ),
    *("../../x", "*/", "??/", "%n%s", "{0}", "$(id)", "<script>", "]]>", "a" * 10000),
    *("body", "nan", "__class__", "status", "CON", "é", "e\u0301", "\ufeff", "\U0001d4b3" * 50),
)
WRONG: tuple[Any, ...] = ("x", "", [], {}, [[]], [1], {"a": 1}, [1, "x"], False, Raw("07:32:00"))


def pick(rng: random.Random, values: Any) -> Any:
    """Return one of some values."""
    return values[rng.randrange(len(values))]


def scaled(rng: random.Random, value: float) -> float:
    """Return a number near to another, or far off it by powers of ten."""
    factor = pick(rng, (-1.0, 0.0, 0.5, 0.999999999, 1.000000001, 2.0, 10.0, 1e-9, 1e9, 1e200))
    return float(value) * float(factor)


def number(rng: random.Random) -> Any:
    """Return a number that is rarely meant."""
    return pick(rng, NUMBERS) if rng.random() < 0.7 else scaled(rng, rng.uniform(-100, 100))


def anything(rng: random.Random) -> Any:
    """Return a value of any type."""
    return pick(rng, (number(rng), pick(rng, NAMES), pick(rng, WRONG)))


def text_number(rng: random.Random) -> str:
    """Return a number as a file of columns or of attributes has it, or what is none."""
    odd = ("", " ", "nan", "-inf", "1e999", "0x10", "1_000", "1,5", "1e", "٣", "--1", "1 2", "\x00")
    return str(number(rng)) if rng.random() < 0.6 else str(pick(rng, odd))


def damaged(rng: random.Random, data: bytes) -> bytes:
    """Return bytes that were cut, doubled, turned over or overwritten somewhere."""
    if not data:
        return b"\x00"
    at, most = rng.randrange(len(data)), min(len(data), 64)
    span = rng.randrange(1, most + 1)
    how = rng.randrange(6)
    if how == 0:
        return data[:at]
    if how == 1:
        return data[:at] + data[at + span :]
    if how == 2:
        return data[:at] + data[at : at + span] * rng.randrange(2, 50) + data[at:]
    if how == 3:
        return data[:at] + bytes([data[at] ^ (1 << rng.randrange(8))]) + data[at + 1 :]
    if how == 4:
        return data[:at] + rng.randbytes(span) + data[at + span :]
    piece: bytes = pick(
        rng, (b"\x00", b"\xff" * 8, b"\xef\xbb\xbf", b"\r", b"\n" * 9, b"[" * 3000, b'"""')
    )
    return data[:at] + piece + data[at:]

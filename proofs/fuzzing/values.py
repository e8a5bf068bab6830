"""Values that nobody should write, damaged bytes, and sound files to start from."""

import functools
import math
import tempfile
from pathlib import Path
from typing import Any

from hypothesis import strategies as st

from lutgen.mapping import sweep
from lutgen.recipe import parse_recipe
from proofs.toml import Raw
from tests.fixtures.recipes import rover, tripod

ROOT = Path(__file__).resolve().parent.parent.parent
NUMBERS: tuple[Any, ...] = (
    *(0, -0.0, 1, -1, 1e-320, 1e-300, 1e-12, 0.5, 90.0, 180.0, 360.0, 1e6, 1e15, 1e150, 1e300),
    *(1.7e308, -1e300, math.nan, math.inf, -math.inf, True, 2**31, 2**53 + 1, 2**63 - 1, 2**63),
    *(-(2**63), 10**9, 10**30, Raw("9" * 5000), Raw("0x" + "f" * 3000)),
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
    *("../../x", "*/", "??/", "%n%s", "{0}", "$(id)", "<script>", "]]>", "a" * 10000, "body"),
    *("nan", "__class__", "status", "CON", "é", "e\u0301", "\ufeff", "\U0001d4b3" * 50),
)
WRONG: tuple[Any, ...] = ("x", [], {}, [[]], [1], {"a": 1}, [1, "x"], False, Raw("07:32:00"))
ODD = ("", " ", "nan", "-inf", "1e999", "0x10", "1_000", "1,5", "1e", "٣", "--1", "1 2", "\x00")
ANYTHING = st.sampled_from(NUMBERS) | st.sampled_from(NAMES) | st.sampled_from(WRONG)
# A number as a file of columns or of attributes has it, or what is none.
TEXTS = st.one_of(
    st.floats(-1.0, 1.0).map(repr), st.sampled_from(NUMBERS).map(str), st.sampled_from(ODD)
)
PIECES = (b"", b"\x00", b"\xff" * 8, b"\xef\xbb\xbf", b"\r", b"\n" * 9, b"[" * 3000, b'"""')
# Code that nobody asked for must not run: this would leave a file behind.
SPY = b'open("it ran", "w").close()\ndef contacts(p):\n    return {}\n'


@st.composite
def damaged(draw: st.DrawFn, data: bytes) -> bytes:
    """Draw bytes that were cut, doubled or overwritten somewhere."""
    at, span = draw(st.integers(0, len(data))), draw(st.integers(0, 64))
    piece = draw(st.sampled_from(PIECES) | st.binary(max_size=16))
    times = draw(st.sampled_from((0, 0, 1, 30)))
    end = draw(st.sampled_from((len(data), len(data), at)))
    return data[:at] + piece + data[at : at + span] * times + data[at + span : end]


@functools.cache
def recipes() -> dict[str, str]:
    """Return recipes by name: two of the proofs, and those to start from."""
    starts = sorted((ROOT / "lutgen" / "recipe" / "starts").glob("*.toml"))
    own = {"tripod": tripod(nodes=5), "rover": rover(nodes=5)}
    return own | {path.stem: path.read_text("utf-8") for path in starts}


@functools.cache
def swept(name: str = "tripod") -> bytes:
    """Return the map of a recipe of these as the bytes of its file."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "map.h5"
        sweep(parse_recipe(recipes()[name], f"{name}.toml"), file, threads=1)
        return file.read_bytes()

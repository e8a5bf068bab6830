"""Words that nobody should write, beside those that Hypothesis knows, and damaged texts."""

import re

from hypothesis import strategies as st

ODD = ("9" * 5000, "[" * 50_000, "{ a = " * 50_000, "<a>" * 50_000, "a" * 9999, "1e999", "07:32:00")
RUDE = ("-o", "../../x", "%n%s", "$(id)", "]]>", "\x1b[31m", "\x00", '""', "[]", "{}", '[1, "x"]')
LETTERS = st.text(st.characters(exclude_categories=["Cs"]), max_size=9)
WORDS = st.floats().map(repr) | st.integers().map(str) | LETTERS | st.sampled_from(ODD + RUDE)


@st.composite
def damaged(draw: st.DrawFn, data: bytes) -> bytes:
    """Draw bytes that were cut, doubled or overwritten somewhere."""
    at, span = draw(st.integers(0, len(data))), draw(st.integers(0, 64))
    times, end = draw(st.sampled_from((0, 0, 1, 30))), draw(st.sampled_from((None, None, at)))
    return data[:at] + draw(st.binary()) + data[at : at + span] * times + data[at + span : end]


@st.composite
def mutated(draw: st.DrawFn, text: str) -> bytes:
    """Draw a text of which up to three words, and what follows them, are changed."""
    parts = re.split(r"([\w.+-]+)", text)
    new = WORDS | st.sampled_from(parts)  # names that are there make cycles of links
    for _ in range(draw(st.integers(0, 3))):
        at, span = draw(st.integers(0, len(parts) - 1)), draw(st.sampled_from((1, 1, 1, 2, 6)))
        parts[at : at + span] = [draw(new)] * draw(st.sampled_from((1, 1, 1, 30)))
    data = "".join(parts).encode()
    return draw(damaged(data)) if draw(st.integers(0, 9)) == 0 else data

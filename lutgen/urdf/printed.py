"""Angles as descriptions print them: 1.57 is a quarter of a turn.

A wheel whose axle is printed so is not level, and no two of them are parallel, but for what the
printing lost.
"""

import math

from lutgen.vector import Vector

# From how many decimals on a number is one of these parts of a turn, where its digits say so.
PARTS = ((math.pi / 2.0, 2), (math.pi / 4.0, 3), (math.pi / 12.0, 4))
# Nearer (rad) it is the part whatever its digits: single precision has no more of them.
SINGLE = 5e-7


def meant(text: str) -> float:
    """Return the angle (rad) that a printed number stands for.

    A part of a turn where the text is that number cut off or rounded at its last decimal: of
    quarters from two decimals on (1.57, 3.14), of eighths from three (0.785), of twenty-fourths
    from four (0.5236).  Any other number is what it says.
    """
    value = float(text)
    decimals = len(text.lower().partition("e")[0].partition(".")[2])
    plain = "e" not in text.lower()
    for part, least in PARTS:
        count = round(value / part)
        exact = count * part
        if count == 0 or abs(count) > 2.0 * math.pi / part + 0.5:
            continue
        off, last = abs(value - exact), 10.0**-decimals
        # A number cut off is nearer to zero than what it stands for.
        digits = off <= 0.5 * last * (1.0 + 1e-9) or (off < last and abs(value) < abs(exact))
        if off <= SINGLE or (plain and decimals >= least and digits):
            return exact
    return value


def parts_of_turns(printed: str) -> tuple[Vector, list[str]]:
    """Return the angles (rad) that three printed numbers stand for, and those that differ."""
    texts = printed.split()
    x, y, z = (meant(text) for text in texts)
    pairs = zip(texts, (x, y, z), strict=True)
    return (x, y, z), [text for text, angle in pairs if abs(float(text) - angle) > SINGLE]

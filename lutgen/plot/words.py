"""Words that are broken into lines, whatever they are and whoever wrote them."""

import re
from collections.abc import Sequence
from typing import Any

from matplotlib.text import Text

# What is not broken: a formula, or letters without a space.
_WORD = re.compile(r"(?:(?<!\\)\$[^$\n]*(?<!\\)\$|\\\$|[^\s$])+|\n")


def printed(text: str) -> int:
    r"""Return how many characters a text takes in print: a formula counts as one.

    Examples
    --------
    >>> printed(r"$\alpha$ = 3")
    5
    """
    return len(re.sub(r"(?<!\\)\$.*?(?<!\\)\$", "x", text))


def folded(text: str, longest: int) -> str:
    r"""Return a text in lines of at most so many characters; longer words are cut.

    Examples
    --------
    >>> folded("front left wheel", 11)
    'front left\nwheel'
    """
    lines = [""]
    for word in _WORD.findall(text):
        if word == "\n":
            lines.append("")
            continue
        space = " " if lines[-1] else ""
        if lines[-1] and printed(lines[-1] + space + word) > longest:
            lines.append("")
            space = ""
        while printed(word) > longest and "$" not in word:
            # Behind a mark that joins words, if there is one.
            cut = max(word.rfind("_", 0, longest), word.rfind("-", 0, longest)) + 1 or longest
            lines[-1] += space + word[:cut]
            lines.append("")
            word, space = word[cut:], ""
        lines[-1] += space + word
    return "\n".join(lines)


def fit(text: Text, width: float, lengths: Sequence[int]) -> None:
    """Fold a text of a figure into lines of at most `width` inches, trying `lengths` of letters."""
    words, figure = text.get_text(), text.get_figure(root=True)
    canvas: Any = figure.canvas if figure is not None else None
    for longest in lengths:
        text.set_text(folded(words, longest))
        box = text.get_window_extent(canvas.get_renderer())
        if max(box.width, 0.0) <= width * canvas.figure.dpi:
            return

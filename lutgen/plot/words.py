"""Words that are broken into lines, whatever they are and whoever wrote them."""

import re

# What is not broken: a formula, or letters without a space.
_WORD = re.compile(r"(?:\$[^$\n]*\$|[^\s$])+|\n")


def printed(text: str) -> int:
    r"""Return how many characters a text takes in print: a formula counts as one.

    Examples
    --------
    >>> printed(r"$\alpha$ = 3")
    5
    """
    return len(re.sub(r"\$.*?\$", "x", text))


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
            # Behind a mark that joins words, where there is one.
            cut = max(word.rfind("_", 0, longest), word.rfind("-", 0, longest)) + 1 or longest
            lines[-1] += space + word[:cut]
            lines.append("")
            word, space = word[cut:], ""
        lines[-1] += space + word
    return "\n".join(lines)

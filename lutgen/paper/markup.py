"""Words of the page as HTML: code between backticks, formulas between dollar signs.

Owns the notation: in a formula `_` and `^` begin an index and an exponent of letters and digits,
Latin and Greek letters are italic, names of functions upright, and a minus is a minus.
"""

import html
import re

GREEK = {"alpha": "\u03b1", "gamma": "\u03b3", "delta": "\u03b4", "sigma": "\u03c3"}
UPRIGHT = {"sin", "cos", "atan", "min", "max", "\u03a3", "\u03c0"}
MINUS = "\u2212"
# A word, or an index or exponent with its mark.
TOKEN = re.compile(r"([_^])(\w+)|([^\W\d_]+)|[-<>&]")


def inline(text: str) -> str:
    """Return one line of text as HTML.

    Examples
    --------
    >>> inline("`a<b`: $D_g > sin^2$")
    '<code>a&lt;b</code>: <span class="formula"><i>D</i><sub>g</sub> &gt; sin<sup>2</sup></span>'
    """
    parts = re.split(r"`([^`]+)`|\$([^$]+)\$", text)
    done = []
    for words, code, formula in zip(
        parts[::3], [*parts[1::3], None], [*parts[2::3], None], strict=True
    ):
        done.append(html.escape(minus(words), quote=False))
        if code:
            done.append(f"<code>{html.escape(code)}</code>")
        if formula:
            done.append(f'<span class="formula">{TOKEN.sub(_token, formula)}</span>')
    return "".join(done)


def plain(text: str) -> str:
    """Return one line of text without marks, for tables of numbers and alternative texts."""
    return re.sub(r"[`$]", "", text)


def minus(text: str) -> str:
    """Return text with true minus signs before its numbers."""
    return re.sub(r"(?<![\w\u2013)])-(?=\d)", MINUS, text)


def _token(match: re.Match[str]) -> str:
    mark, index, word = match.groups()
    if mark:
        tag = "sub" if mark == "_" else "sup"
        return f"<{tag}>{index}</{tag}>"
    if not word:
        return MINUS if match[0] == "-" else html.escape(match[0])
    letters = GREEK.get(word, word)
    return letters if letters in UPRIGHT else f"<i>{letters}</i>"

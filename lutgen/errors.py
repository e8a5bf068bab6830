"""The errors that lutgen raises on purpose.

Every message is one sentence: where (file and key), what is wrong, the value
received, and the way out.  Each class is also the builtin that a caller would
expect, so that code which does not know lutgen can still catch it.
"""

import difflib
from collections.abc import Iterable
from importlib import import_module
from typing import Any, NoReturn

# Names that a message lists at most.
_MOST = 30
# Characters of a message that are shown; of a longer one its beginning and its way out.
_LONGEST, _END = 2000, 400


class LutgenError(Exception):
    """Root of every error that lutgen raises on purpose."""


class RecipeError(LutgenError, ValueError):
    """A recipe file cannot be read or does not describe a robot and a sweep."""


class InputError(LutgenError, ValueError):
    """An argument of a function or a command is outside what it accepts."""


class MapFileError(LutgenError, OSError):
    """A map file is damaged, incomplete or of a format that is not understood."""


class SweepError(LutgenError, RuntimeError):
    """A sweep could not be computed, written or resumed."""


class ExportError(LutgenError, RuntimeError):
    """No export meets the request, or its folder could not be written or compiled."""


def reject(
    where: object, what: str, got: object, way_out: str, kind: type[LutgenError] = RecipeError
) -> NoReturn:
    """Raise an error in the sentence that all have."""
    raise kind(f"{where}: {what} (got {got}); {way_out}.")


def optional(what: str, name: str, package: str, otherwise: str) -> Any:
    """Return a module of a package that need not be there; InputError says how to get it."""
    try:
        return import_module(name)
    except ImportError as error:
        way_out = f"`pip install {package}`, or {otherwise}"
        reject(what, "needs more packages", error, way_out, InputError)


def readable(message: str) -> str:
    """Return a message as a terminal may show it, though it quotes names and values of files.

    Those may be of any length and hold characters that a terminal obeys, which become escapes.
    """
    if len(message) > _LONGEST:
        message = f"{message[: _LONGEST - _END]} ... {message[-_END:]}"
    return "".join(one if one in "\n\t" else one_line(one) for one in message)


def one_line(text: str) -> str:
    """Return a text as one line that a terminal may show, for any names."""
    return "".join(one if one.isprintable() else ascii(one)[1:-1] for one in text)


def suggestion(word: str, known: Iterable[str], otherwise: str) -> str:
    """Return the way out for an unknown word: the closest known one, or all of them."""
    words = list(known)
    close = difflib.get_close_matches(word, words, n=1)
    if close:
        return f"did you mean '{close[0]}'"
    listed = [*words[:_MOST], *(["..."] if len(words) > _MOST else [])]
    return f"{otherwise}: {', '.join(listed)}" if words else otherwise

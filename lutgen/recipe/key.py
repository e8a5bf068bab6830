"""One key of a recipe: its type, unit and default, what it means and what it costs.

Owns what may be said of a key, and how an interval of numbers is read.  Which keys there are is
in `keys`.
"""

import math
import tomllib
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Key:
    """One key of a table of a recipe.

    `type` is one of `schema.TYPES`, or table or tables.  `meaning` is one sentence and `example`
    the TOML of a value; `unit` is that of its numbers.
    `default` is "" where the key is needed, the TOML of a value, or words where what is left out is
    no value of the key.  `choices` are the only texts that it takes, `bounds` the interval of its
    numbers, such as "(0, 180]"; an end that is left out is infinite.  `pattern` is the regular
    expression of a quantity's text.  `costs` says what using the key costs, "" for nothing.
    """

    name: str
    type: str
    meaning: str
    example: str
    default: str = ""
    unit: str = ""
    costs: str = ""
    bounds: str = ""
    choices: tuple[str, ...] = ()
    pattern: str = ""

    @property
    def needed(self) -> bool:
        """Whether a table without it is refused, but for the rules of tables that say otherwise."""
        return not self.default

    @property
    def default_value(self) -> Any:
        """The value that a recipe without the key gets, None where that is no value."""
        try:
            return toml_value(self.default)
        except tomllib.TOMLDecodeError:
            return None

    @property
    def interval(self) -> tuple[float, float]:
        """Both ends of its numbers; -inf and inf without `bounds`."""
        low, _, high = self.bounds[1:-1].partition(",")
        return float(low or -math.inf), float(high.strip() or math.inf)

    @property
    def closed(self) -> tuple[bool, bool]:
        """Whether the lower and the upper end of its interval belong to it."""
        return self.bounds.startswith("["), self.bounds.endswith("]")


def toml_value(text: str) -> Any:
    """Return the value that a TOML text such as ``[0, 1, 0]`` is.

    Raises
    ------
    tomllib.TOMLDecodeError
        Where it is none, as of an empty text.

    Examples
    --------
    >>> toml_value("[0, 1.5]")
    [0, 1.5]
    """
    return tomllib.loads(f"value = {text}")["value"]

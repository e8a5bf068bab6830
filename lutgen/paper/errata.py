"""The list of the paper's errata, each with the numbers that decide.

Owns how the words of `errata.toml` and the checks come together.  Everything is computed when it
is asked for: printed forms are in `printed`, corrections and independent references beside each
check.
"""

import tomllib
from collections.abc import Callable
from importlib.resources import files
from typing import Any

from lutgen.paper import checks_path, checks_plane, checks_polygon, checks_statics, checks_text
from lutgen.paper.erratum import Checks, Erratum, Example

__all__ = ["CHECKS", "errata", "joined"]

ROWS: list[dict[str, Any]] = tomllib.loads(
    files(__package__).joinpath("errata.toml").read_text(encoding="utf-8")
)["erratum"]
# The checks by the names that the table of errata gives them.
CHECKS: dict[str, Callable[[Example], Checks]] = {
    each.__name__: each
    for part in (checks_plane, checks_statics, checks_polygon, checks_text, checks_path)
    for each in part.CHECKS
}


def errata(example: Example | None = None) -> tuple[Erratum, ...]:
    """Return every erratum of the paper and the places confirmed as printed.

    Parameters
    ----------
    example : Example, optional
        The robot and the direction of gravity on which they are computed; `Example()` by
        default.  The verdicts do not depend on it, the numbers do.

    Returns
    -------
    tuple of Erratum
        In the order of the paper.
    """
    robot = Example() if example is None else example
    return tuple(joined(row, robot) for row in ROWS)


def joined(row: dict[str, Any], example: Example) -> Erratum:
    """Return an erratum: the words of a row of the table, with the numbers of its checks."""
    checks = tuple(found for name in row["checks"] for found in CHECKS[name](example))
    printed, correct, why = (row[key].format(*checks) for key in ("printed", "correct", "why"))
    return Erratum(row["place"], printed, correct, why, checks, row.get("confirmed", False))

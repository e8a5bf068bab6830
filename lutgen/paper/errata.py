"""The list of the paper's errata, each with the numbers that decide.

Owns how the words of `errata.toml` and the checks come together.  Everything is computed when it
is asked for: printed forms are in `printed`, corrections and independent references beside each
check.
"""

import tomllib
from collections.abc import Callable
from importlib.resources import files
from inspect import isfunction, signature
from typing import Any

from lutgen.paper import checks_path, checks_plane, checks_polygon, checks_statics, checks_text
from lutgen.paper.erratum import Checks, Erratum, Example

ROWS: list[dict[str, Any]] = tomllib.loads(
    files(__package__).joinpath("errata.toml").read_text(encoding="utf-8")
)["erratum"]
# The checks by the names that the table of errata gives them: what these files have that takes an
# example and nothing else.
CHECKS: dict[str, Callable[[Example], Checks]] = {
    name: each
    for part in (checks_plane, checks_statics, checks_polygon, checks_text, checks_path)
    for name, each in vars(part).items()
    if isfunction(each) and [p.annotation for p in signature(each).parameters.values()] == [Example]
}


def errata(example: Example | None = None) -> tuple[Erratum, ...]:
    """Return every erratum of the paper and the places confirmed as printed, in its order.

    The verdicts do not depend on the example, `Example()` by default; the numbers do.
    """
    robot = Example() if example is None else example
    return tuple(joined(row, robot) for row in ROWS)


def joined(row: dict[str, Any], example: Example) -> Erratum:
    """Return an erratum: the words of a row of the table, with the numbers of its checks."""
    checks = tuple(found for name in row["checks"] for found in CHECKS[name](example))
    printed, correct, why = (row[key].format(*checks) for key in ("printed", "correct", "why"))
    return Erratum(row["place"], printed, correct, why, checks, row.get("confirmed", False))

"""The list of the paper's errata, each with the numbers that decide.

Owns the order only.  Everything is computed when it is asked for: printed forms in `printed`,
corrections and independent references beside each erratum.
"""

from lutgen.paper import errata_path, errata_plane, errata_polygon, errata_statics, errata_text
from lutgen.paper.erratum import Check, Erratum, Example
from lutgen.paper.forces import force_statistics, force_table
from lutgen.paper.triples import triple_statistics

__all__ = [
    "Check",
    "Erratum",
    "Example",
    "errata",
    "force_statistics",
    "force_table",
    "triple_statistics",
]


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
        Equations 2 to 11, 12 to 21, 22 to 29, then Table 1 and the path simulation.
    """
    robot = Example() if example is None else example
    return (
        *errata_plane.errata(robot),
        *errata_statics.errata(robot),
        *errata_polygon.errata(robot),
        *errata_text.errata(),
        *errata_path.errata(),
    )

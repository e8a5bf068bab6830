"""What the paper prints of its results: Table 1 and the two shares of simulation 3."""

from dataclasses import dataclass

__all__ = ["CONTROLLED", "TABLE", "UNCONTROLLED", "Row"]


@dataclass(frozen=True)
class Row:
    """One column of Table 1: angles in deg, |SD_g| in the paper's ratios.

    `read_as` is |SD_g| as we take it to be meant, where the print contradicts itself.
    """

    method: str
    evaluations: int
    alpha: float
    gamma: float
    sdg: float
    read_as: float


TABLE = (
    Row("stability map", 2500, 31.0, 31.0, 0.0022, 0.0022),
    Row("fminsearch", 49, 30.9628, 30.9605, 0.00009092, 0.00009092),
    Row("searching algorithm, step 1", 25, 30.0, 30.0, 0.0821, 0.0521),
    Row("searching algorithm, step 2", 50, 32.0, 32.0, 0.0566, 0.0566),
    Row("searching algorithm, step 3", 75, 31.2, 31.2, 0.0131, 0.0131),
    Row("searching algorithm, step 6", 150, 30.9568, 30.9568, 0.00037889, 0.00037889),
)
# Shares of the path on which the robot tips over, simulation 3.
UNCONTROLLED, CONTROLLED = 0.72, 0.22

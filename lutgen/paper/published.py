"""What the paper prints, read from `published.toml`: Table 1, captions, and a few numbers."""

import tomllib
from dataclasses import dataclass
from importlib.resources import files

PRINTED = tomllib.loads(files(__package__).joinpath("published.toml").read_text(encoding="utf-8"))


@dataclass(frozen=True)
class Row:
    """One column of Table 1: angles in deg, |SD_g| in the paper's ratios, its share of 10 in %.

    `read_as` is |SD_g| as we take it to be meant, where the print contradicts itself.
    """

    method: str
    evaluations: int
    alpha: float
    gamma: float
    sdg: float
    percent: float
    read_as: float

    @property
    def searching(self) -> bool:
        """Whether the entry is one of the searching algorithm."""
        return self.method.startswith("searching")


def _row(entry: dict[str, str]) -> Row:
    alpha, gamma = map(float, entry["angles_deg"])
    sdg, percent = float(entry["sdg"]), float(entry["percent"])
    read_as = float(entry.get("read_as", sdg))
    return Row(entry["method"], int(entry["iterations"]), alpha, gamma, sdg, percent, read_as)


TABLE = tuple(map(_row, PRINTED["table"]))
# |SD_g| at which the robot tips over, the points of the path, and how many of these tip.
TIPS_AT = float(PRINTED["tips_at"])
POINTS = int(PRINTED["points"])
UNCONTROLLED, CONTROLLED = int(PRINTED["uncontrolled"]), int(PRINTED["controlled"])
ROUNDING_DEG = float(PRINTED["rounding_deg"])


def entry(words: str) -> Row:
    """Return the entry of Table 1 whose method ends with these words, such as "step 2"."""
    (found,) = (row for row in TABLE if row.method.endswith(words))
    return found


def numbers_of(kind: str, words: str) -> list[int]:
    """Return the numbers of the paper's "equations" or "figures" whose text has these words."""
    return [int(number) for number, text in PRINTED[kind].items() if words in text]

"""The speeds that are to be reached, and whether a run reached them."""

from collections.abc import Iterable
from typing import NamedTuple

from benchmarks.cell import Agreement, Cell
from benchmarks.directions import Directions
from benchmarks.files import FileSweep
from benchmarks.process import Processes

MANY = 16_384


class Verdict(NamedTuple):
    """A target, the worst value measured for it and where; `value` None where it was not run."""

    claim: str
    limit: float
    at_least: bool
    value: float | None
    where: str

    @property
    def reached(self) -> bool:
        """Whether the worst value is good enough."""
        if self.value is None:
            return False
        return self.value >= self.limit if self.at_least else self.value <= self.limit

    def line(self) -> str:
        """Return the verdict in words."""
        if self.value is None:
            return f"skipped  {self.claim}: {self.where}"
        word = "reached" if self.reached else "MISSED "
        text = f"{word}  {self.claim}: {self.value:.3g}"
        if self.limit > 0.0 and self.value > 0.0:
            factor = self.value / self.limit if self.at_least else self.limit / self.value
            by = factor if self.reached else 1.0 / factor
            text += f", {by:.3g} times {'to spare' if self.reached else 'short'}"
        return f"{text} ({self.where})"


def _worst(
    claim: str, limit: float, values: Iterable[tuple[float, str]], at_least: bool = False
) -> Verdict:
    """Judge by the worst of several measurements."""
    pick = min if at_least else max
    value, where = pick(values)
    return Verdict(claim, limit, at_least, value, where)


def _place(cell: Cell) -> str:
    return (
        f"n = {cell.contacts} {cell.stance}, {cell.directions:,} directions, "
        f"{cell.threads} thread{'s' if cell.threads > 1 else ''}"
    )


def _compared(cell: Cell) -> Iterable[tuple[str, Agreement]]:
    return cell.agreement.items()


def _same(one: Cell, other: Cell) -> bool:
    """Return whether two cells differ in the number of threads only."""
    return (one.contacts, one.stance, one.directions) == (
        other.contacts,
        other.stance,
        other.directions,
    )


def verdicts(
    cells: list[Cell], files: list[FileSweep], processes: Processes, directions: list[Directions]
) -> list[Verdict]:
    """Judge a whole run."""
    free = [cell for cell in cells if not cell.limits_on]
    many = [cell for cell in free if cell.directions >= MANY]
    result = [
        _worst(
            "largest difference between ours and C, NumPy (relative) and exact tip angles (rad)",
            1e-5,
            [(a.difference, f"{_place(c)}, {name}") for c in cells for name, a in _compared(c)],
        ),
        _worst(
            "nodes where only one of two is NaN",
            0.0,
            [
                (float(a.nan_mismatches), f"{_place(c)}, {name}")
                for c in cells
                for name, a in _compared(c)
            ],
        ),
    ]
    for n, limit in ((3, 2.0), (8, 4.0)):
        result.append(
            _worst(
                f"n = {n}: sdg takes at most {limit:g} times as long as filling memory",
                limit,
                [(c.ratio("fill", "sdg large"), _place(c)) for c in many if c.contacts == n],
            )
        )
    result.append(
        _worst(
            "n >= 4: sdg at least 100 times as fast as NumPy, 1 thread",
            100.0,
            [
                (c.ratio("sdg large", "numpy"), _place(c))
                for c in many
                if c.contacts >= 4 and c.threads == 1
            ],
            at_least=True,
        )
    )
    for words, group in (
        ("", many),
        (", limits 90/30 deg", [c for c in cells if c.limits_on and c.directions >= MANY]),
    ):
        result.append(
            _worst(
                f"sdg + tip_angle take at most 2.5 times as long as sdg{words}",
                2.5,
                [(c.ratio("sdg large", "both large"), _place(c)) for c in group],
            )
        )
    for name, words, limit in (("two", "sdg + tip_angle", 40.0), ("four", "four channels", 80.0)):
        result.append(
            _worst(
                f"one posture, 100,000 directions, 1 thread: {words} take at most {limit:g} ns",
                limit,
                [(row.times[name], "best of 15") for row in directions if row.threads == 1],
            )
        )
    alone = [f for f in files if f.channels == ("sdg",)]
    for words, limit, chosen, suffix in (
        ("sweep of sdg", 2.0, alone, ""),
        ("sweep of sdg, both waiting for the disk,", 1.15, alone, " fsync"),
        ("sweep", 2.5, files, ""),
    ):
        result.append(
            _worst(
                f"{words} to HDF5 takes at most {limit:g} times as long as writing the bytes raw",
                limit,
                [
                    (
                        f.ratio(suffix),
                        f"{' + '.join(f.channels)}, n = {f.contacts}, threads: {f.threads}",
                    )
                    for f in chosen
                ],
            )
        )
    pairs = [
        (one, two)
        for one in free
        for two in free
        if one.threads == 1 and two.threads == 2 and _same(one, two) and one.directions >= MANY
    ]
    claim = "two threads sweep at least 1.7 times as fast as one"
    if pairs:
        values = [
            (two.rates["both reused"] / one.rates["both reused"], _place(two)) for one, two in pairs
        ]
        result.append(_worst(claim, 1.7, values, at_least=True))
    else:
        result.append(Verdict(claim, 1.7, True, None, "this machine has one core"))
    claim = "lutgen --help takes less than 0.3 s"
    if processes.help is None:
        result.append(Verdict(claim, 0.3, False, None, "the command is not installed"))
    else:
        result.append(Verdict(claim, 0.3, False, processes.help.median, "median, s"))
    return result

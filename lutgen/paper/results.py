"""All simulations of the paper, run once."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from lutgen.paper import simulations
from lutgen.paper.errata import errata
from lutgen.paper.erratum import Erratum
from lutgen.paper.forces import ForceRow, ForceStatistics, force_statistics, force_table
from lutgen.paper.rough import Variant, third_simulation, variants
from lutgen.paper.triples import TripleStatistics, triple_statistics
from lutgen.search import Drive, Optimum

MAP = "paper_two.h5"


@dataclass(frozen=True)
class Results:
    """All numbers of the report."""

    first: simulations.First
    second: dict[tuple[str, str], Optimum]
    table: tuple[simulations.TableRow, ...]
    fitted_radius: dict[str, float]
    swept: simulations.MapTime
    third: dict[str, Drive]
    variants: tuple[Variant, ...]
    errata: tuple[Erratum, ...]
    forces: tuple[ForceRow, ...]
    loads: tuple[ForceStatistics, ...]
    triples: TripleStatistics


def compute(folder: Path, progress: Callable[[str], None] = lambda _: None) -> Results:
    """Run all simulations; the map goes into `folder`."""
    progress("simulation 1")
    first = simulations.first_simulation()
    progress("simulation 2")
    second = simulations.second_simulation()
    table, radius = simulations.table_one()
    swept = simulations.timed_map(folder / MAP)
    progress("simulation 3")
    third = third_simulation()
    others = variants(third)
    progress("errata")
    statics = force_table(), force_statistics(), triple_statistics()
    return Results(first, second, table, radius, swept, third, others, errata(), *statics)

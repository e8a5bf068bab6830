"""Make, certify and write the exports whose numbers the documents quote, and print their table.

    python tools/export_table.py [--output build/exports] [--only TEXT] [--points N] [--update]

Each export goes to OUTPUT/<recipe>_<number>/.  Sizes are given
here, not chosen, so that every row is the same wherever it is made; `lutgen export` chooses.
"""

import argparse
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from firmware_export.choose import Trials
from firmware_export.codecs import usable
from firmware_export.contacts import codec as contacts
from firmware_export.emit import package
from firmware_export.exporter import guarded
from firmware_export.grid import lookup
from firmware_export.model.exact import Model
from lutgen.quantities import EXPORTABLE
from targets.cases import TABLES, recipe_of
from targets.marks import ROOT, between
from targets.pages import EXPORTS


@dataclass(frozen=True)
class Case:
    """One row: recipe, codec, size, arithmetic, channels."""

    recipe: str
    codec: str
    spec: Any
    arithmetic: str = "float"
    channels: tuple[str, ...] = EXPORTABLE


CASES = (
    Case("paper_two", "contacts", contacts.Spec()),
    Case("paper_two", "grid", lookup.Spec(8, ((1, 3), (4, 1), (1, 1)))),
    Case("paper_two", "grid", lookup.Spec(8, ((1, 3), (4, 1), (1, 1))), "integer"),
    Case("paper_two", "grid", TABLES["float"]),
    Case("paper_two", "grid", TABLES["integer"], "integer"),
    Case("marv", "contacts", contacts.Spec()),
    Case("absolem", "contacts", contacts.Spec()),
    Case("articulated", "contacts", contacts.Spec()),
    Case("legs", "contacts", contacts.Spec()),
)
HEAD = (
    "| robot | export | arithmetic | tables, B | with code, B | \\|SD_g\\| max | p99 | guard | "
    "stable, reported unsafe | falsely safe | points |\n"
    "|---|---|---|---|---|---|---|---|---|---|---|"
)


def row(case: Case, output: Path, number: int, points: int) -> str:
    """Make one export; return its row."""
    model = Model(recipe_of(case.recipe))
    trials = Trials(model, case.recipe, case.channels, case.arithmetic)
    made = trials.try_out(usable(model, case.arithmetic, case.codec)[0], case.spec)
    if made is None:
        raise SystemExit(f"{case}: the codec refuses this size")
    export, found = guarded(made.export, None, points)
    found.refuse_false_safe(f"{case.recipe}: {made.label}")
    certificate = found.as_dict()
    final = replace(export, certificate=certificate)
    report = package.write(final, output / f"{case.recipe}_{number}")
    sdg = report["certificate"]["channels"].get("sdg", {})
    largest = f"{sdg['max_percent']:.3g} %" if "max_percent" in sdg else "jumps" if sdg else "-"
    p99 = f"{sdg['p99_percent']:.3g} %" if sdg else "-"
    return (
        f"| {case.recipe} | {made.label} | {case.arithmetic} | {report['bytes']['tables']:,} | "
        f"{report['bytes']['total']:,} | {largest} | {p99} | {report['guard_deg']:.3g} deg | "
        f"{100.0 * certificate['false_tip']:.3g} % | {certificate['false_safe']} | "
        f"{certificate['points']:,} |"
    )


def main() -> int:
    """Print the table; return an exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", type=Path, default=ROOT / "build" / "exports")
    parser.add_argument("--only", default="", help="only rows in which this text occurs")
    parser.add_argument("--points", type=int, default=500_000)
    parser.add_argument("--update", action="store_true", help="rewrite docs/measured/exports.md")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    lines = HEAD.splitlines()
    print(HEAD, flush=True)
    for number, case in enumerate(CASES, 1):
        if options.only in f"{case.recipe} {case.codec} {case.arithmetic}":
            lines.append(row(case, options.output, number, options.points))
            print(lines[-1], flush=True)
    if options.update:
        between(EXPORTS, "sizes", "\n".join(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""`python -m proofs.fuzzing [--scale X] [--seconds S] [--seed N] [--update]`.

Tries every kind of hostile input and prints a table; the exit code is 1 where anything was found.
`--only KIND` tries one kind (and writes its row), with `--at N` one case, and says how it ended.
"""

import argparse
import math
import shutil
import sys
from pathlib import Path

from proofs.fuzzing.campaign import Task, campaign, distinct, tried
from proofs.fuzzing.kinds import KINDS
from proofs.fuzzing.page import PAGE, page, table, with_rows

FAILURES = Path("build/fuzzing")


def main() -> int:
    """Run a campaign, or one case."""
    parser = argparse.ArgumentParser(prog="python -m proofs.fuzzing", description=__doc__)
    parser.add_argument("--scale", type=float, default=1.0, help="of the counts of a campaign")
    parser.add_argument("--seconds", type=float, default=math.inf, help="at most")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=[*KINDS, "attack"])
    parser.add_argument("--at", type=int, help="the number of one case, with --only")
    parser.add_argument("--update", action="store_true", help=f"write {PAGE.name}")
    asked = parser.parse_args()
    if asked.at is not None and asked.only:
        _, tally = tried(Task(asked.only, asked.seed, asked.at, asked.at + 1))
        print(*[found.what for found in tally.found] or [f"ended with {list(tally.codes)}"])
        return bool(tally.found)
    shutil.rmtree(FAILURES, ignore_errors=True)
    kinds = [asked.only] if asked.only in KINDS else list(KINDS)
    counts = {kind: max(round(KINDS[kind].count * asked.scale), 10) for kind in kinds}
    found = campaign(counts, asked.seed, asked.seconds, FAILURES)
    print("\n".join(table(found)))
    faults = distinct([one for tally in found.values() for one in tally.found])
    for one in faults:
        print(f"{one.kind} {one.at}: {one.what}\n    {one.folder}")
    if asked.update:
        before = PAGE.read_text("utf-8")
        text = with_rows(before, found) if asked.only else page(found, asked.seed)
        PAGE.write_text(text, "utf-8")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())

"""`python -m proofs.fuzzing [--seconds S] [--seed N] [--only KIND]`.

Tries every kind of hostile input for its share of the time, and says how many cases were run.  The
exit code is 1 where one went wrong; the smallest one that does is left in build/fuzzing/KIND.
"""

import argparse
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

from proofs.fuzzing.campaign import FAILURES, campaign
from proofs.fuzzing.inputs import KINDS


def main() -> int:
    """Run a campaign."""
    parser = argparse.ArgumentParser(prog="python -m proofs.fuzzing", description=__doc__)
    parser.add_argument("--seconds", type=float, default=600.0, help="in all, by two processes")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=list(KINDS))
    asked = parser.parse_args()
    kinds = [asked.only] if asked.only else list(KINDS)
    share, wrong = 2.0 * asked.seconds / max(len(kinds), 2), False
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        jobs = {kind: pool.submit(campaign, kind, share, asked.seed) for kind in kinds}
        for kind, job in jobs.items():
            done, what = job.result()
            wrong = wrong or bool(what)
            said = f"{what}\n    {FAILURES / kind}" if what else "nothing went wrong"
            print(f"{kind}: {done} cases, {said}", flush=True)
    return int(wrong)


if __name__ == "__main__":
    sys.exit(main())

"""Functions of the runtime that are proved by trying all that can be given to them."""

import shutil
from pathlib import Path

from firmware_export.host import RUNTIME
from proofs.prove.rounding import ARCSINE, FURTHEST, NEAREST, SINE, SINE_NEAR
from proofs.tools import FAILED, OK, Result
from targets.image import run
from targets.size import program

SOURCE = Path(__file__).with_name("exhaustive.c")
# The last two choose the whole square root of processors that can divide.
FLAGS = (
    *("-std=c99", "-O3", "-march=native", "-ffp-contract=off", "-DSMAP_SOFT_ROOT"),
    *("-D__ARM_FEATURE_IDIV", "-D__ARM_FEATURE_CLZ"),
)
# Errors that proofs of exports assume of all floats.
ASSUMED = (
    *(f"-DSINE_NEAR={SINE_NEAR!r}", f"-DSINE={SINE!r}", f"-DARCSINE={ARCSINE!r}"),
    *(f"-DNEAREST={NEAREST!r}f", f"-DFURTHEST={FURTHEST!r}f"),
)
# Name in the program's output: the claim.
PROOFS = {
    "guards": "what passes smap_is_finite, _positive and _within is that",
    "range": "a parameter that is kept is a number, within its axis and the slack",
    "direction": "a direction that is kept is a number, within the chart",
    "root": "square roots are correctly rounded",
    "whole_root": "whole square roots are rounded down",
    "waves_near": "sines and cosines without quarter turns are as near as proofs of exports assume",
    "waves": "sines and cosines are as near as proofs of exports assume",
    "arcsine": "arcsines are as near as proofs of exports assume",
}


def prove(folder: Path, patience: float, step: int = 1, parts: Path = RUNTIME) -> list[Result]:
    """Compile and run everything of the runtime in `parts`; `folder` is to work in.

    With a step above 1 only every so many is tried, which can find a fault but proves nothing.
    """
    (folder / "of_three.c").write_text(program("points"), encoding="utf-8")
    shutil.copy(SOURCE, folder)
    command = ["gcc", *FLAGS, *ASSUMED, f"-DSTEP={step}u", f"-I{parts}", SOURCE.name]
    done = run([*command, "-o", "all", "-lm"], folder, patience)
    if done.returncode == 0:
        done = run([str(folder / "all")], folder, patience)
    lines = dict(line.split(" ", 1) for line in done.stdout.splitlines() if " " in line)
    results = []
    for name, claim in PROOFS.items():
        numbers = lines.get(name, "").split()
        if done.returncode or len(numbers) != 2:
            first = next((row for row in done.stderr.splitlines() if "error" in row), "no answer")
            results.append(Result("exhaustive", name, FAILED, first))
            continue
        tried, wrong = map(int, numbers)
        said = f"{claim}: {tried:,} tried, {wrong:,} wrong"
        results.append(Result("exhaustive", name, FAILED if wrong else OK, said))
    return results

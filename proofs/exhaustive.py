"""Functions of smap.c that are proved by trying all that can be given to them."""

import shutil
from pathlib import Path

from proofs.parts import place
from proofs.prove.rounding import ARCSINE, FURTHEST, NEAREST, SINE, SINE_NEAR
from proofs.tools import FAILED, OK, Clock, Result, run

__all__ = ["PROOFS", "prove"]

SOURCE = Path(__file__).with_name("exhaustive.c")
# The last two choose the whole square root of processors that can divide.
FLAGS = (
    *("-std=c99", "-O3", "-march=native", "-ffp-contract=off", "-DSMAP_HARDWARE_ROOT=0"),
    *("-D__ARM_FEATURE_IDIV", "-D__ARM_FEATURE_CLZ"),
)
# What proofs of exports assume of all floats.
ASSUMED = (
    *(f"-DSINE_NEAR={SINE_NEAR!r}", f"-DSINE={SINE!r}", f"-DARCSINE={ARCSINE!r}"),
    *(f"-DNEAREST={NEAREST!r}f", f"-DFURTHEST={FURTHEST!r}f"),
)
# Name in the program's output: what it shows.
PROOFS = {
    "between": "a value lies between its two nodes, and is the node at a node",
    "guards": "what passes smap_is_finite, _positive and _within is that",
    "range": "a parameter that is kept is a number, within its axis and the slack",
    "direction": "a direction that is kept is a number, within the chart",
    "root": "square roots are correctly rounded",
    "whole_root": "whole square roots are rounded down",
    "cell": "the cell found is the one that holds the place",
    "waves_near": "sines and cosines without quarter turns are as near as proofs of exports assume",
    "waves": "sines and cosines are as near as proofs of exports assume",
    "arcsine": "arcsines are as near as proofs of exports assume",
}


def prove(parts: dict[str, str], folder: Path, patience: float, step: int = 1) -> list[Result]:
    """Compile and run everything of these parts; `folder` is to work in.

    With a step above 1 only every so many is tried, which can find a fault but proves nothing.
    """
    place(parts, folder)
    shutil.copy(SOURCE, folder / "exhaustive.c")
    compiler = "gcc" if shutil.which("gcc") else "cc"
    text, code = "", 0
    with Clock() as clock:
        for name, more in (("all", ()), ("grid", ("-DGRID",))):
            command = [
                compiler,
                *FLAGS,
                *ASSUMED,
                *more,
                f"-DSTEP={step}u",
                "exhaustive.c",
                "-o",
                name,
                "-lm",
            ]
            done = run(command, folder, patience)
            if done.code == 0:
                done = run([str(folder / name)], folder, patience)
            text, code = text + done.text, code or done.code
    lines = dict(line.split(" ", 1) for line in text.splitlines() if " " in line)
    results = []
    for name, claim in PROOFS.items():
        numbers = lines.get(name, "").split()
        if code or len(numbers) != 2:
            first = next((row for row in text.splitlines() if "error" in row), "no answer")
            results.append(Result("exhaustive", name, FAILED, first, clock.seconds))
            continue
        tried, wrong = map(int, numbers)
        said = f"{claim}: {tried:,} tried, {wrong:,} wrong"
        results.append(Result("exhaustive", name, FAILED if wrong else OK, said, clock.seconds))
    return results

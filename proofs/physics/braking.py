"""Brake in the physics engine: at 0.95 of the budget a robot stands, at 1.05 it tips.

python -m proofs.physics.braking [--cases N] [--update]

Robots of the gallery in random postures on slopes, that accelerate anywhere along their own
ground plane.  A robot that accelerates by a feels g - a: the engine is given that as gravity.
Exits with 1 where a case is missed.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lutgen import load_recipe
from lutgen.analysis import budgets
from lutgen.channels import evaluate_each
from lutgen.recipe import Recipe
from proofs.physics.body import Floats, recipe_postures
from proofs.physics.page import MEASURED, page
from proofs.physics.release import STEEPEST, release
from proofs.physics.robots import ROOT, cap
from proofs.physics.start import start

PAGE = MEASURED / "control.md"
ROBOTS = ("three_leg_sphere", "excavator", "articulated", "absolem")
CASES, SEED = 200, 31
STANDS, TIPS = 0.95, 1.05
# deg and m/s^2: slopes of the ground, and budgets that are worth a case.
SLOPE, LEAST, MOST = 30.0, 0.5, 30.0
G0 = 9.80665


@dataclass(frozen=True)
class Row:
    """What came of one robot: cases, and those that tip at 0.95 or stand at 1.05."""

    name: str
    cases: int
    too_much: int
    too_little: int


def brake(name: str, cases: int) -> Row:
    """Try a robot of the gallery."""
    recipe = load_recipe(ROOT / "maps" / f"{name}.toml")
    rng, done, wrong = np.random.default_rng(SEED), 0, [0, 0]
    low, high = ([getattr(p, end) for p in recipe.parameters] for end in ("minimum", "maximum"))
    while done < cases:
        params = rng.uniform(low, high)[None]
        down, turn = cap(rng, SLOPE), rng.uniform(0.0, 2.0 * np.pi)
        way = np.array([np.cos(turn), np.sin(turn), 0.0])
        limit = float(budgets(recipe, params, down[None], way[None])[0])
        felt = [down - way * (part * limit / G0) for part in (STANDS, TIPS)]
        if not LEAST < limit < MOST or not all(_fair(recipe, params, one) for one in felt):
            continue
        posture = recipe_postures(recipe, params)[0]
        directions = [one / np.linalg.norm(one) for one in felt]
        begins = [(start(posture, one), one) for one in directions]
        if not all(b is not None and not b.balanced and b.slope(d) < STEEPEST for b, d in begins):
            continue
        done += 1
        for i, (begin, one) in enumerate(begins):
            assert begin is not None
            wrong[i] += release(posture, begin, one).tipped is (i == 0)
    return Row(name, cases, *wrong)


def _fair(recipe: Recipe, params: Floats, felt: Floats) -> bool:
    """Whether a case is further from the limit than the engine's own accuracy."""
    tip = evaluate_each(recipe, params, felt[None], ("tip_angle",))["tip_angle"][0]
    return abs(float(np.degrees(tip))) > 0.1


def main(arguments: Sequence[str] | None = None) -> int:
    """Brake with all robots; print the table."""
    parser = argparse.ArgumentParser(prog="python -m proofs.physics.braking")
    parser.add_argument("--cases", type=int, default=CASES)
    parser.add_argument("--update", action="store_true", help="rewrite the table of control.md")
    options = parser.parse_args(arguments)
    rows = [brake(name, options.cases // len(ROBOTS)) for name in ROBOTS]
    lines = ["| robot | cases | tips at 0.95 of the budget | stands at 1.05 |", "|---|---|---|---|"]
    lines += [f"| {r.name} | {r.cases} | {r.too_much} | {r.too_little} |" for r in rows]
    print("\n".join(lines))
    if options.update:
        text = page(PAGE.read_text("utf-8"), "braking", "\n".join(lines) + "\n")
        PAGE.write_text(text, "utf-8")
    return int(any(r.too_much or r.too_little for r in rows))


if __name__ == "__main__":
    sys.exit(main())

"""What is said of an export: proved, with which guard, or tested, and what stands in the way.

Owns the order of the steps, and the content of NAME_proof.json, from which another program can
check all of it (`proofs/check_proof.py`).
"""

import math
import struct
from dataclasses import dataclass
from typing import Any

import numpy as np

from firmware_export.prove.blob import Held, held
from firmware_export.prove.search import Problem, Proof, enough, needed, problem_of
from lutgen.recipe import Recipe

FORMAT = 1
# Cells that are looked at before it is given up that the guard of an export will do.
PATIENCE = 40_000
MANY = (
    "the proof is one of three contact points, whose stable directions are one convex cone in "
    "every posture; this map has facets that change from posture to posture"
)
BY_CODE = "the robot is given by code, of which nothing is known but the values that it returns"


@dataclass(frozen=True, eq=False)
class Statement:
    """What came of a proof.

    `guard` (rad) and `guard_i` (1/32767) are what the export has, `needed` and `needed_i` what the
    proof needs (infinite and -1 without one).  `reason` is empty where it is proved.
    """

    guard: float
    guard_i: int
    needed: float
    needed_i: int
    reason: str
    looked: int = 0
    problem: Problem | None = None
    proof: Proof | None = None

    @property
    def proved(self) -> bool:
        """Whether the export is never falsely safe, by proof."""
        return not self.reason

    @property
    def told(self) -> dict[str, Any]:
        """The entry of the report."""
        cells = len(self.proof.cells) if self.proof is not None and self.proved else None
        return {
            "status": "proved" if self.proved else "tested",
            "needed_deg": math.degrees(self.needed) if math.isfinite(self.needed) else None,
            "needed_i": self.needed_i if self.needed_i >= 0 else None,
            "cells": cells,
            "reason": self.reason or None,
        }


def state(recipe: Recipe, blob: bytes, integer: bool, least: bool = False) -> Statement:
    """Prove that a map is never falsely safe.

    Parameters
    ----------
    recipe : Recipe
        What the map is of.
    blob : bytes
        The map as it stands in flash.
    integer : bool
        Whether it is read without floats.
    least : bool
        Look for about the least guard that can be proved, whatever the map has.
    """
    guard, guard_i = struct.unpack_from("<f4xH", blob, 20)
    unknown = Statement(guard, guard_i, math.inf, -1, "")
    if recipe.python is not None:
        return _because(unknown, BY_CODE)
    try:
        map_ = held(blob)
        problem = problem_of(recipe, map_, integer)
    except (ValueError, struct.error, IndexError) as error:
        three = len(recipe.contacts) == 3 and not any(c.radius for c in recipe.contacts)
        why = f"what the map holds does not fit the recipe: {error}" if three else MANY
        return _because(unknown, why)
    if least:
        proof = needed(problem)
    else:
        proof = enough(problem, min(guard, _most_turn(problem, map_)), PATIENCE)
    if not math.isfinite(proof.guard):
        return _because(unknown, _where(recipe, proof), problem, proof)
    whole = problem.whole_guard(proof.turn)
    found = Statement(guard, guard_i, proof.guard, whole, "", proof.looked, problem, proof)
    if proof.guard > guard or whole > guard_i:
        return _because(
            found,
            f"{proof.looked:,} cells show a guard of {math.degrees(proof.guard):.3g} deg to be "
            f"enough, {whole} in 1/32767, but not that of {math.degrees(guard):.3g} deg, "
            f"{guard_i}, which it has",
            problem,
            proof,
        )
    return found


def _most_turn(problem: Problem, map_: Held) -> float:
    """Return by how much (rad) planes may turn for the guard of the integer form."""
    return max((map_.guard_i - problem.whole) / 32767.0, 0.0) * (1.0 - 1e-9)


def _because(
    found: Statement, reason: str, problem: Problem | None = None, proof: Proof | None = None
) -> Statement:
    looked = found.looked if proof is None else proof.looked
    return Statement(
        *(found.guard, found.guard_i, found.needed, found.needed_i, reason, looked),
        *(problem, proof),
    )


def _where(recipe: Recipe, proof: Proof) -> str:
    """Return why a search was given up, and at which cell or posture."""
    assert proof.worst is not None
    ends = [
        f"{parameter.name} {parameter.shown(low):.6g}"
        + (f" .. {parameter.shown(high):.6g}" if high > low else "")
        + f" {parameter.display_unit}"
        for parameter, (low, high) in zip(recipe.parameters, proof.worst, strict=True)
    ]
    return (
        f"after {proof.looked:,} cells, at {', '.join(ends) or 'its one posture'}: {proof.reason}"
    )


def record(recipe: Recipe, stated: Statement, name: str, source_sha256: str) -> dict[str, Any]:
    """Return the content of NAME_proof.json.

    All numbers are doubles that read back as they were; angles in rad.  The cells are told by
    `cuts`, which divide the box, and by one `trail` through the trees that halve its parts: the
    axis of each cell that is halved, then of its lower and its upper half; "." of all others.
    """
    assert stated.problem is not None
    assert stated.proof is not None
    problem, proof = stated.problem, stated.proof
    column = {parameter.name: at for at, parameter in enumerate(recipe.parameters)}
    cuts = [
        [float(low), *map(float, inner[(inner > low) & (inner < high)]), float(high)]
        for (low, high), inner in zip(problem.box, problem.stored.cuts, strict=True)
    ]
    return {
        "lutgen_proof": FORMAT,
        "name": name,
        "source_sha256": source_sha256,
        "recipe_sha256": recipe.digest,
        "claim": "wherever the map says that the robot stands it does, and its tip angle is not "
        "above the true one",
        "guard_rad": stated.guard,
        "guard_i": stated.guard_i,
        "needed_rad": stated.needed,
        "needed_turn_rad": proof.turn,
        "needed_i": stated.needed_i,
        "rules": {
            "steepest": problem.rules.steepest,
            "width": problem.rules.width,
            "ball": problem.rules.ball,
        },
        "parameters": [[p.minimum, p.maximum] for p in recipe.parameters],
        "links": [
            {
                "name": link.name,
                "parent": link.parent,
                "origin": list(link.origin),
                "rpy": list(link.rpy),
                "mass": link.mass,
                "com": list(link.com),
                "joint": None
                if link.joint is None
                else {
                    "kind": link.joint.kind,
                    "axis": list(link.joint.axis),
                    "parameter": column[link.joint.parameter],
                    "scale": link.joint.scale,
                    "offset": link.joint.offset,
                },
            }
            for link in recipe.links
        ],
        "contacts": [{"link": one.link, "position": list(one.position)} for one in recipe.contacts],
        "cells": len(proof.cells),
        "cuts": cuts,
        "trail": proof.trail,
    }


def stored_guard(rad: float) -> float:
    """Return the least single that is no less than a guard (rad)."""
    single = np.float32(rad)
    if float(single) < rad:
        single = np.nextafter(single, np.float32(np.inf))
    return float(single)

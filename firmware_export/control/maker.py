"""Make a policy: limits of the robot, the best posture for each slope, and what the table loses.

One posture is better than another by its score.
"""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from firmware_export.control.limits import limits_of, stands_alike
from firmware_export.control.table import between, polished, smooth
from firmware_export.model import Model, combinations
from firmware_export.protocol import Joint, Policy
from lutgen.channels import evaluate_each
from lutgen.errors import InputError, reject
from lutgen.vector import Floats

# Postures of the lattice at most.
POSTURES = 4200
# A score of what tips: below every other.
TIPS = -1e3
_PRICED = re.compile(r"tip_angle\s*-\s*([0-9.]+)\s*\*\s*move2$")
WORDS = "tip_angle, tip_angle-X*move2, move, sdg"


# Scores of tip angles (rad), |SD_g| and squared moves from home (rad): the larger, the better.
Score = Callable[[Floats, Floats, Floats], Floats]


def score_of(objective: str, margin: float) -> Score:
    """Return the score of an objective.

    ``tip_angle``, of which ``tip_angle-X*move2`` takes X rad for a move of 1 rad; ``move``: the
    smallest move that has the tip angle `margin`; ``sdg``: the smallest |SD_g|, as in the paper.
    """
    priced = _PRICED.match(objective.strip())
    if not priced and objective not in ("tip_angle", "move", "sdg"):
        way_out = f"one of {WORDS}"
        reject("--objective", "unknown objective", repr(objective), way_out, InputError)
    price = float(priced[1]) if priced else 0.0

    def score(tip: Floats, sdg: Floats, move2: Floats) -> Floats:
        if objective == "sdg":
            value = -sdg
        elif objective == "move":
            value = np.where(tip >= margin, math.pi - np.sqrt(move2), tip - math.pi)
        else:
            value = tip - price * move2
        return np.asarray(np.where(tip >= 0.0, value, TIPS + tip))

    return score


def lattice(model: Model) -> Floats:
    """Return the postures (p, k) that are tried; a joint that turns round has no end twice."""
    places = max(2, int(POSTURES ** (1.0 / max(model.k, 1))))
    axes = [
        np.linspace(low, high, places, endpoint=high - low < 2.0 * math.pi - 1e-6)
        for low, high in zip(model.lower, model.upper, strict=True)
    ]
    return np.asarray(combinations(axes))


def read(model: Model, postures: Floats, slopes: Floats, convention: str) -> tuple[Floats, Floats]:
    """Return tip angle (rad) and |SD_g| of postures (m, k) on slopes (m, 3) or (m, s, 3) each."""
    found = evaluate_each(model.recipe, postures, slopes, ("sdg", "tip_angle"), convention)
    return found["tip_angle"], found["sdg"]


def measured(
    model: Model, postures: Floats, slopes: Floats, convention: str
) -> tuple[Floats, Floats]:
    """Return tip angle (rad) and |SD_g|, each (s, p), of every posture (p, k) on slopes (s, 3)."""
    every = np.broadcast_to(slopes, (len(postures), *slopes.shape))
    tip, sdg = read(model, postures, every, convention)
    return tip.T, sdg.T


# Slopes on which losses are measured, and their seed.
UNSEEN, SEED = 100, 29
# Codes of a byte; nearness, as a part of a cycle's change; joints of three points at most, of which
# every corner is looked at (runtime/smap_control_three.c).
CODES, NEAR, MOST_JOINTS = 255, 0.02, 4


@dataclass(frozen=True)
class PolicyOptions:
    """Options of a policy; angles in rad, lengths in the recipe's unit, times in s.

    `lutgen policy -h` says what each is.  Parameters may be left out of `home`, `rate` and `delta`;
    `within` is in the unit of the objective (see `score_of`); below `levels` the alarm has level 1,
    2, 3; by `swerve` `up` may turn in a cycle beyond what the gyroscope says.
    """

    objective: str = "tip_angle"
    within: float = math.radians(1.0)
    nodes: int = 9
    slope: float = math.radians(45.0)
    home: Mapping[str, float] = field(default_factory=dict)
    rate: Mapping[str, float] = field(default_factory=dict)
    delta: Mapping[str, float] = field(default_factory=dict)
    cycle: float = 0.02
    latency: float = 0.06
    margin: float = math.radians(3.0)
    levels: tuple[float, float, float] = (math.radians(10.0), math.radians(5.0), math.radians(2.0))
    swerve: float = 0.5
    convention: str = "plane"
    poses: int = 1


class Loss(NamedTuple):
    """Losses of a table: degrees of tip angle against the best posture of the lattice, and more.

    `tips` is the share of `slopes` on which the table's posture tips, though another stands;
    `step` the largest change (deg, or parts of a length's axis in 1/100) between two nodes, and
    `best_step` that of the nodes' own best.
    """

    bytes: int
    nodes: int
    mean: float
    p95: float
    largest: float
    least_tip: float
    tips: float
    step: float
    slopes: int
    best_step: float


class Design(NamedTuple):
    """A policy and what it loses."""

    policy: Policy
    loss: Loss


def design(model: Model, options: PolicyOptions) -> Design:
    """Return the policy of a robot and its losses; refuse options that mean nothing."""
    _refuse(model, options)
    parameters, n = model.recipe.parameters, options.nodes
    # A move of one (rad) of each parameter: of a length, its axis.
    scale = np.where([p.unit == "rad" for p in parameters], 1.0, model.upper - model.lower)
    at_home = dict(zip((p.name for p in parameters), model.recipe.home_params, strict=True))
    home = np.array([*(at_home | dict(options.home)).values()])
    limit = math.tan(options.slope)
    if model.faces == 1:
        limit = min(limit, model.chart_limit)
    along = np.linspace(-limit, limit, n)
    slopes = np.array([[u, v, -1.0] for u in along for v in along])
    postures, scores = lattice(model), score_of(options.objective, options.margin)

    def move2(params: Floats) -> Floats:
        return np.asarray((((params - home) / scale) ** 2).sum(axis=1))

    def scored(params: Floats, places: Floats) -> Floats:
        uv = (2.0 * places - 1.0) * limit
        down = np.column_stack([uv, -np.ones(len(uv))])
        return scores(*read(model, params, down, options.convention), move2(params))

    tip, sdg = measured(model, postures, slopes, options.convention)
    score = scores(tip, sdg, move2(postures)).reshape(n, n, -1)
    first = smooth(postures, score, home, scale, options.within)
    alike = np.broadcast_to(postures[score.mean(axis=(0, 1)).argmax()], first.shape)
    enough = np.maximum(score.max(axis=2), -math.pi) - options.within
    values = polished((first, alike), enough, (model.lower, model.upper), scale, scored)
    low, high = values.min(axis=(0, 1)), values.max(axis=(0, 1))
    step = np.maximum(high - low, 1e-6 * (model.upper - model.lower)) / CODES
    policy = Policy(
        codes=np.rint((values - low) / step).clip(0, CODES).astype(np.uint8),
        limit=limit,
        joints=_joints(model, options, low, step),
        **{name: getattr(options, name) for name in ("cycle", "latency", "margin", "levels")},
        swerve=options.swerve,
        poses=options.poses,
    )
    best_step = _step(smooth(postures, score, home, scale, 0.0) / scale)
    return Design(policy, _loss(model, policy, postures, options.convention, scale, best_step))


def _joints(model: Model, options: PolicyOptions, low: Floats, step: Floats) -> tuple[Joint, ...]:
    """Return what the C knows of each parameter."""
    limits, span = limits_of(model), model.upper - model.lower
    joints = []
    for at, parameter in enumerate(model.recipe.parameters):
        rate = options.rate.get(parameter.name, 0.25 * span[at]) * options.cycle
        delta = options.delta.get(parameter.name, span[at])
        bounds = (float(row[at]) for row in (limits.reach, limits.bend, limits.lean))
        joints.append(Joint(float(low[at]), float(step[at]), rate, delta, NEAR * rate, *bounds))
    return tuple(joints)


def _step(values: Floats) -> float:
    """Return the largest change (deg) between two nodes of a table (n, n, k)."""
    return max(
        float(np.abs(np.diff(np.degrees(values), axis=axis)).max(initial=0.0)) for axis in (0, 1)
    )


def _loss(
    model: Model, policy: Policy, postures: Floats, convention: str, scale: Floats, best_step: float
) -> Loss:
    """Return what a table loses against the best of some postures on slopes it has not seen."""
    uv = np.random.default_rng(SEED).uniform(-policy.limit, policy.limit, (UNSEEN, 2))
    slopes = np.column_stack([uv, -np.ones(UNSEEN)])
    best = measured(model, postures, slopes, convention)[0].max(axis=1)
    values = policy.values()
    nodes = len(values)
    # As smap_target has them.
    at = (uv + policy.limit) * (nodes - 1) / (2.0 * policy.limit)
    cell = np.clip(at.astype(np.int64), 0, nodes - 2)
    tip, _ = read(model, between(values, cell, at - cell), slopes, convention)
    lost = np.degrees(np.maximum(best - np.maximum(tip, 0.0), 0.0))
    stands = best >= 0.0
    return Loss(
        bytes=policy.table_bytes,
        nodes=nodes,
        mean=float(lost.mean()),
        p95=float(np.quantile(lost, 0.95)),
        largest=float(lost.max()),
        least_tip=float(np.degrees(tip[stands].min(initial=np.pi))),
        tips=float((tip[stands] < 0.0).mean()) if stands.any() else 0.0,
        step=_step(values / scale),
        slopes=UNSEEN,
        best_step=best_step,
    )


def _refuse(model: Model, options: PolicyOptions) -> None:
    """Refuse what means nothing; the command line knows names and ranges."""
    source, names = model.recipe.source, [p.name for p in model.recipe.parameters]
    if not names:
        way_out = "give it a parameter"
        reject(source, "the robot has no joint to control", "no parameter", way_out, InputError)
    if model.recipe.axles and not stands_alike(model):
        what = "no bound of ways is known where an axle that swings carries in some postures only"
        way_out = "read its export at each posture instead"
        reject(source, what, model.recipe.axles[0].name, way_out, InputError)
    if model.is_tripod and model.k > MOST_JOINTS:
        what = f"of robots on three points control knows {MOST_JOINTS} joints"
        reject(source, what, model.k, "let several joints share a parameter", InputError)
    for what in ("home", "rate", "delta"):
        for name, value in getattr(options, what).items():
            low, high = model.lower[names.index(name)], model.upper[names.index(name)]
            if what == "home" and not low <= value <= high:
                way_out = f"choose from {low:g} to {high:g}"
                reject(f"{source}: --home", f"{name} is off its axis", value, way_out, InputError)
            if what != "home" and not 0.0 < value < math.inf:
                way_out = "leave it out"
                reject(f"{source}: --{what}", f"{name} is not above 0", value, way_out, InputError)

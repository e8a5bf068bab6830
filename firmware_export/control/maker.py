"""A policy from robot to table: limits, the best postures, the smooth choice, what it loses.

Owns the order of the steps and the defaults.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from firmware_export.control.choose import choose
from firmware_export.control.limits import limits_of
from firmware_export.control.measure import Loss, loss, slopes_within
from firmware_export.control.objective import Objective, lattice, measured, scales
from firmware_export.control.polish import polished
from firmware_export.protocol import Joint, Policy
from firmware_export.truth import Model
from lutgen.channels import CONVENTIONS
from lutgen.errors import InputError
from lutgen.vector import Floats

# Slopes on which losses are measured; codes of a byte; nearness, as a part of a cycle's change;
# joints of three points at most, of which every corner is looked at (runtime/smap_control_three.c).
UNSEEN, CODES, NEAR, MOST_JOINTS = 100, 255, 0.02, 4


@dataclass(frozen=True)
class Wishes:
    """What a policy is asked for; angles in rad, lengths in the recipe's unit, times in s.

    Parameters
    ----------
    objective : str
        See `Objective.of`.
    within : float
        By how much less than the best score will do, for the sake of smoothness.
    nodes : int
        Nodes a side of the table.
    slope : float
        Steepest slope of the table along x or y.
    home, rate, delta : mapping of str to float
        By parameter: where the robot is if nothing else matters; change in a second; range around
        what the driver asks for.
    cycle, latency, margin : float
        Of a cycle; from sample to motion; tip angle that ways are to keep.
    levels : (float, float, float)
        Tip angles below which the alarm has level 1, 2, 3.
    swerve : float
        By how much `up` may turn in a cycle beyond what the gyroscope says.
    convention : str
        How gravity turns while the shape changes, see `lutgen.channels`.
    poses : int
        Poses that a cycle may make of many contacts, 1 or 2.
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


class Design(NamedTuple):
    """A policy, what it loses, what the nodes' own best would jump (as `Loss.step`), its slopes."""

    policy: Policy
    loss: Loss
    plain_step: float
    slopes: int


def design(model: Model, wishes: Wishes) -> Design:
    """Return the policy of a robot, and what it loses.

    Parameters
    ----------
    model : Model
        The robot.
    wishes : Wishes
        What is asked for.

    Raises
    ------
    InputError
        For a robot that has nothing to move, and wishes that mean nothing.
    """
    _refuse(model, wishes)
    names, scale = [p.name for p in model.recipe.parameters], scales(model)
    home = np.array(model.recipe.home_params, np.float64)
    for name, value in wishes.home.items():
        home[names.index(name)] = value
    limit = math.tan(wishes.slope)
    if model.faces == 1:
        limit = min(limit, model.chart_limit)
    along = np.linspace(-limit, limit, wishes.nodes)
    slopes = np.array([[u, v, -1.0] for u in along for v in along])
    postures, goal = lattice(model), Objective.of(wishes.objective, wishes.margin)
    tip, sdg = measured(model, postures, slopes, wishes.convention)
    move2 = (((postures - home) / scale) ** 2).sum(axis=1)
    n = wishes.nodes
    score = goal.score(tip, sdg, move2).reshape(n, n, -1)
    plain, smooth = (choose(postures, score, home, scale, w) for w in (0.0, wishes.within))

    def scored(params: Floats, places: Floats) -> Floats:
        uv = (2.0 * places - 1.0) * limit
        down = np.concatenate([uv, -np.ones((len(uv), 1))], axis=1)
        return goal.of_postures(model, params, down, home, scale, wishes.convention)

    enough = np.maximum(score.max(axis=2), -math.pi) - wishes.within
    alike = np.broadcast_to(postures[score.mean(axis=(0, 1)).argmax()], smooth.shape)
    smooth = polished((smooth, alike), enough, (model.lower, model.upper), scale, scored)
    codes, limit, joints = _coded(model, smooth, limit, _joints(model, wishes))
    policy = Policy(
        codes,
        limit,
        joints,
        wishes.cycle,
        wishes.latency,
        wishes.margin,
        wishes.levels,
        wishes.swerve,
        wishes.poses,
    )
    unseen = slopes_within(limit, UNSEEN)
    best = measured(model, postures, unseen, wishes.convention)[0].max(axis=1)
    found = loss(model, policy, unseen, best, wishes.convention, scale)
    jumps = max(
        float(np.degrees(np.abs(np.diff(plain / scale, axis=axis))).max(initial=0.0))
        for axis in (0, 1)
    )
    return Design(policy, found, jumps, UNSEEN)


def _joints(model: Model, wishes: Wishes) -> list[Joint]:
    """Return what the C knows of each parameter; low and code are still to be found."""
    limits, span = limits_of(model), model.upper - model.lower
    joints = []
    for at, parameter in enumerate(model.recipe.parameters):
        rate = wishes.rate.get(parameter.name, 0.25 * span[at]) * wishes.cycle
        delta = wishes.delta.get(parameter.name, span[at])
        joints.append(
            Joint(
                *(0.0, 0.0, rate, delta, NEAR * rate),
                *(float(row[at]) for row in (limits.reach, limits.bend, limits.lean)),
            )
        )
    return joints


def _coded(
    model: Model, values: Floats, limit: float, joints: list[Joint]
) -> tuple[np.ndarray, float, tuple[Joint, ...]]:
    """Return the codes (n, n, k) of postures, their limit, and the joints with their steps."""
    low, high = values.min(axis=(0, 1)), values.max(axis=(0, 1))
    step = np.maximum(high - low, 1e-6 * (model.upper - model.lower)) / CODES
    codes = np.rint((values - low) / step).clip(0, CODES).astype(np.uint8)
    found = (
        joint._replace(low=float(a), code=float(b))
        for joint, a, b in zip(joints, low, step, strict=True)
    )
    return codes, limit, tuple(found)


def _refuse(model: Model, wishes: Wishes) -> None:
    """Refuse what means nothing."""
    source, names = model.recipe.source, [p.name for p in model.recipe.parameters]
    if not names:
        raise InputError(f"{source}: the robot has no joint to control (got no parameter).")
    if model.is_tripod and model.k > MOST_JOINTS:
        raise InputError(
            f"{source}: of robots on three points control knows {MOST_JOINTS} joints (got "
            f"{model.k}); let several joints share a parameter."
        )
    for what, given in (("home", wishes.home), ("rate", wishes.rate), ("delta", wishes.delta)):
        for name, value in given.items():
            if name not in names:
                raise InputError(
                    f"{source}: --{what}: there is no parameter {name!r} (got {value:g}); it has "
                    f"{', '.join(names)}."
                )
            low, high = model.lower[names.index(name)], model.upper[names.index(name)]
            if what == "home" and not low <= value <= high:
                raise InputError(f"{source}: --home: {name} is off its axis (got {value:g}).")
            if what != "home" and not 0.0 < value < math.inf:
                raise InputError(f"{source}: --{what}: {name} is not above 0 (got {value:g}).")
    if not 2 <= wishes.nodes <= 65:
        raise InputError(f"--nodes: from 2 to 65 (got {wishes.nodes}).")
    if wishes.poses not in (1, 2):
        raise InputError(f"--poses: 1 or 2 (got {wishes.poses}).")
    if wishes.convention not in CONVENTIONS:
        raise InputError(
            f"--convention: one of {', '.join(CONVENTIONS)} (got {wishes.convention!r})."
        )
    if not 0.0 < wishes.slope < math.radians(89.0):
        raise InputError(f"--slope: above 0 and below 89 deg (got {math.degrees(wishes.slope):g}).")
    for what in ("cycle", "latency", "margin", "swerve"):
        if not 0.0 < getattr(wishes, what) < math.inf:
            raise InputError(f"--{what}: above 0 (got {getattr(wishes, what):g}).")
    if not math.inf > wishes.levels[0] > wishes.levels[1] > wishes.levels[2] > 0.0:
        raise InputError(f"--levels: three angles above 0, falling (got {wishes.levels}).")

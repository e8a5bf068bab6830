"""What a table loses against the best posture, on slopes that it has not seen; and how it jumps.

Owns the measurements that are printed.
"""

from typing import NamedTuple

import numpy as np

from firmware_export.protocol import Policy
from firmware_export.truth import Model
from lutgen.channels import body_gravity, evaluate_each
from lutgen.vector import Floats

SEED = 29


class Loss(NamedTuple):
    """Of a table: degrees of tip angle lost against the best posture of the lattice, and more.

    `tips` is the share of slopes on which the table's posture tips, though another stands;
    `step` the largest change (deg, or parts of a length's axis in 1/100) between two nodes.
    """

    bytes: int
    nodes: int
    mean: float
    p95: float
    largest: float
    least_tip: float
    tips: float
    step: float


def slopes_within(limit: float, count: int, seed: int = SEED) -> Floats:
    """Return slopes (m, 3) that are even over a table's square of u and v."""
    uv = np.random.default_rng(seed).uniform(-limit, limit, (count, 2))
    rows = np.concatenate([uv, -np.ones((count, 1))], axis=1)
    return np.asarray(rows / np.linalg.norm(rows, axis=1, keepdims=True))


def interpolated(policy: Policy, slopes: Floats) -> Floats:
    """Return the table's postures (m, k) for slopes (m, 3), as smap_target has them."""
    values = policy.values()
    n = len(values)
    uv = np.clip(slopes[:, :2] / -slopes[:, 2:], -policy.limit, policy.limit)
    at = (uv + policy.limit) * (n - 1) / (2.0 * policy.limit)
    node = np.clip(at.astype(int), 0, n - 2)
    part = (at - node)[:, :, None]
    i, j = node.T
    low = values[i, j] + (values[i, j + 1] - values[i, j]) * part[:, 1]
    high = values[i + 1, j] + (values[i + 1, j + 1] - values[i + 1, j]) * part[:, 1]
    return np.asarray(low + (high - low) * part[:, 0])


def loss(
    model: Model, policy: Policy, slopes: Floats, best: Floats, convention: str, scale: Floats
) -> Loss:
    """Return what a table loses on slopes (m, 3) on which the best tip angle is `best` (m,)."""
    postures = interpolated(policy, slopes)
    downs = body_gravity(model.recipe, postures, slopes, convention)
    tip = evaluate_each(model.recipe, postures, downs, ("tip_angle",))["tip_angle"]
    lost = np.degrees(np.maximum(best - np.maximum(tip, 0.0), 0.0))
    values = np.degrees(policy.values() / scale)
    steps = [np.abs(np.diff(values, axis=axis)).max(initial=0.0) for axis in (0, 1)]
    stands = best >= 0.0
    return Loss(
        *(policy.table_bytes, len(values)),
        *(float(lost.mean()), float(np.quantile(lost, 0.95)), float(lost.max())),
        float(np.degrees(tip[stands].min(initial=np.pi))),
        float((tip[stands] < 0.0).mean()) if stands.any() else 0.0,
        float(max(steps)),
    )

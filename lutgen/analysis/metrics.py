"""Metrics of stability side by side: one posture, many directions, five measures.

One is no channel of maps: the force-angle measure (Papadopoulos and Rey, 1996; in the form of
2000), which is made of the product of `tip_angle` and `margin`.  Only `tip_angle` is the verdict.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.analysis.posture import Posture
from lutgen.channels import JUST_OUTSIDE, checked_directions, evaluate
from lutgen.errors import InputError, reject
from lutgen.vector import Floats

CHANNELS = ("sdg", "tip_angle", "margin", "energy_margin")
METRICS = (*CHANNELS, "force_angle")
LEVEL = np.array([[0.0, 0.0, -1.0]])


@dataclass(frozen=True)
class Metrics:
    """Five metrics under g directions, by name: (g,) float64 each.

    `values` are in rad and the recipe's length unit, `force_angle` in rad x length for a weight
    of 1; `sdg` is NaN where the robot tips.  `normalised` are without unit: each is its value
    divided by that on level ground; of `sdg`, which is 0 at its best, it is 1 - |SD_g| / r with r
    the distance from the support polygon's centroid to its nearest side, the largest |SD_g| at
    which the robot stands wherever D_g lies.  `level` are the values on level ground.  `status`
    (g,) and `level_status` are those of the channel: 0 stands, 1 rocks, 2 tips; `least_share` (g,)
    is a channel, too.
    """

    standing: NDArray[np.bool_]
    status: Floats
    least_share: Floats
    values: dict[str, Floats]
    normalised: dict[str, Floats]
    level: dict[str, float]
    level_status: float


def compare_metrics(posture: Posture, gravity_dir: ArrayLike) -> Metrics:
    """Compute the metrics of one posture under directions (g, 3): down, body frame, any length > 0.

    Refused where the posture tips on level ground or has no tip-over axis to normalise by.
    """
    recipe = posture.recipe
    if recipe.com_uncertainty > 0.0:
        what = "key `robot.com_uncertainty`: metrics are those of one com"
        way_out = "leave it out to compare them"
        reject(recipe.source, what, f"{recipe.com_uncertainty:g}", way_out, InputError)
    directions = np.vstack([LEVEL, checked_directions(gravity_dir)])
    found = evaluate(recipe, posture.row, directions, (*CHANNELS, "least_share", "status"))
    status, least_share = found.pop("status")[0], found.pop("least_share")[0]
    values = {name: channel[0] for name, channel in found.items()}
    standing = values["tip_angle"] >= 0.0
    posture.refuse_forces()
    values["force_angle"] = force_angle(posture, directions, values["tip_angle"], values["margin"])
    angle = values["tip_angle"][0]
    if not angle > 0.0 or not len(posture.axes):
        degrees = f"{np.degrees(angle):.3g} deg"
        what = "metrics are compared with those on level ground, where this posture does not stand"
        got = f"a tip angle of {degrees}"
        reject(recipe.source, f"{what} or cannot tip", got, "choose another posture", InputError)
    normalised = {name: values[name][1:] / values[name][0] for name in METRICS if name != "sdg"}
    under = [posture.under(down) for down in directions[1:]]
    radius = np.array([np.nan if facet is None else facet.inradius for facet in under])
    normalised["sdg"] = 1.0 - values["sdg"][1:] / radius
    return Metrics(
        standing[1:],
        status[1:],
        least_share[1:],
        values={name: values[name][1:] for name in METRICS},
        normalised={name: normalised[name] for name in METRICS},
        level={name: float(values[name][0]) for name in METRICS},
        level_status=float(status[0]),
    )


def axis_force_angle(start: ArrayLike, stop: ArrayLike, force: ArrayLike) -> Floats:
    """Return the force-angle measure (...) of tip-over axes, rad x length x force.

    beta = theta |M|, theta = atan2(M, l . F), M = (start x stop) . F / |stop - start|, with l the
    arm from the com to the axis, across it: theta is positive where the force keeps the robot down.
    An arc cosine would leave [-1, 1] by rounding where the com is over the axis.

    `start` and `stop` (..., 3) are the axes' ends relative to the com, start x stop pointing to the
    inner side; `force` (..., 3) is the resultant at the com, a unit vector for weights.
    """
    begin, end, pull = (np.asarray(part, dtype=np.float64) for part in (start, stop, force))
    edge = end - begin
    along = edge / np.linalg.norm(edge, axis=-1, keepdims=True)
    arm = begin - (begin * along).sum(axis=-1, keepdims=True) * along
    # The arm counts, and not the end points: an axis may be long and its com near it.
    moment = (np.cross(arm, along) * pull).sum(axis=-1)
    angle = np.arctan2(moment, (arm * pull).sum(axis=-1))
    return np.asarray(angle * np.abs(moment))


def force_angle(posture: Posture, directions: Floats, angle: Floats, margin: Floats) -> Floats:
    """Return the force-angle measure (g,), rad x length for a weight of 1, under unit directions.

    It is the smallest over the tip-over axes, with the sign of the verdict; infinite without an
    axis, minus infinity without a support facet.  Where the standing region is not convex an axis
    ends at a corner of the region, and the measure is the product of `tip_angle` and `margin` (g,),
    which it equals on a level axis.
    """
    standing = angle >= 0.0
    axes = posture.axes
    if not (posture.facets and len(axes)):
        return np.where(standing, np.inf, -np.inf)
    if posture.convex:
        least = axis_force_angle(axes["start"], axes["stop"], directions[:, None, :]).min(axis=1)
    else:
        least = angle * np.abs(margin)
    return np.asarray(np.where(standing, np.maximum(least, 0.0), np.minimum(least, JUST_OUTSIDE)))

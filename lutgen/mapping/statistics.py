"""Compute numbers about a whole map, block by block."""

import numpy as np

from lutgen.mapping.stability_map import StabilityMap
from lutgen.quantities import QUANTITIES


def channel_range(stability_map: StabilityMap, name: str) -> tuple[float | None, float | None]:
    """Return the smallest and largest finite value of a channel, None where there is none."""
    ends: list[float] = []
    for _, values in stability_map.pieces(name):
        finite = values[np.isfinite(values)]
        if finite.size:
            ends += [float(finite.min()), float(finite.max())]
    return min(ends, default=None), max(ends, default=None)


def share_that_tips(stability_map: StabilityMap) -> float | None:
    """Return the share of directions in which the robot tips, averaged over the map's postures.

    Each node counts with the solid angle that it stands for, so it is a share of area on the
    sphere of the chart's directions; None for a map without `tip_angle`, `status`, `sdg` and
    `height`.
    """
    verdicts = ("tip_angle", "status", "sdg", "height")
    name = next((n for n in verdicts if n in stability_map.channels), None)
    if name is None:
        return None
    worst = len(QUANTITIES[name].words) - 1
    weight = stability_map.chart.solid_angle()
    # How many postures tip in each direction, (faces * nodes, nodes).
    tipping = np.zeros((weight.size // weight.shape[-1], weight.shape[-1]), np.int64)
    for row, values in stability_map.pieces(name):
        if worst >= 0:
            tips = values == worst
        else:
            tips = values < 0.0 if name == "tip_angle" else np.isnan(values)
        # A block is whole postures or a part of one.
        first = row % len(tipping)
        some = tipping[first : first + len(tips)]
        some += tips.reshape(-1, *some.shape).sum(axis=0)
    mean = tipping.reshape(weight.shape) / stability_map.recipe.grid.size
    return float((mean * weight).sum() / weight.sum())

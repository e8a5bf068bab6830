"""Numbers about a whole map."""

import numpy as np
from numpy.typing import NDArray

from lutgen.store import StabilityMap


def value_range(values: NDArray[np.float32]) -> tuple[float | None, float | None]:
    """Return the smallest and largest finite value, None where there is none."""
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return None, None
    return float(finite.min()), float(finite.max())


def share_that_tips(stability_map: StabilityMap) -> float | None:
    """Return the share of directions in which the robot tips, averaged over the map's postures.

    Each node counts with the solid angle that it stands for, so it is a share of area on the
    sphere of the chart's directions; None for a map without `tip_angle`, `sdg` and `height`.
    """
    if "tip_angle" in stability_map.channels:
        tips = stability_map.channel("tip_angle") < 0.0
    elif "sdg" in stability_map.channels:
        tips = np.isnan(stability_map.channel("sdg"))
    elif "height" in stability_map.channels:
        tips = np.isnan(stability_map.channel("height"))
    else:
        return None
    weight = stability_map.chart.solid_angle()
    mean = tips.reshape(-1, *weight.shape).mean(axis=0)
    return float((mean * weight).sum() / weight.sum())

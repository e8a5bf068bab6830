"""Where great arcs of directions leave the standing region, by false position on the tip angle.

The facets of a posture, which cost most, are found once for all steps of all its arcs.
"""

import math

import numpy as np

from firmware_export.model.exact import Model
from lutgen.channels import (
    Memory,
    Setting,
    acceptance_of,
    find_axes,
    measure,
    measure_loaded,
    own_memory,
    primitives_of,
    wrenches,
)
from lutgen.jit import in_threads, njit
from lutgen.quantities import CHANNELS, wanted
from lutgen.support import stand
from lutgen.vector import Floats, Vector, add, length, row, scale, subtract

# Most steps to the boundary: by then nearly all brackets are narrower than a float32 resolves.
STEPS = 17
TINY = 1e-300
# Shortest step (rad) across the boundary; where both ends' tip angles differ by less, the last.
FINEST = 1e-8
TIP = CHANNELS.index("tip_angle")


@njit(exact=True)
def unit_as_read(v: Vector) -> Vector:
    """Return a direction as `unit_directions` does, to the bit.

    Beside the boundary the last bit decides, and a caller normalises a direction that is found
    here once more.
    """
    size = max(abs(v[0]), abs(v[1]), abs(v[2]))
    x, y, z = v[0] / size, v[1] / size, v[2] / size
    long = math.sqrt(x * x + y * y + z * z)
    return (x / long, y / long, z / long)


@njit(bare=True)
def cross_some(
    span: tuple[int, int],
    memory: Memory,
    primitives: Floats,
    wrench: Floats | None,
    setting: Setting,
    low: Floats,
    high: Floats,
) -> None:
    """Close in the arcs of a span of postures; `low` and `high` (m, d, 3) change in place."""
    (region, axes, values), wanted = memory, setting.wanted
    for posture in range(span[0], span[1]):
        stand(region, primitives[posture], setting.acceptance)
        if wrench is not None:
            find_axes(region, wrench[posture], axes)
        for d in range(low.shape[1]):
            stands, tips = row(low[posture], d), row(high[posture], d)
            below = above = 0.0
            for turn in range(-2, STEPS):
                if turn == -2:
                    at = stands
                elif turn == -1:
                    at = tips
                else:
                    way = subtract(tips, stands)
                    gap = length(way)
                    share = 0.5
                    if turn % 3 == 0:
                        share = below / max(below - above, TINY)
                    elif turn % 3 == 1:
                        # False position leaves one end behind.  The tip angle changes by less than
                        # the way, seldom by less than a third of it: this far beyond the near end
                        # is the other side.
                        step = max(3.0 * min(below, -above), FINEST)
                        near = min(step / max(gap, TINY), 0.5)
                        share = near if below < -above else 1.0 - near
                    at = add(stands, scale(way, min(max(share, 0.0), 1.0)))
                    at = unit_as_read(at)
                g = unit_as_read(at)
                if wrench is None:
                    measure(region, g, wanted, values)
                else:
                    measure_loaded(region, axes, wrench[posture], g, wanted, values)
                angle = values[TIP]
                if turn == -2:
                    below = angle
                elif turn == -1:
                    above = angle
                elif angle >= 0.0:
                    stands, below = at, angle
                else:
                    tips, above = at, angle
                if turn >= 0 and below - above < FINEST:
                    break
            for i in range(3):
                low[posture, d, i], high[posture, d, i] = stands[i], tips[i]


def cross_boundary(
    model: Model, params: Floats, inside: Floats, outside: Floats
) -> tuple[Floats, Floats]:
    """Find where great arcs of postures (m, k) leave the standing region.

    `inside` and `outside` (m, d, 3), down, are the ends of the arcs: a direction under which the
    posture stands and one under which it tips, not opposite.  Returns directions on the arc, unit,
    either side of the boundary: most are 1e-8 rad apart.
    """
    recipe, postures = model.recipe, model.postures(params)
    primitives = primitives_of(recipe, postures)
    wrench = wrenches(recipe, postures) if recipe.loaded else None
    setting = Setting(acceptance_of(recipe), np.array(wanted(("tip_angle",))))
    low, high = unit(inside), unit(outside)
    arguments = (own_memory, primitives, wrench, setting, low, high)
    # A posture with its arcs is worth a thread after a tenth of a millisecond of work.
    in_threads(cross_some, len(primitives), *arguments, least=32)
    return low, high


def unit(vectors: Floats) -> Floats:
    """Return vectors (..., 3) with length 1; they must not be zero."""
    length: Floats = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
    return np.asarray(vectors / length)

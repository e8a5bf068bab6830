"""A recipe into a map file, and a map file into values.

In reading order: `interpolate`, `blocks`, `checksum`, `identity`, `seal`, `probe`, `template`,
`admission`, `labelled`, `map`, `verification`, `statistics`, `layout`, `part`, `compute`, `dask`,
`sweeper`.
"""

from lutgen.mapping.blocks import plan
from lutgen.mapping.compute import TO_STAND, expected_seconds, require_standing
from lutgen.mapping.map import StabilityMap, load_map
from lutgen.mapping.statistics import channel_range, share_that_tips
from lutgen.mapping.sweeper import sweep
from lutgen.mapping.verification import verify

__all__ = [
    "TO_STAND",
    "StabilityMap",
    "channel_range",
    "expected_seconds",
    "load_map",
    "plan",
    "require_standing",
    "share_that_tips",
    "sweep",
    "verify",
]

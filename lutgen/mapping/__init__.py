"""Turn a recipe into a map file, and a map file into values.

In reading order: `head`, `stability_map`, `opening`, `compute`, `part`, `dask`, `sweeper`.
"""

from lutgen.mapping.compute import TO_STAND, expected_seconds, require_standing
from lutgen.mapping.head import plan
from lutgen.mapping.opening import load_map
from lutgen.mapping.stability_map import StabilityMap, channel_range, share_that_tips, verify
from lutgen.mapping.sweeper import sweep

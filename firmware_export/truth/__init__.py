"""What an export stands for: the exact answers, and where they are asked.

In reading order: `model`, `crossing`, `tip_boundary`, `sample`, `series`, `rest`.
"""

from firmware_export.truth.crossing import cross_boundary, unit
from firmware_export.truth.model import Exact, Model, combinations, slack, widened
from firmware_export.truth.rest import least_edge_of
from firmware_export.truth.sample import (
    Cells,
    Sample,
    biased,
    join,
    uniform,
    uniform_directions,
    uniform_params,
)
from firmware_export.truth.series import chebyshev_nodes, chebyshev_transform, rounds
from firmware_export.truth.tip_boundary import on_chart

"""The reference of an export: exact answers, and where they are asked.

In reading order: `model`, `crossing`, `sample`, `rest`.
"""

from firmware_export.truth.crossing import cross_boundary, unit
from firmware_export.truth.model import Exact, Model, combinations, slack, widened
from firmware_export.truth.rest import chebyshev_nodes, chebyshev_transform, least_edge_of, rounds
from firmware_export.truth.sample import (
    Cells,
    Sample,
    biased,
    join,
    on_chart,
    uniform,
    uniform_directions,
    uniform_params,
)

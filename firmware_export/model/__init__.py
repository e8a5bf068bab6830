"""The reference of an export: exact answers, and where they are taken.

In reading order: `exact`, `crossing`, `sample`, `rest`.
"""

from firmware_export.model.crossing import cross_boundary, unit
from firmware_export.model.exact import Exact, Model, combinations, sensor_tolerance, widened
from firmware_export.model.rest import chebyshev_nodes, chebyshev_transform, least_edge_of, rounds
from firmware_export.model.sample import (
    Cells,
    Sample,
    biased,
    on_chart,
    uniform,
    uniform_directions,
    uniform_params,
)

"""What an export stands for: the exact answers, and where they are asked.

In reading order: `model`, `tip_boundary`, `sample`.
"""

from firmware_export.truth.model import Exact, Model, combinations
from firmware_export.truth.sample import Cells, Sample, biased, join, uniform, uniform_directions
from firmware_export.truth.tip_boundary import boundary, on_chart, unit

__all__ = [
    "Cells",
    "Exact",
    "Model",
    "Sample",
    "biased",
    "boundary",
    "combinations",
    "join",
    "on_chart",
    "uniform",
    "uniform_directions",
    "unit",
]

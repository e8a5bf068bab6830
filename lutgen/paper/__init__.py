"""The published method: its simulations, table, figures and errata, computed again.

In reading order: `model`, `simulations`, `tables`, `report`.
"""

from lutgen.paper.report import write_report

"""Questions that vary the posture: optima, and paths over terrain.

In reading order: `objective`, `methods`, `optima`, `terrain`, `driving`.
"""

from lutgen.search.driving import Drive, drive
from lutgen.search.objective import Objective
from lutgen.search.optima import Optimum, optimum
from lutgen.search.terrain import Path, along, paper_path, read_path, read_rows, turned

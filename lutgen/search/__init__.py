"""Questions that vary the posture: optima, and paths over terrain.

In reading order: `objective`, `methods`, `optima`, `terrain`, `terrain_csv`, `driving`.
"""

from lutgen.search.driving import Drive, drive
from lutgen.search.objective import Objective
from lutgen.search.optima import Optimum, optimum
from lutgen.search.terrain import Path, paper_path, turned
from lutgen.search.terrain_csv import read_path, read_rows

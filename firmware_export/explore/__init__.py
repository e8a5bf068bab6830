"""One offline page on which a robot is moved by hand: what `lutgen explore` writes.

In reading order: `tables`, `scene`, `page`.
"""

from firmware_export.explore.page import page_text
from firmware_export.explore.scene import scene_of
from firmware_export.explore.tables import Answers, answers_of_export, answers_of_recipe

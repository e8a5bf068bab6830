"""A robot description becomes the text of a recipe.

In reading order: `contacts`, `opened`, `symmetry`, `couplings`, `doubts`, `text`, `proposal`.
"""

from lutgen.propose.couplings import Coupling
from lutgen.propose.doubts import recipe_doubts
from lutgen.propose.proposal import Imported, import_urdf

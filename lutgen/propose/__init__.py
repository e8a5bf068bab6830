"""A robot description becomes the text of a recipe.

In reading order: `standing`, `contacts`, `opened`, `effects`, `symmetry`, `couplings`, `doubts`,
`text`, `proposal`.
"""

from lutgen.propose.couplings import Coupling
from lutgen.propose.doubts import recipe_doubts
from lutgen.propose.proposal import Imported, import_urdf
from lutgen.propose.standing import Standing, standing_posture

__all__ = ["Coupling", "Imported", "Standing", "import_urdf", "recipe_doubts", "standing_posture"]

"""A robot description becomes the text of a recipe.

In reading order: `candidates`, `bolted`, `recognised`, `joint_names`, `symmetry`, `coupling`,
`chosen`, `doubts`, `proposal_text`, `proposal`.
"""

from lutgen.propose.coupling import Coupling
from lutgen.propose.proposal import Imported, import_urdf

__all__ = ["Coupling", "Imported", "import_urdf"]

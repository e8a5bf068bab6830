"""Where descriptions of real robots are: they are other people's files, and not kept here."""

import os
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDER = Path(os.environ.get("LUTGEN_ROBOTS", ROOT.parent / "shared" / "robots"))

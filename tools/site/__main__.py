"""Build the site: ``python -m tools.site [FOLDER]``, by default build/site.

Ends with another code than 0 if Sphinx has anything to warn of.
"""

import shutil
import sys
from pathlib import Path

from sphinx.cmd.build import main as sphinx

from tools.site.staging import Stage

ROOT = Path(__file__).resolve().parents[2]


def build(site: Path) -> int:
    """Build the site into a folder, with its work beside it; return Sphinx's exit code."""
    source, work = site.with_name(f"{site.name}-source"), site.with_name(f"{site.name}-work")
    explorers = ROOT / "build" / "explorer"
    Stage(ROOT, source, explorers).fill()
    settings = ["-c", str(Path(__file__).parent), "-d", str(work)]
    code = sphinx(["-q", "-W", "--keep-going", *settings, str(source), str(site)])
    if code:
        # A page that was read is not read again, and would not be warned of again.
        shutil.rmtree(work, ignore_errors=True)
    if explorers.is_dir():
        shutil.copytree(explorers, site / "explorer", dirs_exist_ok=True)
    return code


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "build" / "site"
    sys.exit(build(target.resolve()))

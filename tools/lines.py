"""Count the lines that are written by hand against their ceilings: `python tools/lines.py`.

Exits with 1 where one is above its ceiling, and lists the longest files.
"""

import subprocess
import sys
from collections import Counter
from pathlib import Path

# To come: product 30,000, tests 15,000, lab 8,500, docs 4,500, and no file above LONGEST.
CEILINGS = {"product": 38_850, "tests": 18_525, "lab": 8_280, "docs": 4_315}
LONGEST = 330
ROOMS = {"lutgen": "product", "firmware_export": "product", "tests": "tests"}
ROOMS |= dict.fromkeys(("targets", "proofs", "benchmarks", "tools"), "lab")
SUFFIXES = {".py", ".c", ".h", ".js", ".j2", ".css"}


def part(path: Path) -> str | None:
    """Return which part of the project a file belongs to."""
    if path.suffix == ".md" and path.parts[0] in ("docs", path.name):
        return None if path.name == "CHANGELOG.md" else "docs"
    made = "built" in path.parts or path.name.startswith("three")
    return None if made or path.suffix not in SUFFIXES else ROOMS.get(path.parts[0])


def main() -> int:
    """Print the counts and the longest files; return an exit code."""
    root = Path(__file__).resolve().parent.parent
    listed = subprocess.run(["git", "ls-files"], cwd=root, capture_output=True, check=True)
    counts: Counter[str] = Counter()
    lengths = {}
    for path in map(Path, listed.stdout.decode().splitlines()):
        name = part(path)
        if name and (root / path).is_file():
            lines = (root / path).read_bytes().count(b"\n")
            counts[name] += lines
            if name != "docs" and lines > LONGEST:
                lengths[path] = lines
    for name, ceiling in CEILINGS.items():
        over = "  over" if counts[name] > ceiling else ""
        print(f"{name:8} {counts[name]:7,} of {ceiling:7,}{over}")
    print(f"{len(lengths)} files of more than {LONGEST} lines")
    for path, lines in sorted(lengths.items(), key=lambda item: -item[1])[:10]:
        print(f"{lines:8} {path}")
    return int(any(counts[name] > ceiling for name, ceiling in CEILINGS.items()))


if __name__ == "__main__":
    sys.exit(main())

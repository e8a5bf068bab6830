"""What pyproject.toml and requirements.txt say of dependencies: `python -m tools.pins WHAT`.

`oldest` prints the lower bound of each dependency as a constraint, for `make oldest`; `bill` prints
what is locked, with its digests, as a CycloneDX bill of materials, for `make bill`.
"""

import json
import re
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

__all__ = ["Locked", "bill", "bounds", "locked", "oldest"]

ROOT = Path(__file__).resolve().parent.parent
LOCK = ROOT / "requirements.txt"
BOUND = re.compile(r"([a-z0-9-]+)>=([0-9.]+),<([0-9.]+)")


def bounds() -> dict[str, tuple[str, str]]:
    """Return the oldest version of each dependency, and the first that is too new.

    Raises
    ------
    ValueError
        If one has no bounds of this form.
    """
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    extras = project["project"]["optional-dependencies"].values()
    listed = [*project["project"]["dependencies"], *(need for extra in extras for need in extra)]
    listed += project["build-system"]["requires"]
    found: dict[str, tuple[str, str]] = {}
    for need in listed:
        match = BOUND.fullmatch(need)
        if match is None:
            raise ValueError(f"pyproject.toml: {need} has no bounds; write name>=1.2,<3")
        name, low, high = match.groups()
        if found.setdefault(name, (low, high)) != (low, high):
            raise ValueError(f"pyproject.toml: {name} has other bounds elsewhere (got {need})")
    return found


def oldest() -> Iterator[str]:
    """Return each lower bound as a constraint for an installer."""
    for name, (low, _) in sorted(bounds().items()):
        # The bound 1.26 is met by any 1.26.x, of which the newest has its errors mended.
        yield f"{name}~={low}.0" if low.count(".") == 1 else f"{name}=={low}"


@dataclass
class Locked:
    """One line of the lock: a version, where it is for (an environment marker), its SHA-256s."""

    name: str
    version: str
    marker: str
    digests: list[str] = field(default_factory=list)


def locked() -> list[Locked]:
    """Return what is locked, in the order of the file; some names have a version per Python."""
    found: list[Locked] = []
    for line in LOCK.read_text("utf-8").splitlines():
        if match := re.match(r"([A-Za-z0-9_.-]+)==([^ ;]+)(?: ; (.*?))?(?: \\)?$", line):
            found.append(Locked(match[1], match[2], match[3] or ""))
        elif match := re.fullmatch(r"    --hash=sha256:([0-9a-f]{64})(?: \\)?", line):
            found[-1].digests.append(match[1])
        else:
            raise ValueError(f"requirements.txt: {line!r} is no locked version; run `make lock`")
    return found


def bill() -> str:
    """Return what is locked as CycloneDX."""
    components: list[dict[str, Any]] = [
        {
            "type": "library",
            "bom-ref": f"{one.name}@{one.version}",
            "name": one.name,
            "version": one.version,
            "purl": f"pkg:pypi/{one.name}@{one.version}",
            # An archive of each platform has a digest of its own.
            "properties": [
                *([{"name": "lutgen:marker", "value": one.marker}] if one.marker else []),
                *({"name": "lutgen:sha256", "value": digest} for digest in one.digests),
            ],
        }
        for one in locked()
    ]
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["name"]
    document = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "version": 1,
        "metadata": {"component": {"type": "application", "bom-ref": project, "name": project}},
        "components": components,
    }
    return json.dumps(document, indent=1)


if __name__ == "__main__":
    print(bill() if sys.argv[1:] == ["bill"] else "\n".join(oldest()))

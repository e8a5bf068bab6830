"""The rows of the table of proofs, and what brings the programs that they need."""

from dataclasses import dataclass

# Program: Debian packages that bring it.
PACKAGES = {"frama-c": "frama-c-base", "gcc": "gcc", "clang": "clang libclang-rt-14-dev llvm"}
OK, FAILED, SKIPPED = "passed", "FAILED", "SKIPPED"


@dataclass(frozen=True)
class Result:
    """One row of the table: `state` is "passed", "FAILED" or "SKIPPED"."""

    proof: str
    subject: str
    state: str
    text: str
    seconds: float = 0.0

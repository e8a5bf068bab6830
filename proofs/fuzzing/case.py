"""One run of the command line: its files, its words, and what it may answer."""

from collections.abc import Mapping
from dataclasses import dataclass, field

__all__ = ["ANSWERS", "Case", "Outcome"]

# 0 all is fine, 1 the task failed, 2 the input is wrong, 3 the robot tips or nobody can tell.
ANSWERS = frozenset((0, 1, 2, 3))


@dataclass(frozen=True)
class Case:
    """What is run in an empty folder that holds `files`, by name, and nothing else.

    `must` are the exit codes that are right, `written` the names that the run may write, and
    `then` what is run after it where it ended with 0: each of these has to end with 0, too.
    `environment` is that of a process of its own, where there is any.
    """

    label: str
    files: Mapping[str, bytes]
    words: tuple[str, ...]
    must: frozenset[int] = ANSWERS
    written: tuple[str, ...] = ()
    then: tuple[tuple[str, ...], ...] = ()
    environment: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Outcome:
    """How a run ended: its exit code (negative: the signal), what it said, what it took.

    `seconds` is infinite where it was stopped; `peak` is the most memory that it held, in bytes;
    `touched` names the files of the case that it changed, and those that it left unasked.
    """

    code: int
    stdout: str
    stderr: str
    seconds: float
    peak: int
    touched: tuple[str, ...] = ()

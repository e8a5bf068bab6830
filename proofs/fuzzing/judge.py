"""What is wrong with how a run ended, in a few words; the same words for the same fault."""

import json
import re

from proofs.fuzzing.case import Case, Outcome
from proofs.fuzzing.runner import PATIENCE
from proofs.fuzzing.worker import MEMORY

__all__ = ["FAULTS", "fault"]

# The words with which what `fault` returns begins, in the order of the table.
FAULTS = ("traceback", "signal", "slow", "memory", "exit code", "output", "message", "files")
# The longest message that one still reads; what it quotes has to be cut.
LONGEST = 8000
CODE_AFTER = -1000


def fault(case: Case, outcome: Outcome) -> str:
    """Return what is wrong, "" if nothing."""
    said = outcome.stderr
    if "Traceback (most recent call last)" in said:
        return f"traceback: {_where(said)}"
    # What a last resort says instead of one is no better for whoever reads it.
    if unforeseen := re.search(r"this is a fault of lutgen \(got (.*)\);", said):
        return f"traceback: {re.sub(r'[0-9]{5,}', '#', unforeseen[1])[:120]}"
    if "the memory is not enough" in said:
        return f"memory: {case.words[0]} asks for more than there is"
    if outcome.seconds > PATIENCE:
        return f"slow: {case.words[0] if case.words else 'lutgen'} takes over {PATIENCE:.0f} s"
    if outcome.peak > MEMORY:
        return f"memory: {case.words[0]} holds {outcome.peak / 2**30:.1f} GiB"
    if outcome.code == CODE_AFTER:
        return f"output: what it wrote is not taken: {_short(said)}"
    if outcome.code < 0:
        return f"signal: {-outcome.code}"
    if outcome.code not in case.must:
        return f"exit code: {case.words[0]} ended with {outcome.code}: {_short(said)}"
    if outcome.code in (1, 2) and not re.search(r"^(Error|lutgen)?: ?\S|Error: +\S", said, re.M):
        return f"message: {case.words[0]} ended with {outcome.code} and gave no reason"
    if len(said) > LONGEST:
        return f"message: {len(said):,} characters of {case.words[0]}"
    if re.search(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]", said):
        return f"message: control characters in what {case.words[0]} says"
    if outcome.code in (0, 3) and "--json" in case.words and not _is_json(outcome.stdout):
        return f"output: {case.words[0]} --json prints no JSON: {_short(outcome.stdout)}"
    if outcome.touched:
        return f"files: {case.words[0]} left or changed {', '.join(outcome.touched)}"
    return ""


def _where(text: str) -> str:
    """Return the last place of ours in a traceback, and the exception."""
    ours = re.findall(r'File ".*?((?:lutgen|firmware_export)/[\w/]+\.py)", line (\d+)', text)
    last = [
        line for line in text.strip().splitlines() if re.match(r"[\w.]+(Error|Exception|:)", line)
    ]
    name = (last[-1] if last else "?").partition(":")[0]
    return f"{name} at {':'.join(ours[-1]) if ours else '?'}"


def _short(text: str) -> str:
    lines = [line for line in text.strip().splitlines() if line.strip()]
    return re.sub(r"\d+(\.\d+)?(e[-+]?\d+)?", "#", lines[-1])[:120] if lines else "nothing said"


def _is_json(text: str) -> bool:
    def refuse(word: str) -> None:
        raise ValueError(f"{word} is no JSON")

    # --help beside --json prints help.
    if text.startswith("Usage:") or "version" in text[:40]:
        return True
    try:
        json.loads(text, parse_constant=refuse)
    except ValueError:
        return False
    return True

"""The choice among sizes of a codec whose encodings take a minute: a handful, each foreseen.

Owns which sizes are encoded.  The codec says how many nodes of which axis go together and how many
bytes a size has, both before anything is fitted; what is left is how many nodes each table gets.
For flash alone that is all there is room for.  For an error every table starts small, and the one
that is farthest from its goal grows by as much as its error has to fall.
"""

from typing import Any

from firmware_export.choose.candidate import Bench, Candidate
from firmware_export.choose.goal import GIVEN_UP, Goal
from firmware_export.codecs import codec

__all__ = ["climb_dear"]

# Shares of the nodes of each table: the verdict first.
SHARES = {"tip": 0.85, "sdg": 0.12, "height": 0.03}
# Nodes of all tables: at first where an error is asked for, and at most.
FIRST, MOST = 8_000, 120_000
# Encodings at most.
ENCODINGS = 6
# Errors fall with the root of a table's nodes where it has four axes.  Bounds of one growth, and
# the share to which an error must fall for its table to be grown again.
LEAST_GROWTH, MOST_GROWTH, GAIN = 1.4, 4.0, 0.93
# Percent below which codes of 8 bits are too coarse.
COARSE = 0.4


def climb_dear(bench: Bench, name: str, goal: Goal, ceiling: int) -> None:
    """Try the few sizes of a codec that may meet a goal in at most `ceiling` bytes.

    The smallest size is tried if none is small enough, for the refusal to name it.  Nothing is
    tried where another codec has met the goal and this one could not be better.
    """
    rivals = [one for one in bench.tried.values() if one is not None and _good(one, goal)]
    if goal.percent is None and any(goal.score(one) <= 1.0 for one in rivals):
        return
    bits = 8 if goal.percent is None or goal.aim >= COARSE else 16
    held = [table for table in SHARES if table == "tip" or table in bench.channels]
    whole = sum(SHARES[table] for table in held)
    share = {table: SHARES[table] / whole for table in held}
    most = MOST if goal.percent is None else FIRST
    nodes = _largest(bench, name, {}, share, bits, ceiling, most)
    if rivals and _bytes(bench, name, nodes, bits) > ceiling:
        return
    now = _try(bench, name, nodes, bits)
    if goal.percent is None:
        return
    stuck: set[str] = set()
    for _ in range(ENCODINGS - 1):
        if now is None:
            return
        # The lengths before the verdict: what cannot reach the error is refused early.
        wanting = {table: _term(now, table, goal) for table in held if table != "tip"}
        table = max(wanting, key=lambda at: wanting[at], default="tip")
        if wanting.get(table, 0.0) <= 1.0:
            if not goal.holds(now) and now.false_safe == 0:
                return  # the tip angle's error, which no size bounds
            table = "tip"
        elif table in stuck:
            return
        term = _term(now, table, goal)
        if term <= 1.0 or table in stuck:
            return
        growth = min(max(term * term, LEAST_GROWTH), MOST_GROWTH)
        room = MOST - sum(nodes.values())
        extra = min(int((growth - 1.0) * nodes[table]), room)
        larger = _largest(bench, name, nodes, {table: 1.0}, bits, ceiling, extra)
        if _spec(bench, name, larger, bits) == now.export.tables.spec:
            stuck.add(table)
            continue
        nodes, now = larger, _try(bench, name, larger, bits)
        if now is not None and _term(now, table, goal) > GAIN * term:
            stuck.add(table)


def _good(one: Candidate, goal: Goal) -> bool:
    return goal.holds(one) and goal.fits(one) and one.given_up <= GIVEN_UP


def _term(one: Candidate, table: str, goal: Goal) -> float:
    """Return how far a table is from what it is wanted for: 1 where it just serves."""
    if table == "tip":
        return one.given_up / GIVEN_UP
    return one.errors[table] / goal.aim


def _spec(bench: Bench, name: str, nodes: dict[str, int], bits: int) -> Any:
    tool: Any = codec(name)
    return tool.of_nodes(bench.model, bench.channels, nodes, bits)


def _bytes(bench: Bench, name: str, nodes: dict[str, int], bits: int) -> int:
    """Return the bytes of a size, code included; nothing is fitted."""
    tool: Any = codec(name)
    blank = tool.blank(bench.model, bench.channels, _spec(bench, name, nodes, bits))
    return bench.bytes_of(name, blank)[2]


def _try(bench: Bench, name: str, nodes: dict[str, int], bits: int) -> Candidate | None:
    return bench.try_out(name, _spec(bench, name, nodes, bits))


def _largest(
    bench: Bench,
    name: str,
    nodes: dict[str, int],
    share: dict[str, float],
    bits: int,
    ceiling: int,
    most: int,
) -> dict[str, int]:
    """Return `nodes` and as many more as fit, at most `most`, handed out by `share`."""

    def more(count: int) -> dict[str, int]:
        return nodes | {at: nodes.get(at, 0) + int(part * count) for at, part in share.items()}

    low, high = 0, most
    while low < high:
        middle = (low + high + 1) // 2
        fits = _bytes(bench, name, more(middle), bits) <= ceiling
        low, high = (middle, high) if fits else (low, middle - 1)
    return more(low)

"""The choice among sizes of a codec whose encodings take a minute: a handful, each foreseen.

Owns which sizes are encoded.  The codec says how many nodes of which axis go together and how many
bytes a size has, both before anything is fitted; what is left is how many nodes each table gets.
For flash alone that is all there is room for.  For an error every table starts small, and the one
that is farthest from its goal grows by as much as its error has to fall.
"""

from typing import Any, NamedTuple

from firmware_export.choose.goal import MOST_FALSE_TIP, Goal
from firmware_export.choose.trials import Candidate, Trials
from firmware_export.protocol import CodecInfo, Foresight

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


Nodes = dict[str, int]


class _Sizes(NamedTuple):
    """The sizes of a codec, by the nodes of each table, that take at most `ceiling` bytes."""

    trials: Trials
    codec: CodecInfo
    foresight: Foresight
    bits: int
    ceiling: int

    def spec(self, nodes: Nodes) -> Any:
        trials = self.trials
        return self.foresight.of_nodes(trials.model, trials.channels, nodes, self.bits)

    def try_out(self, nodes: Nodes) -> Candidate | None:
        return self.trials.try_out(self.codec, self.spec(nodes))

    def fits(self, nodes: Nodes) -> bool:
        """Tell whether a size, code included, keeps to the ceiling; nothing is fitted."""
        trials = self.trials
        blank = self.foresight.blank(trials.model, trials.channels, self.spec(nodes))
        return trials.bytes_of(self.codec, blank)[2] <= self.ceiling

    def largest(self, nodes: Nodes, share: dict[str, float], most: int) -> Nodes:
        """Return `nodes` and as many more as fit, at most `most`, handed out by `share`."""

        def more(count: int) -> Nodes:
            return nodes | {at: nodes.get(at, 0) + int(part * count) for at, part in share.items()}

        low, high = 0, most
        while low < high:
            middle = (low + high + 1) // 2
            low, high = (middle, high) if self.fits(more(middle)) else (low, middle - 1)
        return more(low)


def foresee(
    trials: Trials, codec: CodecInfo, foresight: Foresight, goal: Goal, ceiling: int
) -> None:
    """Try the few sizes of a costly codec that may meet a goal in at most `ceiling` bytes.

    The smallest size is tried if none is small enough, for the refusal to name it.  Nothing is
    tried where another codec has met the goal and this one could not be better.
    """
    rivals = [one for one in trials.candidates if goal.serves(one) and goal.fits(one)]
    if goal.percent is None and any(goal.score(one) <= 1.0 for one in rivals):
        return
    bits = 8 if goal.percent is None or goal.aim >= COARSE else 16
    sizes = _Sizes(trials, codec, foresight, bits, ceiling)
    held = [table for table in SHARES if table == "tip" or table in trials.channels]
    whole = sum(SHARES[table] for table in held)
    share = {table: SHARES[table] / whole for table in held}
    nodes = sizes.largest({}, share, MOST if goal.percent is None else FIRST)
    if rivals and not sizes.fits(nodes):
        return
    now = sizes.try_out(nodes)
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
                return  # the tip angle's error: a tree tells none
            table = "tip"
        elif table in stuck:
            return
        term = _term(now, table, goal)
        if term <= 1.0 or table in stuck:
            return
        growth = min(max(term * term, LEAST_GROWTH), MOST_GROWTH)
        room = MOST - sum(nodes.values())
        larger = sizes.largest(nodes, {table: 1.0}, min(int((growth - 1.0) * nodes[table]), room))
        if sizes.spec(larger) == now.export.tables.spec:
            stuck.add(table)
            continue
        nodes, now = larger, sizes.try_out(larger)
        if now is not None and _term(now, table, goal) > GAIN * term:
            stuck.add(table)


def _term(one: Candidate, table: str, goal: Goal) -> float:
    """Return how far a table is from what it is wanted for: 1 where it just serves."""
    if table == "tip":
        return one.false_tip / MOST_FALSE_TIP
    return one.errors[table] / goal.aim

"""An upper bound of the instructions of a read, from the machine code and the bounds of its loops.

Method: of every function the graph of its instructions; a strongly connected part is a loop, goes
round as often as the loop of smap.c whose head it holds (targets/loops.py), each time along its
longest way; what is then left has no cycles, and the longest way through it is the bound.  Loops
that share a counter of rounds for a whole call are left out of that, and all rounds of the counter
added, each as the dearest of any of them.  Every instruction counts 1, also one that an IT block
skips, as the emulator counts.  No path is excluded because its conditions contradict each other, so
the bound is safe and not tight.
"""

import math
from bisect import bisect_right
from collections.abc import Collection, Iterable, Mapping, Sequence

from lutgen.errors import ExportError
from targets.heads import spans, starts
from targets.listing import Instruction, parse
from targets.loops import Shape, bounds, called, counted, totals

# Most bytes that smap.c copies or clears at once by a call: rounds of a loop of the C library.
LARGEST_COPY = 64
# Instructions with which the image calls through smap.h and the map, which the counts hold too.
CALL = 16


class Bounds:
    """Bounds of the functions of an image.

    Parameters
    ----------
    functions : dict
        See `parse`.
    rounds : dict of int to int
        Line of smap.c that has a loop's head -> most rounds.
    starts : list of int
        Lines of smap.c at which a function's body begins.
    totals : dict of int to int
        Line of a loop's head -> most rounds during all of the loop round it, where that is known.
    spans : dict of int to int
        Line of a loop's head -> line on which its body ends.
    counted : dict of int to (str, int, int)
        Line of a loop's head -> the counter that bounds its rounds during a whole call, where that
        begins, and by how much each round alters it.
    called : dict of str to (int, int)
        Function -> the work that each call takes, and how often it may be called without.
    work : int
        The most of it.
    """

    def __init__(
        self,
        functions: Mapping[str, list[Instruction]],
        rounds: Mapping[int, int],
        starts: Sequence[int],
        totals: Mapping[int, int],
        spans: Mapping[int, int],
        counted: Mapping[int, tuple[str, int, int]],
        called: Mapping[str, tuple[int, int]],
        work: int,
    ) -> None:
        self.functions, self.rounds, self.starts = functions, rounds, starts
        self.totals, self.spans = totals, spans
        self.counted, self.called, self.work = counted, called, work
        self.known: dict[str, int] = {}
        # Function -> counter -> where it begins and the most that one of it takes, with callees.
        self.units: dict[str, dict[str, tuple[int, float]]] = {}

    def place(self, line: int | None) -> int:
        """Return the number of the function of smap.c in which a line stands."""
        return bisect_right(self.starts, line or 0)

    def around(self, lines: Collection[int]) -> int | None:
        """Return the head of the innermost loop of smap.c whose body has all of these lines.

        Only those of the function that stands last count: what it calls may be taken into it.
        """
        last = max(self.place(line) for line in lines)
        own = [line for line in lines if self.place(line) == last]
        held = [head for head, end in self.spans.items() if head <= min(own) and max(own) <= end]
        return max(held, default=None)

    def whole(self, name: str) -> int:
        """Return the most instructions of a call, its callees and counted rounds included."""
        plain = self.of(name)
        return plain + math.ceil(sum(often * unit for often, unit in self.units[name].values()))

    def count(self, name: str, counter: str, often: int, unit: float) -> None:
        """Note that what a counter counts takes some instructions."""
        seen = self.units[name].get(counter, (0, 0))
        self.units[name][counter] = max(often, seen[0]), max(unit, seen[1])

    def of(self, name: str) -> int:
        """Return the most instructions of a call, callees included, counted loops at no round."""
        if name in self.known:
            return self.known[name]
        code = self.functions.get(name)
        if not code:
            raise ExportError(f"{name}: is called and not in the listing.")
        self.known[name] = -1
        self.units[name] = {}
        cost, successors = {}, {}
        present = {one.address for one in code}
        for one, after in zip(code, [*code[1:], None], strict=True):
            extra = 0
            if one.calls is not None:
                extra = self.of(one.calls)
                if extra < 0:
                    raise ExportError(f"{one.calls}: calls itself; write a loop.")
                for counter, (often, unit) in self.units[one.calls].items():
                    self.count(name, counter, often, unit)
                if one.calls in self.called:
                    part, without = self.called[one.calls]
                    self.count(name, "work", self.work, extra / part)
                    self.count(name, one.calls, without, extra)
                    extra = 0
            cost[one.address] = 1 + extra
            ahead = [*one.targets, *([after.address] if one.falls and after else [])]
            successors[one.address] = [to for to in ahead if to in present]
        way = _Ways(name, successors, cost, {one.address: one.line for one in code}, self)
        self.known[name] = max(way.longest(present, {code[0].address: 0}, frozenset()).values())
        return self.known[name]


class _Ways:
    """The longest ways through one function."""

    def __init__(
        self,
        function: str,
        successors: Mapping[int, list[int]],
        cost: Mapping[int, int],
        lines: Mapping[int, int | None],
        bounds: Bounds,
    ) -> None:
        self.function, self.successors, self.cost = function, successors, cost
        self.lines, self.bounds = lines, bounds

    def longest(
        self, nodes: set[int], entries: Mapping[int, int], taken: frozenset[int], head: int = -1
    ) -> dict[int, int]:
        """Return the longest way to the end of every node that is reached within `nodes`.

        Parameters
        ----------
        nodes : set of int
            Where the way stays.
        entries : dict
            Where it may begin -> what came before.
        taken : set of int
            Heads (lines) of the loops round these nodes.
        head : int
            No step leads to it.
        """
        ahead = {n: [t for t in self.successors[n] if t in nodes and t != head] for n in nodes}
        into, result = dict(entries), dict[int, int]()
        for part in _components(entries, ahead):
            begins = {node: into[node] for node in part if node in into}
            only = next(iter(part))
            if len(part) == 1 and only not in ahead[only]:
                result[only] = into[only] + self.cost[only]
            else:
                result |= self._loop(set(part), begins, taken)
            for node in part:
                for to in ahead[node]:
                    if to not in part and node in result:
                        into[to] = max(into.get(to, 0), result[node])
        return result

    def _loop(
        self, part: set[int], begins: Mapping[int, int], taken: frozenset[int]
    ) -> dict[int, int]:
        """Return the longest ways through a loop, all its rounds included."""
        flat = self._flat(part, taken)
        if flat is not None:
            return dict.fromkeys(part, max(begins.values()) + flat)
        head = min(begins)
        back = [node for node in part if head in self.successors[node]]
        turns, own = self._turns(part, head, taken, len(begins) > 1 or len(back) > 1)
        others = {node: way for node, way in begins.items() if node != head}
        first = self.longest(part, others, own, head)
        round_ = self.longest(part, {head: 0}, own, head)
        cycle = max(round_[node] for node in back if node in round_)
        counted = max(own - taken, default=0)
        if counted in self.bounds.counted:
            counter, most, each = self.bounds.counted[counted]
            self.bounds.count(self.function, counter, most, turns * cycle / each)
            turns = 0
        reached = max([begins.get(head, 0), *(first[node] for node in back if node in first)])
        result = dict(first)
        for node, way in round_.items():
            result[node] = max(result.get(node, 0), reached + turns * cycle + way)
        return result

    def _held(self, part: Iterable[int]) -> set[int]:
        """Return the lines of smap.c of which a part of the code is."""
        found = (self.lines[node] for node in part)
        return {line for line in found if line is not None}

    def _own(self, lines: Collection[int]) -> int:
        """Return the head of the outermost of loops of smap.c that are in one another."""
        last = max(self.bounds.place(line) for line in lines)
        return min(line for line in lines if self.bounds.place(line) == last)

    def _flat(self, part: set[int], taken: frozenset[int]) -> int | None:
        """Return the most instructions of a loop within which all others' total rounds are known.

        Then no instruction is executed more often than all of them go round together, and once.
        """
        free = (self._held(part) & set(self.bounds.rounds)) - taken
        if not free:
            return None
        own = self._own(free)
        inner = free - {own}
        if not inner or not inner <= set(self.bounds.totals):
            return None
        often = self.bounds.rounds[own] + sum(self.bounds.totals[line] for line in inner) + 1
        return often * sum(self.cost[node] for node in part)

    def _turns(
        self, part: set[int], head: int, taken: frozenset[int], tangled: bool
    ) -> tuple[int, frozenset[int]]:
        """Return how often a loop goes round at most, and the heads of it and those round it.

        Of one with a counter how often what it holds does, for each count.

        The outermost loop of smap.c of which it holds the head and that is not one round it: of the
        function that stands last, as callees stand before their callers, the first.  Where loops
        may share their head, the rounds of those that have no loop of their own are multiplied.
        """
        held = self._held(part)
        heads = held & set(self.bounds.rounds)
        if not heads:
            # The compiler may have left nothing of a head but its body's way back.
            only = self.bounds.around(held) if held else None
            if held and only is None:
                raise ExportError(f"{self.function}: a loop at lines {sorted(held)} of no head.")
            if only is None:
                return LARGEST_COPY, taken
            paid = only in self.bounds.counted and only not in taken
            return 1 if paid else self.bounds.rounds[only], taken | {only}
        free = heads - taken
        if not free:
            return max(self.bounds.rounds[line] for line in heads), taken
        own = self._own(free)
        turns = 1 if own in self.bounds.counted else self.bounds.rounds[own]
        if tangled:
            ahead = {n: [t for t in self.successors[n] if t in part and t != head] for n in part}
            inner = [p for p in _components({n: 0 for n in part}, ahead) if len(p) > 1]
            nested = self._held(node for p in inner for node in p)
            for line in free - {own} - nested:
                turns *= self.bounds.rounds[line] + 1
        return turns, taken | {own}


def _components(
    entries: Iterable[int], successors: Mapping[int, list[int]]
) -> list[frozenset[int]]:
    """Return the strongly connected parts that are reached, each before those it leads to.

    Tarjan's algorithm (1972), without recursion.
    """
    index: dict[int, int] = {}
    low: dict[int, int] = {}
    stack, held, found = list[int](), set[int](), list[frozenset[int]]()
    for entry in entries:
        work = [] if entry in index else [(entry, iter(successors[entry]))]
        if work:
            index[entry] = low[entry] = len(index)
            stack.append(entry)
            held.add(entry)
        while work:
            node, ahead = work[-1]
            for to in ahead:
                if to not in index:
                    index[to] = low[to] = len(index)
                    stack.append(to)
                    held.add(to)
                    work.append((to, iter(successors[to])))
                    break
                if to in held:
                    low[node] = min(low[node], index[to])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == index[node]:
                    part = set()
                    while node in held:
                        one = stack.pop()
                        held.discard(one)
                        part.add(one)
                    found.append(frozenset(part))
    return found[::-1]


def bound(listing: str, source: str, shape: Shape, entries: Mapping[str, str]) -> dict[str, int]:
    """Return the most instructions of each call, that from the image included.

    Parameters
    ----------
    listing : str
        What ``objdump -dl`` says of an image that was compiled with ``-g``.
    source : str
        smap.c.
    shape : Shape
        Of the export's tables.
    entries : mapping
        Name of a call -> function of smap.c that answers it.
    """
    known = bounds(source, shape), starts(source), totals(source, shape), spans(source)
    work = counted(source, shape), called(source, shape), shape.work
    found = Bounds(parse(listing), *known, *work)
    return {call: found.whole(function) + CALL for call, function in entries.items()}
